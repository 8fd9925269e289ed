#include "frame/node_pose.h"

#include "frame/decompose.h"

namespace kadr {

namespace {

void append(std::vector<double>& all, const std::vector<double>& more) { all.insert(all.end(), more.begin(), more.end()); }

}  // namespace

NodePose rest_pose(const Node& node) {
    NodePose pose;
    if (!node.matrix) {
        pose.translation.rest = node.translation, pose.rotation.rest = node.rotation, pose.scale.rest = node.scale;
        return pose;
    }
    const Decomposition parts = decompose(*node.matrix);
    pose.translation.rest = parts.translation, pose.rotation.rest = parts.rotation, pose.scale.rest = parts.scale;
    pose.shear = parts.shear;
    return pose;
}

void apply(NodePose& pose, const NodeOverride& node) {
    pose.override = &node;
    // The rest is what a part is before its own track is asked: a constant override needs no more than that.
    if (node.translates) pose.translation = {evaluate(node.transform.translate, 0), {}};
    if (node.rotates) pose.rotation = {evaluate(node.transform.rotate, 0), {}};
    if (node.scales) pose.scale = {evaluate(node.transform.scale, 0), {}};
}

bool NodePose::moves() const {
    return !translation.parts.empty() || !rotation.parts.empty() || !scale.parts.empty() || (override && varies(override->transform));
}

glm::dmat4 NodePose::at(Layers layers, double time_s, double clip_offset_s) const {
    const TransformTrack* own = override ? &override->transform : nullptr;
    const auto t = own && override->translates ? evaluate(own->translate, time_s) : evaluate(translation, layers, time_s, clip_offset_s);
    auto r = own && override->rotates ? evaluate(own->rotate, time_s) : evaluate(rotation, layers, time_s, clip_offset_s);
    if (own && own->translate.turns_along()) r = rotation_along(*own->translate.path, time_s) * r;
    const auto s = own && override->scales ? evaluate(own->scale, time_s) : evaluate(scale, layers, time_s, clip_offset_s);
    return compose({glm::normalize(r), s, shear, t});
}

void NodePose::add_key_times(LayerWindows windows, double begin_s, double end_s, std::vector<double>& times) const {
    kadr::add_key_times(translation, windows, times);
    kadr::add_key_times(scale, windows, times);
    kadr::add_key_times(rotation, windows, times);
    if (override) append(times, key_times(override->transform, begin_s, end_s));
}

double NodePose::turn(Layers layers, LayerWindows windows, double begin_s, double end_s, double clip_offset_s) const {
    const double own = override ? turn_of(override->transform, begin_s, end_s) : 0;
    return own + turn_of(rotation, layers, windows, clip_offset_s);
}

}  // namespace kadr
