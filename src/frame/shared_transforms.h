#pragma once

#include <map>
#include <vector>

#include "frame/bindings.h"

namespace kadr {

/// World transforms of instances' nodes at some times. What copies of a scene share, the chain of nodes above a mesh and
/// the scene's transform, is evaluated once, whatever their number; so are chains that nodes share.
class SharedTransforms {
public:
    SharedTransforms(const Bindings& bindings, std::vector<double> times_s) : bindings_(bindings), times_s_(std::move(times_s)) {}

    /// world_from_node [time], with the placement of the instance's copy, without its local one.
    std::vector<glm::dmat4> world_from_node(const Instance& instance);

private:
    using OverTime = std::vector<glm::dmat4>;  ///< [time]
    const OverTime& node_over_time(const Instance& instance);
    const OverTime& scene_over_time(int file);

    const Bindings& bindings_;
    std::vector<double> times_s_;
    std::map<std::pair<int, double>, OverTime> nodes_;  ///< by node and clip offset; in the scene's space where it has copies
    std::map<int, OverTime> scenes_;                    ///< by file
    const OverTime* latest_ = nullptr;                  ///< neighbours in the list mostly share their node
    std::pair<int, double> latest_key_{-1, 0};
};

}  // namespace kadr
