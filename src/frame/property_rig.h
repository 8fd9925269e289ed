#pragma once

#include <map>
#include <tuple>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

/// A property's track and the clock that it runs by: a clip's, or the shot's own time.
struct DrivenProperty {
    Property property = Property::node_visible;
    TextureUse use = TextureUse::base_color;
    std::variant<const Track<double>*, const Track<glm::dvec2>*, const Track<glm::dvec3>*> track;  ///< never null
    double start_s = 0, speed = 1;  ///< track time = start_s + speed * shot time

    double number(double time_s) const { return at<double>(time_s); }
    glm::dvec2 pair(double time_s) const { return at<glm::dvec2>(time_s); }
    glm::dvec3 triple(double time_s) const { return at<glm::dvec3>(time_s); }
    /// Times of the shot inside (begin, end) where the value jumps.
    std::vector<double> discontinuities(double begin_s, double end_s) const;
    /// Times of the shot inside (begin, end) where the track has keys.
    std::vector<double> key_times(double begin_s, double end_s) const;

private:
    template <class T>
    T at(double time_s) const { return evaluate(*std::get<const Track<T>*>(track), start_s + speed * time_s); }
    template <class Times>
    std::vector<double> shot_times(double begin_s, double end_s, Times times) const;
};

/// What the playing clips of each scene entry drive beside nodes' transforms (KHR_animation_pointer).
class PropertyRig {
public:
    /// @param clips  indices into Scene::clips that play, one list per scene entry
    PropertyRig(const Shot& shot, const Scene& scene, const std::vector<std::vector<int>>& clips);

    /// What is driven of one object, in the order in which it applies: where clips drive the same, the last one wins.
    /// @param index  node, light, camera: into the Scene's table; material: as the file numbers it
    const std::vector<DrivenProperty>& of(int entry, PropertyOwner owner, int index) const;

private:
    std::map<std::tuple<int, PropertyOwner, int>, std::vector<DrivenProperty>> driven_;
};

}  // namespace kadr
