#include "frame/property_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "anim/track_extremes.h"
#include "base/text.h"
#include "frame/problem.h"

namespace kadr {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kWidestField = 3.1;  // radians: the picture's plane has to be somewhere

struct Row {
    Property property;
    PropertyLimits limits;
    const char* name;
};
constexpr Row kRows[] = {
    {Property::base_color, {0, 1}, "base colour"},
    {Property::alpha, {0, 1}, "alpha"},
    {Property::metallic, {0, 1}, "metallic factor"},
    {Property::roughness, {0, 1}, "roughness"},
    {Property::emissive, {0, kUnbounded}, "emissive colour"},
    {Property::emissive_strength, {0, kUnbounded}, "emissive strength"},
    {Property::ior, {1, kUnbounded}, "index of refraction"},
    {Property::alpha_cutoff, {0, kUnbounded}, "alpha cutoff"},
    {Property::occlusion_strength, {0, 1}, "occlusion strength"},
    {Property::light_color, {0, kUnbounded}, "colour"},
    {Property::light_intensity, {0, kUnbounded}, "intensity"},
    {Property::light_range, {0, kUnbounded}, "range"},
    {Property::light_inner, {0, 0.5 * std::numbers::pi}, "inner cone angle"},
    {Property::light_outer, {0, 0.5 * std::numbers::pi}, "outer cone angle"},
    {Property::camera_yfov, {1e-6, kWidestField}, "field of view"},
    {Property::camera_znear, {0, kUnbounded}, "near plane"},
    {Property::camera_zfar, {0, kUnbounded}, "far plane"},
};

const Row* row_of(Property property) {
    const auto* row = std::find_if(std::begin(kRows), std::end(kRows), [property](const Row& r) { return r.property == property; });
    return row == std::end(kRows) ? nullptr : row;
}

std::string range_text(const PropertyLimits& limits) {
    if (limits.high == kUnbounded) return fmt::format("at least {}", format_number(limits.low));
    return fmt::format("{:.6g} to {:.6g}", limits.low, limits.high);
}

std::string called(const std::string& name, int index) { return name.empty() ? fmt::format("{}", index) : fmt::format("'{}'", name); }

std::string owner_text(const Scene& scene, const SceneFile& file, const PropertyChannel& channel) {
    const auto index = static_cast<std::size_t>(channel.index);
    if (owner_of(channel.property) == PropertyOwner::light) return "light " + called(scene.lights[index].name, channel.index);
    if (owner_of(channel.property) == PropertyOwner::camera) return "camera " + called(scene.cameras[index].name, channel.index);
    for (int m = file.first_material; m < file.first_material + file.material_count; ++m)
        if (scene.material_sources[static_cast<std::size_t>(m)].index == channel.index)
            return "material " + called(scene.material_names[static_cast<std::size_t>(m)], channel.index);
    return fmt::format("material {}", channel.index);
}

/// Intervals of clip time that a layer plays in a window of the shot, those at which it stands still among them.
std::vector<std::pair<double, double>> played_by(const PlayingLayer& layer, double begin_s, double end_s) {
    std::vector<std::pair<double, double>> played;
    const LayerWindow window = window_of(layer, begin_s, end_s, 0);
    if (!window.counts) return played;
    for (const ClipPass& pass : window.passes) played.emplace_back(pass.low_s(), pass.high_s());
    for (const double time : {begin_s, end_s}) played.emplace_back(layer.clip_time(time, 0), layer.clip_time(time, 0));
    return played;
}

std::vector<Track<double>> components_of(const PropertyTrack& track) {
    if (const auto* number = std::get_if<Track<double>>(&track)) return {*number};
    std::vector<Track<double>> components;
    if (const auto* pair = std::get_if<Track<glm::dvec2>>(&track))
        for (int c = 0; c < 2; ++c) components.push_back(component_of(*pair, c));
    if (const auto* triple = std::get_if<Track<glm::dvec3>>(&track))
        for (int c = 0; c < 3; ++c) components.push_back(component_of(*triple, c));
    return components;
}

/// The value of a channel farthest beyond its limits.
std::optional<Extreme> worst_of(const PropertyTrack& track, const PropertyLimits& limits, const std::vector<std::pair<double, double>>& played) {
    constexpr double kRounding = 1e-6;  // of a file's floats, and of what is blended from them
    std::optional<Extreme> worst;
    double most = 0;
    const auto look = [&](const Extreme& extreme) {
        const double beyond = std::max(limits.low - extreme.value, extreme.value - limits.high);
        if (!(beyond > std::max(most, kRounding * std::abs(extreme.value))) || beyond <= kRounding * std::min(std::abs(limits.high), 1.0)) return;
        worst = extreme;
        most = beyond;
    };
    for (const Track<double>& component : components_of(track))
        for (const auto& [from_s, to_s] : played) {
            const Extremes extremes = extremes_of(component, from_s, to_s);
            look(extremes.least);
            look(extremes.greatest);
        }
    return worst;
}

}  // namespace

PropertyLimits limits_of(Property property) {
    const Row* row = row_of(property);
    return row ? row->limits : PropertyLimits{};
}

std::vector<Diagnostic> warnings_of_limits(const Scene& scene, const std::vector<BoundScene>& scenes, double begin_s, double end_s) {
    std::vector<Diagnostic> warnings;
    std::set<const PropertyChannel*> seen;
    for (std::size_t entry = 0; entry < scenes.size(); ++entry) {
        const SceneFile& file = scene.files[entry];
        for (const PlayingLayer& layer : scenes[entry].layers) {
            const auto played = played_by(layer, begin_s, end_s);
            for (const int c : layer.clips) {
                const Clip& clip = scene.clips[static_cast<std::size_t>(c)];
                for (const PropertyChannel& channel : clip.properties) {
                    const Row* row = row_of(channel.property);
                    const auto worst = row ? worst_of(channel.track, row->limits, played) : std::nullopt;
                    if (!worst || !seen.insert(&channel).second) continue;
                    warnings.push_back(warning_at({file.path.string(), 0, 0},
                                                  fmt::format("clip {} drives the {} of {} to {:.6g} at {:.6g} s of the clip", called(clip.name, c - file.first_clip), row->name,
                                                              owner_text(scene, file, channel), worst->value, worst->time_s),
                                                  fmt::format("expected {}; the property is held there", range_text(row->limits))));
                }
            }
        }
    }
    return warnings;
}

}  // namespace kadr
