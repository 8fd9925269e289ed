#pragma once

#include <optional>

#include "frame/layered_track.h"

namespace kadr {

/// What moves one node: for each part of its transform the shot's own track, or the layers of clips, or neither.
struct NodePose {
    LayeredTrack<glm::dvec3> translation, scale;
    LayeredTrack<glm::dquat> rotation;
    glm::dvec3 shear{0};                     ///< of a node that has a matrix
    const NodeOverride* override = nullptr;  ///< its parts replace those above

    glm::dmat4 at(Layers layers, double time_s, double clip_offset_s) const;  ///< parent_from_node
    /// Keys inside the windows, as times of the shot.
    void add_key_times(LayerWindows windows, double begin_s, double end_s, std::vector<double>& times) const;
    /// As turn_of a layered track.
    double turn(Layers layers, LayerWindows windows, double begin_s, double end_s, double clip_offset_s) const;
    bool moves() const;
};

/// The pose of a node that nothing moves.
NodePose rest_pose(const Node& node);

/// Lays an override over a pose.
void apply(NodePose& pose, const NodeOverride& node);

}  // namespace kadr
