#include "frame/visibility_rig.h"

#include <algorithm>

#include "frame/layered_switch.h"

namespace kadr {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

bool ever_off(const SwitchTrack& track) {
    return std::any_of(track.keys.begin(), track.keys.end(), [](const Key<double>& key) { return key.value < 0.5; });
}
bool is_ever_on(const SwitchTrack& track) {
    return std::any_of(track.keys.begin(), track.keys.end(), [](const Key<double>& key) { return key.value >= 0.5; });
}

}  // namespace

VisibilityRig::VisibilityRig(const Shot& shot, const Scene& scene, const std::vector<BoundScene>& scenes, const PropertyRig& properties) {
    switch_of_.assign(scene.nodes.size(), -1);
    for (std::size_t entry = 0; entry < scene.files.size(); ++entry) {
        const SceneFile& file = scene.files[entry];
        const int above = entry_switch(static_cast<int>(entry), shot.scenes.at(entry));
        ByShot by_shot;
        for (const BoundScene::Override& node : scenes[entry].overrides)
            if (node.spec->visible) by_shot[node.node] = &*node.spec->visible;
        for (int node = file.first_node; node < file.first_node + file.node_count; ++node)
            if (scene.nodes[index(node)].parent < 0) add_tree(scene, by_shot, properties, static_cast<int>(entry), node, above);
    }
    clips_switch_ = std::any_of(switches_.begin(), switches_.end(), [](const Switch& one) { return one.by_clip.has_value(); });
}

int VisibilityRig::entry_switch(int entry, const SceneSpec& spec) {
    if (!ever_off(spec.visible)) return -1;
    switches_.push_back({-1, entry, true, {}, &spec.visible});
    return static_cast<int>(switches_.size()) - 1;
}

std::optional<VisibilityRig::Switch> VisibilityRig::switch_for(bool rest, const SwitchTrack* by_shot, const std::vector<DrivenProperty>& by_clip) {
    if (by_shot) return ever_off(*by_shot) ? std::optional(Switch{-1, -1, rest, {}, by_shot}) : std::nullopt;
    if (by_clip.empty()) return rest ? std::nullopt : std::optional(Switch{-1, -1, rest, {}, nullptr});
    return Switch{-1, -1, rest, by_clip.front(), nullptr};
}

void VisibilityRig::add_tree(const Scene& scene, const ByShot& by_shot, const PropertyRig& properties, int entry, int root, int above) {
    std::vector<std::pair<int, int>> open{{root, above}};
    while (!open.empty()) {
        auto [node, nearest] = open.back();
        open.pop_back();
        const auto given = by_shot.find(node);
        auto own = switch_for(scene.nodes[index(node)].visible, given == by_shot.end() ? nullptr : given->second, properties.of(entry, PropertyOwner::node, node));
        if (own) {
            own->above = nearest;
            own->entry = entry;
            nearest = static_cast<int>(switches_.size());
            switches_.push_back(std::move(*own));
        }
        switch_of_[index(node)] = nearest;
        for (const int child : scene.nodes[index(node)].children) open.emplace_back(child, nearest);
    }
}

bool VisibilityRig::Switch::on(double time_s, double clip_offset_s) const {
    if (by_shot) return is_on(*by_shot, time_s);
    return by_clip ? is_on(std::get<LayeredTrack<double>>(by_clip->track), rest, *by_clip->layers, time_s, clip_offset_s) : rest;
}

/// Clips count as if they showed it some time.
bool VisibilityRig::Switch::ever_on() const { return by_shot ? is_ever_on(*by_shot) : by_clip || rest; }

bool VisibilityRig::never_shows(int node) const {
    for (int nearest = switch_of_[index(node)]; nearest >= 0; nearest = switches_[index(nearest)].above)
        if (!switches_[index(nearest)].ever_on()) return true;
    return false;
}

VisibilityRig::States VisibilityRig::at(double time_s) const {
    States states;
    states.rig_ = this;
    states.time_s_ = time_s;
    for (const Switch& one : switches_) states.on_.push_back(one.on(time_s, 0) && (one.above < 0 || states.on_[index(one.above)]));
    return states;
}

bool VisibilityRig::States::visible(int node, double clip_offset_s) const {
    if (on_.empty()) return true;
    int nearest = rig_->switch_of_[index(node)];
    if (clip_offset_s == 0 || !rig_->clips_switch_) return nearest < 0 || on_[index(nearest)];
    for (; nearest >= 0; nearest = rig_->switches_[index(nearest)].above)
        if (!rig_->switches_[index(nearest)].on(time_s_, clip_offset_s)) return false;
    return true;
}

void VisibilityRig::Switch::add_discontinuities(double begin_s, double end_s, double clip_offset_s, std::vector<double>& times) const {
    const auto add = [&times](const std::vector<double>& more) { times.insert(times.end(), more.begin(), more.end()); };
    add(by_clip->discontinuities(begin_s, end_s, clip_offset_s));
    add(handovers(std::get<LayeredTrack<double>>(by_clip->track), rest, *by_clip->layers, begin_s, end_s, clip_offset_s));
}

std::vector<double> VisibilityRig::discontinuities(double begin_s, double end_s, const ClipOffsets& offsets) const {
    std::vector<double> times;
    for (const Switch& one : switches_) {
        if (one.by_shot) {
            const std::vector<double> jumps = kadr::discontinuities(*one.by_shot, begin_s, end_s);
            times.insert(times.end(), jumps.begin(), jumps.end());
        }
        if (!one.by_clip) continue;
        for (const double offset : offsets[index(one.entry)]) one.add_discontinuities(begin_s, end_s, offset, times);
    }
    return times;
}

}  // namespace kadr
