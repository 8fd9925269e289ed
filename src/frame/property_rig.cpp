#include "frame/property_rig.h"

#include <algorithm>

namespace kadr {

namespace {

void append(std::vector<double>& all, const std::vector<double>& more) { all.insert(all.end(), more.begin(), more.end()); }

}  // namespace

double DrivenProperty::distance(double own, double time_s, double clip_offset_s) const {
    const double mean = mixed(own, time_s, clip_offset_s);
    if (own > 0 || !layers) return std::max(mean, 0.0);
    const double share = 1 - (mixed(1.0, time_s, clip_offset_s) - mean);  // of the layers: the rest is the own value's
    return share > 1e-9 ? std::max(mean, 0.0) / (share * share) : 0;
}

bool DrivenProperty::follows_clips() const {
    const auto runs = [&](const auto& part) { return (*layers)[static_cast<std::size_t>(part.layer)].runs() && varies(*part.track); };
    return layers && std::visit([&](const auto& mix) { return std::any_of(mix.parts.begin(), mix.parts.end(), runs); }, track);
}

std::vector<double> DrivenProperty::discontinuities(double begin_s, double end_s, double clip_offset_s) const {
    return std::visit(
        [&](const auto& mix) {
            if (!layers) return kadr::discontinuities(*mix.parts.front().track, begin_s, end_s);
            std::vector<double> times;
            for (const auto& part : mix.parts) {
                const PlayingLayer& layer = (*layers)[static_cast<std::size_t>(part.layer)];
                const LayerWindow window = window_of(layer, begin_s, end_s, clip_offset_s);
                append(times, kadr::discontinuities(layer.weight, begin_s, end_s));
                if (jumps_at_seam(*part.track, layer)) append(times, seams_of(window));
                add_steps(*part.track, window, times);
            }
            return times;
        },
        track);
}

std::vector<double> DrivenProperty::key_times(double begin_s, double end_s, double clip_offset_s) const {
    return std::visit(
        [&](const auto& mix) {
            if (!layers) return kadr::key_times(*mix.parts.front().track, begin_s, end_s);
            std::vector<double> times;
            add_key_times(mix, windows_of(*layers, begin_s, end_s, clip_offset_s), times);
            return times;
        },
        track);
}

PropertyRig::PropertyRig(const Scene& scene, const std::vector<BoundScene>& scenes) {
    for (std::size_t entry = 0; entry < scenes.size(); ++entry) {
        const auto layers = std::make_shared<const std::vector<PlayingLayer>>(scenes[entry].layers);
        for (std::size_t layer = 0; layer < layers->size(); ++layer)
            for (const int clip : (*layers)[layer].clips)
                add_clip(scene.clips[static_cast<std::size_t>(clip)], static_cast<int>(entry), layers, static_cast<int>(layer));
    }
}

void PropertyRig::add_clip(const Clip& clip, int entry, const EntryLayers& layers, int layer) {
    if (!(*layers)[static_cast<std::size_t>(layer)].counts()) return;
    for (const PropertyChannel& channel : clip.properties) {
        DrivenProperty& driven = property_of(entry, channel);
        driven.layers = layers;
        std::visit([&]<class T>(const Track<T>& track) { add_part(std::get<LayeredTrack<T>>(driven.track), layer, track); }, channel.track);
    }
}

DrivenProperty& PropertyRig::property_of(int entry, const PropertyChannel& channel) {
    std::vector<DrivenProperty>& all = driven_[{entry, owner_of(channel.property), channel.index}];
    const auto known = std::find_if(all.begin(), all.end(), [&](const DrivenProperty& driven) { return driven.property == channel.property && driven.use == channel.use; });
    if (known != all.end()) return *known;
    DrivenProperty fresh{channel.property, channel.use, {}, {}};
    std::visit([&]<class T>(const Track<T>&) { fresh.track = LayeredTrack<T>(); }, channel.track);
    return all.emplace_back(std::move(fresh));
}

const std::vector<DrivenProperty>& PropertyRig::of(int entry, PropertyOwner owner, int index) const {
    static const std::vector<DrivenProperty> none;
    const auto found = driven_.find({entry, owner, index});
    return found == driven_.end() ? none : found->second;
}

}  // namespace kadr
