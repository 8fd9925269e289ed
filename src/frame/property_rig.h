#pragma once

#include <map>
#include <optional>
#include <tuple>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "frame/node_rig.h"
#include "scene/scene.h"

namespace kadr {

/// A property's track and the clock that it runs by: that of a layer of clips, or the shot's own time. Weights do not mix
/// properties: of several layers that play the last one counts.
struct DrivenProperty {
    Property property = Property::node_visible;
    TextureUse use = TextureUse::base_color;
    std::variant<const Track<double>*, const Track<glm::dvec2>*, const Track<glm::dvec3>*> track;  ///< never null
    std::optional<PlayingLayer> layer = {};  ///< none: the track runs by the shot's time

    /// Whether it drives the property at a time: its layer's weight is above zero.
    bool plays(double time_s) const { return !layer || layer->weight_at(time_s) > 0; }

    double number(double time_s) const { return at<double>(time_s); }
    glm::dvec2 pair(double time_s) const { return at<glm::dvec2>(time_s); }
    glm::dvec3 triple(double time_s) const { return at<glm::dvec3>(time_s); }
    /// Times of the shot inside (begin, end) where the value jumps.
    std::vector<double> discontinuities(double begin_s, double end_s) const;
    /// Times of the shot inside (begin, end) where the track has keys.
    std::vector<double> key_times(double begin_s, double end_s) const;

private:
    template <class T>
    T at(double time_s) const { return evaluate(*std::get<const Track<T>*>(track), layer ? layer->clip_time(time_s, 0) : time_s); }
};

/// What the playing clips of each scene entry drive beside nodes' transforms (KHR_animation_pointer).
class PropertyRig {
public:
    /// @param scenes  one per scene entry
    PropertyRig(const Scene& scene, const std::vector<BoundScene>& scenes);

    /// What is driven of one object, in the order in which it applies: where clips drive the same, the last one wins.
    /// @param index  node, light, camera: into the Scene's table; material: as the file numbers it
    const std::vector<DrivenProperty>& of(int entry, PropertyOwner owner, int index) const;

private:
    void add_clip(const Clip& clip, int entry, const PlayingLayer& layer);

    std::map<std::tuple<int, PropertyOwner, int>, std::vector<DrivenProperty>> driven_;
};

}  // namespace kadr
