#include "frame/property_rig.h"

#include "frame/layered_track.h"

namespace kadr {

namespace {

void append(std::vector<double>& all, const std::vector<double>& more) { all.insert(all.end(), more.begin(), more.end()); }

}  // namespace

std::vector<double> DrivenProperty::discontinuities(double begin_s, double end_s) const {
    return std::visit(
        [&](const auto* keyed) {
            if (!layer) return kadr::discontinuities(*keyed, begin_s, end_s);
            const LayerWindow window = window_of(*layer, begin_s, end_s, 0);
            std::vector<double> times = kadr::discontinuities(layer->weight, begin_s, end_s);
            if (jumps_at_seam(*keyed, *layer)) append(times, seams_of(window));
            add_steps(*keyed, window, times);
            return times;
        },
        track);
}

std::vector<double> DrivenProperty::key_times(double begin_s, double end_s) const {
    return std::visit(
        [&](const auto* keyed) {
            if (!layer) return kadr::key_times(*keyed, begin_s, end_s);
            std::vector<double> times;
            for (const ClipPass& pass : window_of(*layer, begin_s, end_s, 0).passes)
                for (const double key : kadr::key_times(*keyed, pass.low_s(), pass.high_s())) times.push_back(pass.shot_time(key));
            return times;
        },
        track);
}

PropertyRig::PropertyRig(const Scene& scene, const std::vector<BoundScene>& scenes) {
    for (std::size_t entry = 0; entry < scenes.size(); ++entry)
        for (const PlayingLayer& layer : scenes[entry].layers)
            for (const int clip : layer.clips) add_clip(scene.clips[static_cast<std::size_t>(clip)], static_cast<int>(entry), layer);
}

void PropertyRig::add_clip(const Clip& clip, int entry, const PlayingLayer& layer) {
    if (!layer.counts()) return;
    for (const PropertyChannel& channel : clip.properties) {
        DrivenProperty driven;
        driven.property = channel.property;
        driven.use = channel.use;
        std::visit([&](const auto& track) { driven.track = &track; }, channel.track);
        driven.layer = layer;
        driven_[{entry, owner_of(channel.property), channel.index}].push_back(driven);
    }
}

const std::vector<DrivenProperty>& PropertyRig::of(int entry, PropertyOwner owner, int index) const {
    static const std::vector<DrivenProperty> none;
    const auto found = driven_.find({entry, owner, index});
    return found == driven_.end() ? none : found->second;
}

}  // namespace kadr
