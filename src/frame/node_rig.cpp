#include "frame/node_rig.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_set>

#include "frame/decompose.h"
#include "frame/key_grid.h"
#include "frame/mean_flips.h"

namespace kadr {

namespace {

void append(std::vector<double>& all, const std::vector<double>& more) { all.insert(all.end(), more.begin(), more.end()); }

glm::dmat4 own_transform(const Node& node) {
    return node.matrix ? *node.matrix : compose({glm::normalize(node.rotation), node.scale, glm::dvec3(0), node.translation});
}

}  // namespace

NodeRig::NodeRig(const Shot& shot, const Scene& scene, const std::vector<BoundScene>& scenes) : scene_(&scene) {
    file_.assign(scene.nodes.size(), -1);
    for (std::size_t f = 0; f < scene.files.size(); ++f) {
        const TransformTrack& transform = shot.scenes.at(f).transform;
        files_.push_back({&transform, varies(transform), static_cast<int>(layers_.size()), static_cast<int>(scenes[f].layers.size())});
        layers_.insert(layers_.end(), scenes[f].layers.begin(), scenes[f].layers.end());
        std::fill_n(file_.begin() + scene.files[f].first_node, scene.files[f].node_count, static_cast<int>(f));
    }
    order_nodes(scenes);
    bind_layers(scenes);
    place_nodes();
}

void NodeRig::order_nodes(const std::vector<BoundScene>& scenes) {
    const std::size_t count = scene_->nodes.size();
    rank_.assign(count, 0);
    reachable_.assign(count, false);
    hidden_.assign(count, false);
    for (const SceneFile& file : scene_->files)
        for (const int root : file.roots) reachable_[index(root)] = true;
    for (const BoundScene& scene : scenes)
        for (const int node : scene.hidden) hidden_[index(node)] = true;
    std::vector<int> open;
    for (std::size_t node = count; node-- > 0;)
        if (scene_->nodes[node].parent < 0) open.push_back(static_cast<int>(node));
    while (!open.empty()) {
        const int node = open.back();
        open.pop_back();
        rank_[index(node)] = static_cast<int>(order_.size());
        order_.push_back(node);
        const int parent = scene_->nodes[index(node)].parent;
        if (parent >= 0 && reachable_[index(parent)]) reachable_[index(node)] = true;
        if (parent >= 0 && hidden_[index(parent)]) hidden_[index(node)] = true;
        const auto& children = scene_->nodes[index(node)].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
    for (std::size_t node = 0; node < count; ++node)
        if (hidden_[node]) reachable_[node] = false;
}

NodePose& NodeRig::pose_of(int node) {
    int& slot = pose_index_[index(node)];
    if (slot < 0) {
        slot = static_cast<int>(poses_.size());
        poses_.push_back(rest_pose(scene_->nodes[index(node)]));
    }
    return poses_[index(slot)];
}

void NodeRig::bind_layers(const std::vector<BoundScene>& scenes) {
    pose_index_.assign(scene_->nodes.size(), -1);
    for (std::size_t layer = 0; layer < layers_.size(); ++layer)
        for (const int clip : layers_[layer].clips) bind_clip(scene_->clips[index(clip)], static_cast<int>(layer));
    for (const BoundScene& scene : scenes)
        for (const BoundScene::Override& node : scene.overrides) apply(pose_of(node.node), *node.spec);
    jumps_at_seam_.assign(layers_.size(), false);
    for (std::size_t node = 0; node < scene_->nodes.size(); ++node) {
        if (pose_index_[node] < 0) continue;
        NodePose& pose = poses_[index(pose_index_[node])];
        simplify(pose.translation, layers_);
        simplify(pose.rotation, layers_);
        simplify(pose.scale, layers_);
        if (!reachable_[node]) continue;
        note_jumps(pose.translation, vector_steps_);
        note_jumps(pose.scale, vector_steps_);
        note_jumps(pose.rotation, rotation_steps_);
        const auto mixes = [&](const auto& part) { return !(layers_[index(part.layer)].weight.is_constant() && layers_[index(part.layer)].weight_at(0) >= 1); };
        if (pose.rotation.parts.size() > 1 || std::any_of(pose.rotation.parts.begin(), pose.rotation.parts.end(), mixes)) mixed_rotations_.push_back(pose_index_[node]);
    }
}

void NodeRig::bind_clip(const Clip& clip, int layer) {
    for (const NodeChannels& channels : clip.channels) {
        NodePose& pose = pose_of(channels.node);
        if (channels.translation) add_part(pose.translation, layer, *channels.translation);
        if (channels.rotation) add_part(pose.rotation, layer, *channels.rotation);
        if (channels.scale) add_part(pose.scale, layer, *channels.scale);
    }
}

template <class T>
void NodeRig::note_jumps(const LayeredTrack<T>& track, std::vector<StepTrack<T>>& steps) {
    for (const auto& part : track.parts) {
        if (kadr::jumps_at_seam(*part.track, layers_[index(part.layer)])) jumps_at_seam_[index(part.layer)] = true;
        if (part.track->interpolation == Interpolation::step) steps.push_back({part.layer, part.track});
    }
}

void NodeRig::place_nodes() {
    const std::size_t count = scene_->nodes.size();
    moving_.assign(count, false);
    local_.assign(count, glm::dmat4(1));
    world_.assign(count, glm::dmat4(1));
    for (const int node : order_) {
        const int parent = scene_->nodes[index(node)].parent;
        moving_[index(node)] = moves_itself(node) || (parent >= 0 ? moving_[index(parent)] : files_[index(file_[index(node)])].moves);
        local_[index(node)] = local_transform(node, 0, 0);
        const glm::dmat4 above = parent >= 0 ? world_[index(parent)] : scene_transform(file_[index(node)], 0);
        world_[index(node)] = above * local_[index(node)];
    }
}

bool NodeRig::moves_itself(int node) const {
    const int pose = pose_index_[index(node)];
    return pose >= 0 && poses_[index(pose)].moves();
}

glm::dmat4 NodeRig::scene_transform(int file, double time_s) const { return kadr::evaluate(*files_[index(file)].transform, time_s); }

glm::dmat4 NodeRig::local_transform(int node, double time_s, double clip_offset_s) const {
    const int pose = pose_index_[index(node)];
    return pose < 0 ? own_transform(scene_->nodes[index(node)]) : poses_[index(pose)].at(layers_, time_s, clip_offset_s);
}

glm::dmat4 NodeRig::node_transform(int node, double time_s, double clip_offset_s) const {
    glm::dmat4 result(1);
    for (; moves(node); node = scene_->nodes[index(node)].parent) {
        result = (moves_itself(node) ? local_transform(node, time_s, clip_offset_s) : local_[index(node)]) * result;
        if (scene_->nodes[index(node)].parent < 0) return scene_transform(file_[index(node)], time_s) * result;
    }
    return world_[index(node)] * result;
}

glm::dmat4 NodeRig::scene_from_node(int node, double time_s, double clip_offset_s) const {
    glm::dmat4 result(1);
    for (; node >= 0; node = scene_->nodes[index(node)].parent)
        result = (moves_itself(node) ? local_transform(node, time_s, clip_offset_s) : local_[index(node)]) * result;
    return result;
}

bool NodeRig::clips_jump() const {
    return !vector_steps_.empty() || !rotation_steps_.empty() || !mixed_rotations_.empty() || std::find(jumps_at_seam_.begin(), jumps_at_seam_.end(), true) != jumps_at_seam_.end();
}

std::vector<glm::dmat4> NodeRig::all_transforms(double time_s, double clip_offset_s) const {
    std::vector<glm::dmat4> world = world_;
    std::vector<glm::dmat4> above;
    for (std::size_t f = 0; f < files_.size(); ++f) above.push_back(scene_transform(static_cast<int>(f), time_s));
    for (const int node : order_) {
        if (!moves(node)) continue;
        const int parent = scene_->nodes[index(node)].parent;
        const glm::dmat4 local = moves_itself(node) ? local_transform(node, time_s, clip_offset_s) : local_[index(node)];
        world[index(node)] = (parent >= 0 ? world[index(parent)] : above[index(file_[index(node)])]) * local;
    }
    return world;
}

int NodeRig::Selection::slot_of(int node) const {
    return std::lower_bound(slots.begin(), slots.end(), std::pair{node, 0})->second;
}

NodeRig::Selection NodeRig::select(std::span<const int> nodes) const {
    Selection selection;
    std::unordered_set<int> seen;
    seen.reserve(2 * nodes.size());
    for (int node : nodes)
        for (; node >= 0 && moves(node) && seen.insert(node).second; node = scene_->nodes[index(node)].parent)
            selection.nodes.push_back(node);
    std::sort(selection.nodes.begin(), selection.nodes.end(), [&](int a, int b) { return rank_[index(a)] < rank_[index(b)]; });
    for (std::size_t slot = 0; slot < selection.nodes.size(); ++slot) selection.slots.emplace_back(selection.nodes[slot], static_cast<int>(slot));
    std::sort(selection.slots.begin(), selection.slots.end());
    for (const int node : selection.nodes) {
        const int parent = scene_->nodes[index(node)].parent;
        selection.parent_slot.push_back(parent >= 0 && moves(parent) ? selection.slot_of(parent) : -1);
    }
    return selection;
}

NodeRig::Activity NodeRig::own_activity(int node, LayerWindows windows, double begin_s, double end_s, double clip_offset_s) const {
    Activity own;
    std::vector<double> times;
    if (moves_itself(node)) {
        const NodePose& pose = poses_[index(pose_index_[index(node)])];
        pose.add_key_times(windows, begin_s, end_s, times);
        own.turn_rad = pose.turn(layers_, windows, begin_s, end_s, clip_offset_s);
    }
    const FileMotion& file = files_[index(file_[index(node)])];
    if (scene_->nodes[index(node)].parent < 0 && file.moves) {
        append(times, key_times(*file.transform, begin_s, end_s));
        own.turn_rad += turn_of(*file.transform, begin_s, end_s);
    }
    for (double& time : times) time = (time - begin_s) / (end_s - begin_s);
    own.keys = static_cast<int>(times.size());
    own.grid = even_segments_for(times);
    return own;
}

std::vector<NodeRig::Activity> NodeRig::activity(const Selection& selection, double begin_s, double end_s, double clip_offset_s) const {
    std::vector<Activity> all;
    all.reserve(selection.nodes.size());
    const std::vector<LayerWindow> windows = windows_of(layers_, begin_s, end_s, clip_offset_s);
    for (std::size_t slot = 0; slot < selection.nodes.size(); ++slot) {
        Activity own = own_activity(selection.nodes[slot], windows, begin_s, end_s, clip_offset_s);
        if (selection.parent_slot[slot] >= 0) {
            const Activity& above = all[index(selection.parent_slot[slot])];
            own.turn_rad += above.turn_rad;
            own.keys += above.keys;
            own.grid = std::lcm(own.grid, above.grid);
            if (own.grid > kMostSegments) own.grid = 1;
        }
        all.push_back(own);
    }
    return all;
}

std::vector<double> NodeRig::discontinuities(double begin_s, double end_s, double clip_offset_s) const {
    std::vector<double> times;
    for (const FileMotion& file : files_) append(times, kadr::discontinuities(*file.transform, begin_s, end_s));
    for (const NodePose& pose : poses_)
        if (pose.override) append(times, kadr::discontinuities(pose.override->transform, begin_s, end_s));
    const std::vector<LayerWindow> windows = windows_of(layers_, begin_s, end_s, clip_offset_s);
    for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
        append(times, kadr::discontinuities(layers_[layer].weight, begin_s, end_s));
        if (jumps_at_seam_[layer]) append(times, seams_of(windows[layer]));
    }
    for (const auto& step : vector_steps_) add_steps(*step.track, windows[index(step.layer)], times);
    for (const auto& step : rotation_steps_) add_steps(*step.track, windows[index(step.layer)], times);
    for (const int pose : mixed_rotations_) add_flips(poses_[index(pose)].rotation, layers_, windows, clip_offset_s, times);
    return times;
}

std::vector<double> NodeRig::key_times_of(int node, double begin_s, double end_s, double clip_offset_s) const {
    std::vector<double> times;
    const std::vector<LayerWindow> windows = windows_of(layers_, begin_s, end_s, clip_offset_s);
    for (; node >= 0; node = scene_->nodes[index(node)].parent) {
        if (moves_itself(node)) poses_[index(pose_index_[index(node)])].add_key_times(windows, begin_s, end_s, times);
        if (scene_->nodes[index(node)].parent < 0) append(times, key_times(*files_[index(file_[index(node)])].transform, begin_s, end_s));
    }
    return times;
}

}  // namespace kadr
