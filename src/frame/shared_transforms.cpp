#include "frame/shared_transforms.h"

namespace kadr {

const SharedTransforms::OverTime& SharedTransforms::node_over_time(const Instance& instance) {
    const std::pair<int, double> key{instance.seed->node, instance.clip_offset_s()};
    if (latest_ && key == latest_key_) return *latest_;
    const auto [place, added] = nodes_.try_emplace(key);
    for (std::size_t k = 0; added && k < times_s_.size(); ++k)
        place->second.push_back(instance.copy ? bindings_.rig.scene_from_node(key.first, times_s_[k], key.second)
                                              : bindings_.rig.node_transform(key.first, times_s_[k]));
    latest_key_ = key;
    return *(latest_ = &place->second);
}

const SharedTransforms::OverTime& SharedTransforms::scene_over_time(int file) {
    const auto [place, added] = scenes_.try_emplace(file);
    for (std::size_t k = 0; added && k < times_s_.size(); ++k) place->second.push_back(bindings_.rig.scene_transform(file, times_s_[k]));
    return place->second;
}

std::vector<glm::dmat4> SharedTransforms::world_from_node(const Instance& instance) {
    OverTime places = node_over_time(instance);
    if (!instance.copy) return places;
    const OverTime& world_from_scene = scene_over_time(bindings_.rig.file_of(instance.seed->node));
    const glm::dmat4 copy = matrix_of(*instance.copy);
    for (std::size_t k = 0; k < places.size(); ++k) places[k] = world_from_scene[k] * (copy * places[k]);
    return places;
}

}  // namespace kadr
