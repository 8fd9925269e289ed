#pragma once

#include <map>
#include <memory>
#include <tuple>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "frame/layered_track.h"
#include "frame/node_rig.h"
#include "frame/property_limits.h"
#include "scene/scene.h"

namespace kadr {

/// What drives one property beside nodes' transforms: layers of clips, mixed by weight as a LayeredTrack, or a track of
/// the shot. The property's own value, which makes up for missing weight, comes with every call; `clip_offset_s` is that
/// of NodeRig.
struct DrivenProperty {
    Property property = Property::node_visible;
    TextureUse use = TextureUse::base_color;
    std::variant<LayeredTrack<double>, LayeredTrack<glm::dvec2>, LayeredTrack<glm::dvec3>> track;  ///< at least one part
    std::shared_ptr<const std::vector<PlayingLayer>> layers = {};  ///< of the scene entry; null: one track, by the shot's time

    /// Held within limits_of(property). @pre the track is one of T
    template <class T>
    T value(const T& own, double time_s, double clip_offset_s) const {
        const PropertyLimits limits = limits_of(property);
        return glm::clamp(mixed(own, time_s, clip_offset_s), T(limits.low), T(limits.high));
    }
    /// As value, of a distance for which 0 means infinite: where the property's own is, the mean of the layers is divided by
    /// the weight that they have together, so that it grows beyond all bounds while they fade out. Never negative.
    double distance(double own, double time_s, double clip_offset_s) const;
    /// Whether the time of its clips makes a difference, and with it a clip offset.
    bool follows_clips() const;
    /// Times of the shot inside (begin, end) where the value jumps.
    std::vector<double> discontinuities(double begin_s, double end_s, double clip_offset_s) const;
    /// Times of the shot inside (begin, end) where the tracks or their weights have keys.
    std::vector<double> key_times(double begin_s, double end_s, double clip_offset_s) const;

private:
    template <class T>
    T mixed(const T& own, double time_s, double clip_offset_s) const {
        const auto& mix = std::get<LayeredTrack<T>>(track);
        return layers ? evaluate(mix, own, *layers, time_s, clip_offset_s) : evaluate(*mix.parts.front().track, time_s);
    }
};

/// What the playing clips of each scene entry drive beside nodes' transforms (KHR_animation_pointer).
class PropertyRig {
public:
    /// @param scenes  one per scene entry
    PropertyRig(const Scene& scene, const std::vector<BoundScene>& scenes);

    /// What is driven of one object, every property once.
    /// @param index  node, light, camera: into the Scene's table; material: as the file numbers it
    const std::vector<DrivenProperty>& of(int entry, PropertyOwner owner, int index) const;

private:
    using EntryLayers = std::shared_ptr<const std::vector<PlayingLayer>>;
    void add_clip(const Clip& clip, int entry, const EntryLayers& layers, int layer);
    DrivenProperty& property_of(int entry, const PropertyChannel& channel);

    std::map<std::tuple<int, PropertyOwner, int>, std::vector<DrivenProperty>> driven_;
};

}  // namespace kadr
