#include "frame/node_rig.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_set>

#include "frame/decompose.h"
#include "frame/key_grid.h"

namespace kadr {

namespace {

glm::dmat4 from_parts(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
    return compose({glm::normalize(rotation), scale, glm::dvec3(0), translation});
}

void append(std::vector<double>& all, const std::vector<double>& more) { all.insert(all.end(), more.begin(), more.end()); }

}  // namespace

NodeRig::NodeRig(const Shot& shot, const Scene& scene, const std::vector<std::vector<int>>& clips) : scene_(&scene) {
    const std::size_t count = scene.nodes.size();
    file_.assign(count, -1);
    for (std::size_t f = 0; f < scene.files.size(); ++f) {
        const SceneSpec& spec = shot.scenes.at(f);
        files_.push_back({&spec.transform, varies(spec.transform), spec.clip_start_s, spec.clip_speed});
        std::fill_n(file_.begin() + scene.files[f].first_node, scene.files[f].node_count, static_cast<int>(f));
    }
    animated_index_.assign(count, -1);
    bind_clips(clips);
    order_nodes();
    moving_.assign(count, false);
    local_.assign(count, glm::dmat4(1));
    world_.assign(count, glm::dmat4(1));
    for (const int node : order_) {
        const int parent = scene.nodes[index(node)].parent;
        moving_[index(node)] = animates(node) || (parent >= 0 ? moving_[index(parent)] : files_[index(file_[index(node)])].moves);
        local_[index(node)] = local_transform(node, 0, 0);
        const glm::dmat4 above = parent >= 0 ? world_[index(parent)] : scene_transform(file_[index(node)], 0);
        world_[index(node)] = above * local_[index(node)];
    }
}

bool NodeRig::animates(int node) const {
    const int slot = animated_index_[index(node)];
    if (slot < 0) return false;
    const Animated& a = animated_[index(slot)];
    return a.translation_track || a.rotation_track || a.scale_track;
}

void NodeRig::order_nodes() {
    const std::size_t count = scene_->nodes.size();
    rank_.assign(count, 0);
    reachable_.assign(count, false);
    for (const SceneFile& file : scene_->files)
        for (const int root : file.roots) reachable_[index(root)] = true;
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
        const auto& children = scene_->nodes[index(node)].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
}

void NodeRig::bind_clips(const std::vector<std::vector<int>>& clips) {
    for (const std::vector<int>& playing : clips)
        for (const int clip : playing)
            for (const NodeChannels& channels : scene_->clips[index(clip)].channels) bind_channels(channels);
}

void NodeRig::bind_channels(const NodeChannels& channels) {
    const Node& node = scene_->nodes[index(channels.node)];
    int& slot = animated_index_[index(channels.node)];
    if (slot < 0) {
        slot = static_cast<int>(animated_.size());
        Animated rest;
        if (node.matrix) {  // glTF forbids it; the parts of the matrix are what the channels can replace
            const Decomposition parts = decompose(*node.matrix);
            rest.translation = parts.translation, rest.rotation = parts.rotation, rest.scale = parts.scale;
        } else {
            rest.translation = node.translation, rest.rotation = node.rotation, rest.scale = node.scale;
        }
        animated_.push_back(rest);
    }
    Animated& animated = animated_[index(slot)];
    const bool runs = files_[index(file_[index(channels.node)])].speed != 0;
    const double start = files_[index(file_[index(channels.node)])].start_s;
    const auto bind = [&](const auto& track, auto& constant, auto& bound) {
        if (!track || track->keys.empty()) return;
        const bool moves = runs && varies(*track);
        bound = moves ? &*track : nullptr;
        if (!moves) constant = kadr::evaluate(*track, start);
    };
    bind(channels.translation, animated.translation, animated.translation_track);
    bind(channels.rotation, animated.rotation, animated.rotation_track);
    bind(channels.scale, animated.scale, animated.scale_track);
}

glm::dmat4 NodeRig::scene_transform(int file, double time_s) const { return kadr::evaluate(*files_[index(file)].transform, time_s); }

glm::dmat4 NodeRig::local_transform(int node, double time_s, double clip_offset_s) const {
    const int slot = animated_index_[index(node)];
    const Node& source = scene_->nodes[index(node)];
    if (slot < 0) return source.matrix ? *source.matrix : from_parts(source.translation, source.rotation, source.scale);
    const Animated& a = animated_[index(slot)];
    const double time = files_[index(file_[index(node)])].clip_time(time_s, clip_offset_s);
    return from_parts(a.translation_track ? kadr::evaluate(*a.translation_track, time) : a.translation,
                      a.rotation_track ? kadr::evaluate(*a.rotation_track, time) : a.rotation,
                      a.scale_track ? kadr::evaluate(*a.scale_track, time) : a.scale);
}

glm::dmat4 NodeRig::node_transform(int node, double time_s, double clip_offset_s) const {
    glm::dmat4 result(1);
    for (; moves(node); node = scene_->nodes[index(node)].parent) {
        result = (animates(node) ? local_transform(node, time_s, clip_offset_s) : local_[index(node)]) * result;
        if (scene_->nodes[index(node)].parent < 0) return scene_transform(file_[index(node)], time_s) * result;
    }
    return world_[index(node)] * result;
}

std::vector<glm::dmat4> NodeRig::all_transforms(double time_s, double clip_offset_s) const {
    std::vector<glm::dmat4> world = world_;
    std::vector<glm::dmat4> above;
    for (std::size_t f = 0; f < files_.size(); ++f) above.push_back(scene_transform(static_cast<int>(f), time_s));
    for (const int node : order_) {
        if (!moves(node)) continue;
        const int parent = scene_->nodes[index(node)].parent;
        const glm::dmat4 local = animates(node) ? local_transform(node, time_s, clip_offset_s) : local_[index(node)];
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

void NodeRig::evaluate(const Selection& selection, double time_s, std::vector<glm::dmat4>& world, double clip_offset_s) const {
    world.resize(selection.nodes.size());
    int file = -1;
    glm::dmat4 above(1);
    for (std::size_t slot = 0; slot < selection.nodes.size(); ++slot) {
        const int node = selection.nodes[slot];
        const glm::dmat4 local = animates(node) ? local_transform(node, time_s, clip_offset_s) : local_[index(node)];
        const int parent = scene_->nodes[index(node)].parent;
        if (selection.parent_slot[slot] >= 0) {
            world[slot] = world[index(selection.parent_slot[slot])] * local;
        } else if (parent >= 0) {
            world[slot] = world_[index(parent)] * local;
        } else {
            if (file != file_[index(node)]) above = scene_transform(file = file_[index(node)], time_s);
            world[slot] = above * local;
        }
    }
}

NodeRig::Activity NodeRig::own_activity(int node, double begin_s, double end_s, double clip_offset_s) const {
    Activity own;
    std::vector<double> times;  // in [0, 1] over the interval
    const auto add_keys = [&](const std::vector<double>& keys, double from, double to) {
        for (const double key : keys) times.push_back((key - from) / (to - from));
    };
    const FileMotion& file = files_[index(file_[index(node)])];
    if (const int slot = animated_index_[index(node)]; slot >= 0) {
        const Animated& a = animated_[index(slot)];
        // A clip may run backwards: the tracks are asked over the interval in ascending order.
        const double from = file.clip_time(begin_s, clip_offset_s), to = file.clip_time(end_s, clip_offset_s);
        const double low = std::min(from, to), high = std::max(from, to);
        if (a.translation_track) add_keys(key_times(*a.translation_track, low, high), from, to);
        if (a.scale_track) add_keys(key_times(*a.scale_track, low, high), from, to);
        if (a.rotation_track) {
            add_keys(key_times(*a.rotation_track, low, high), from, to);
            own.turn_rad = turn_of(*a.rotation_track, low, high);
        }
    }
    if (scene_->nodes[index(node)].parent < 0 && file.moves) {
        add_keys(key_times(*file.transform, begin_s, end_s), begin_s, end_s);
        own.turn_rad += turn_of(*file.transform, begin_s, end_s);
    }
    own.keys = static_cast<int>(times.size());
    own.grid = even_segments_for(times);
    return own;
}

std::vector<NodeRig::Activity> NodeRig::activity(const Selection& selection, double begin_s, double end_s, double clip_offset_s) const {
    std::vector<Activity> all;
    all.reserve(selection.nodes.size());
    for (std::size_t slot = 0; slot < selection.nodes.size(); ++slot) {
        Activity own = own_activity(selection.nodes[slot], begin_s, end_s, clip_offset_s);
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
    const auto add = [&times](const auto& track, double from, double to) { append(times, kadr::discontinuities(track, from, to)); };
    for (const FileMotion& file : files_) {
        add(*file.transform, begin_s, end_s);
    }
    for (const int node : order_) {
        if (animated_index_[index(node)] < 0 || !reachable(node)) continue;
        const Animated& a = animated_[index(animated_index_[index(node)])];
        const FileMotion& file = files_[index(file_[index(node)])];
        const double from = file.clip_time(begin_s, clip_offset_s), to = file.clip_time(end_s, clip_offset_s);
        const std::size_t known = times.size();
        if (a.translation_track) add(*a.translation_track, std::min(from, to), std::max(from, to));
        if (a.rotation_track) add(*a.rotation_track, std::min(from, to), std::max(from, to));
        if (a.scale_track) add(*a.scale_track, std::min(from, to), std::max(from, to));
        for (std::size_t i = known; i < times.size(); ++i) times[i] = file.shot_time(times[i], clip_offset_s);
    }
    return times;
}

std::vector<double> NodeRig::key_times_of(int node, double begin_s, double end_s, double clip_offset_s) const {
    std::vector<double> times;
    for (; node >= 0; node = scene_->nodes[index(node)].parent) {
        const FileMotion& file = files_[index(file_[index(node)])];
        if (const int slot = animated_index_[index(node)]; slot >= 0) {
            const Animated& a = animated_[index(slot)];
            const double from = file.clip_time(begin_s, clip_offset_s), to = file.clip_time(end_s, clip_offset_s);
            const std::size_t known = times.size();
            if (a.translation_track) append(times, key_times(*a.translation_track, std::min(from, to), std::max(from, to)));
            if (a.rotation_track) append(times, key_times(*a.rotation_track, std::min(from, to), std::max(from, to)));
            if (a.scale_track) append(times, key_times(*a.scale_track, std::min(from, to), std::max(from, to)));
            for (std::size_t i = known; i < times.size(); ++i) times[i] = file.shot_time(times[i], clip_offset_s);
        }
        if (scene_->nodes[index(node)].parent < 0) append(times, key_times(*file.transform, begin_s, end_s));
    }
    return times;
}

}  // namespace kadr
