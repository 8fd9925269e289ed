#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "frame/node_rig.h"
#include "scene/scene.h"

namespace kadr {

/// The joints of a skin and the nodes between them and the skin's root, laid out for evaluation: parents first.
///
/// Everything is relative to the root, so the way of the root through the world costs the joints no digits.
class Skeleton {
public:
    Skeleton(const Scene& scene, int skin);

    int root() const { return nodes_.front(); }
    /// root_from_joint * joint_from_mesh of every joint: where the mesh goes, in the root's own coordinates.
    std::vector<glm::dmat4> root_from_mesh(const NodeRig& rig, double time_s, double clip_offset_s) const;
    /// Keys of the nodes below the root, inside (begin, end).
    const std::vector<int>& nodes() const { return nodes_; }

private:
    std::vector<int> nodes_, parents_;  ///< parents_: places in nodes_; -1: the root
    std::vector<int> joints_;           ///< [joint] place in nodes_
    const Skin* skin_;
};

}  // namespace kadr
