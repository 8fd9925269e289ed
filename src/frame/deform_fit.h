#pragma once

#include <span>
#include <vector>

#include "frame/camera_keys.h"
#include "frame/deformer.h"

namespace kadr {

/// What the fit of a deformer's keys is measured by.
struct DeformationView {
    std::vector<glm::dmat4> world_from_deformed;  ///< of the instances that show it, relative to the render origin
    std::span<const PixelScale> scales;           ///< at the times of the poses
    double enough_px = 0;
};

/// Largest screen-space distance between a mesh whose vertices go linearly from every fourth pose to the next, and the
/// mesh in the poses between; stops early once beyond enough_px. An upper bound; of dual quaternions at most enough_px where
/// a bound by blocks of vertices says so, else exact at the vertices.
double deformation_error_px(const GeometryData& geometry, const Deformer& deformer, std::span<const DeformationPose> poses, const DeformationView& view);

/// Whether two poses put every vertex at the same place, but for rounding.
bool nearly_same(const DeformationPose& a, const DeformationPose& b);

/// Places of the corners of a deformer's boxes in a pose; morph targets widen the boxes by what they weigh.
void add_corners(const Deformer& deformer, const DeformationPose& pose, std::vector<glm::dvec3>& corners);

}  // namespace kadr
