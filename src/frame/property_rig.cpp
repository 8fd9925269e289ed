#include "frame/property_rig.h"

#include <algorithm>

namespace kadr {

template <class Times>
std::vector<double> DrivenProperty::shot_times(double begin_s, double end_s, Times times) const {
    if (speed == 0) return {};
    // A clip may run backwards: its track is asked over the interval in ascending order.
    const double from = start_s + speed * begin_s, to = start_s + speed * end_s;
    std::vector<double> result = std::visit([&](const auto* keyed) { return times(*keyed, std::min(from, to), std::max(from, to)); }, track);
    for (double& time : result) time = (time - start_s) / speed;
    return result;
}

std::vector<double> DrivenProperty::discontinuities(double begin_s, double end_s) const {
    return shot_times(begin_s, end_s, [](const auto& keyed, double from, double to) { return kadr::discontinuities(keyed, from, to); });
}

std::vector<double> DrivenProperty::key_times(double begin_s, double end_s) const {
    return shot_times(begin_s, end_s, [](const auto& keyed, double from, double to) { return kadr::key_times(keyed, from, to); });
}

PropertyRig::PropertyRig(const Shot& shot, const Scene& scene, const std::vector<std::vector<int>>& clips) {
    for (std::size_t entry = 0; entry < clips.size(); ++entry)
        for (const int clip : clips[entry])
            for (const PropertyChannel& channel : scene.clips[static_cast<std::size_t>(clip)].properties) {
                DrivenProperty driven;
                driven.property = channel.property;
                driven.use = channel.use;
                std::visit([&](const auto& track) { driven.track = &track; }, channel.track);
                driven.start_s = shot.scenes.at(entry).clip_start_s;
                driven.speed = shot.scenes.at(entry).clip_speed;
                driven_[{static_cast<int>(entry), owner_of(channel.property), channel.index}].push_back(driven);
            }
}

const std::vector<DrivenProperty>& PropertyRig::of(int entry, PropertyOwner owner, int index) const {
    static const std::vector<DrivenProperty> none;
    const auto found = driven_.find({entry, owner, index});
    return found == driven_.end() ? none : found->second;
}

}  // namespace kadr
