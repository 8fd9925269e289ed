#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/deform/skinning.h"
#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

/// What bends a mesh at one time, in double.
struct DeformationPose {
    std::vector<glm::dmat4> joints;  ///< [joint] deformed_from_geometry; one for a mesh without a skin
    std::vector<double> weights;     ///< [morph target]
    bool finite() const;
    bool operator==(const DeformationPose&) const = default;
};

/// A pose as the vertex loops read it.
class VertexPose {
public:
    VertexPose(const DeformationPose& pose, Skinning skinning);
    std::span<const kernels::Affine> matrices() const { return matrices_; }
    std::span<const kernels::DualQuaternionJoint> dual_quaternions() const { return dual_quaternions_; }
    bool stretches() const { return stretches_; }  ///< whether a joint of dual-quaternion skinning does more than move
    std::span<const float> weights() const { return weights_; }
    Skinning skinning() const { return skinning_; }

private:
    Skinning skinning_;
    std::vector<kernels::Affine> matrices_;
    std::vector<kernels::DualQuaternionJoint> dual_quaternions_;  ///< filled for dual-quaternion skinning
    bool stretches_ = false;
    std::vector<float> weights_;
};

/// The vertices of a mesh in a pose: morph targets first, then the joints (glTF 2.0, 3.7.2.2), in parallel.
///
/// Linear skinning blends the joints' matrices; normals go by the cofactors of the blend. Dual-quaternion skinning blends
/// unit dual quaternions, the stretches of the joints linearly before them (kernels/deform/skinning.h).
/// Normals are unit, or zero where the mesh is flat; texture coordinates are copied.
/// @param vertices  [vertex], written whole
/// @param tangents  [vertex], or empty where the mesh has none
void deform_vertices(const GeometryData& geometry, const VertexPose& pose, std::span<kernels::Vertex> vertices,
                     std::span<kernels::Vec4f> tangents);

/// The positions alone of the vertices from `begin` on, bit for bit as deform_vertices puts them, on the calling thread.
/// @param positions  [vertex - begin], written whole
void deform_positions(const GeometryData& geometry, const VertexPose& pose, std::size_t begin, std::span<kernels::Vec3f> positions);

}  // namespace kadr
