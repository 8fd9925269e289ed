#include "frame/skeleton.h"

#include <map>

namespace kadr {

Skeleton::Skeleton(const Scene& scene, int skin) : skin_(&scene.skins[static_cast<std::size_t>(skin)]) {
    std::map<int, int> place{{skin_->root, 0}};
    nodes_.push_back(skin_->root);
    parents_.push_back(-1);
    for (const int joint : skin_->joints) {
        std::vector<int> chain;
        int node = joint;
        for (; node >= 0 && !place.count(node); node = scene.nodes[static_cast<std::size_t>(node)].parent) chain.push_back(node);
        for (std::size_t i = chain.size(); i-- > 0;) {
            parents_.push_back(node < 0 ? 0 : place[node]);  // trees beside each other stand in the root as in the scene
            node = chain[i];
            place[node] = static_cast<int>(nodes_.size());
            nodes_.push_back(node);
        }
        joints_.push_back(place[joint]);
    }
}

std::vector<glm::dmat4> Skeleton::root_from_mesh(const NodeRig& rig, double time_s, double clip_offset_s) const {
    std::vector<glm::dmat4> root_from_node(nodes_.size(), glm::dmat4(1));
    for (std::size_t i = 1; i < nodes_.size(); ++i)
        root_from_node[i] = root_from_node[static_cast<std::size_t>(parents_[i])] * rig.local_transform(nodes_[i], time_s, clip_offset_s);
    std::vector<glm::dmat4> result;
    for (std::size_t j = 0; j < joints_.size(); ++j) result.push_back(root_from_node[static_cast<std::size_t>(joints_[j])] * skin_->inverse_bind[j]);
    return result;
}

}  // namespace kadr
