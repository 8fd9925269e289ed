#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "frame/snapshot.h"

namespace kadr {

/// How near a frame's motion keys come to the true paths, over all parts of its shutter.
struct MotionReport {
    double instances_px = 0, camera_px = 0;  ///< largest screen-space deviations; of bending meshes, places and vertices together
    double vertices_px = 0;                  ///< what bending vertices have of it
    std::size_t frames = 0;                  ///< most motion frames that one instance has in one part
    std::size_t parts = 0;                   ///< intervals that the shutter is split into
    double tolerance_px = 0;                 ///< what the shot asks for
    std::string worst;                       ///< "scene/Node" or "the camera", where the tolerance is not met

    double largest_px() const { return std::max(instances_px, camera_px); }
    bool met() const { return largest_px() <= tolerance_px; }
};

MotionReport motion_report(const BoundShot& shot, const std::vector<SceneSnapshot>& parts);

}  // namespace kadr
