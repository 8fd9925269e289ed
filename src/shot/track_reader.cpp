#include "shot/track_reader.h"

#include <fmt/format.h>

#include <cmath>

#include "shot/key_reader.h"

namespace kadr {

namespace {

std::optional<double> read_on_off(const Field& field) {
    const auto on = read_boolean(field);
    return on ? std::optional(*on ? 1.0 : 0.0) : std::nullopt;
}

std::optional<glm::dvec3> read_direction(const Field& field) {
    const auto direction = read_vector3(field);
    if (!direction || glm::length(*direction) > 0) return direction;
    field.error(fmt::format("{} is zero", field.name), "expected a direction, a vector of any length but zero");
    return std::nullopt;
}

std::optional<glm::dvec3> read_scale(const Field& field) {
    if (!field) return std::nullopt;
    std::optional<glm::dvec3> scale;
    if (field.node->is_scalar()) {
        const auto factor = read_number(field);
        if (factor) scale = glm::dvec3(*factor);
    } else {
        scale = read_vector3(field);
    }
    if (!scale || (scale->x != 0 && scale->y != 0 && scale->z != 0)) return scale;
    field.error(fmt::format("{} is zero", field.name),
                "expected a scale that is not zero; a tiny one such as 1e-6 makes things vanish");
    return std::nullopt;
}

/// A tangent is read like a value.
template <class T, std::optional<T> (*Read)(const Field&)>
std::optional<T> tangent(const Field& field, const T&) {
    return Read(field);
}

/// A factor's tangent may be zero.
std::optional<glm::dvec3> read_scale_tangent(const Field& field, const glm::dvec3&) {
    if (!field.node->is_scalar()) return read_vector3(field);
    const auto rate = read_number(field);
    return rate ? std::optional(glm::dvec3(*rate)) : std::nullopt;
}

constexpr KeyValues<double> kSwitches{read_on_off, tangent<double, read_on_off>};
constexpr KeyValues<double> kNumbers{read_number, tangent<double, read_number>};
constexpr KeyValues<glm::dvec2> kVectors2{read_vector2, tangent<glm::dvec2, read_vector2>};
constexpr KeyValues<glm::dvec3> kVectors3{read_vector3, tangent<glm::dvec3, read_vector3>};
constexpr KeyValues<glm::dvec3> kDirections{read_direction, tangent<glm::dvec3, read_vector3>};
constexpr KeyValues<glm::dvec3> kScales{read_scale, read_scale_tangent};

}  // namespace

std::optional<Track<double>> read_number_track(const Field& field) { return read_track(field, kNumbers); }
std::optional<Track<glm::dvec2>> read_vector2_track(const Field& field) { return read_track(field, kVectors2); }
std::optional<Track<glm::dvec3>> read_vector3_track(const Field& field) { return read_track(field, kVectors3); }

std::optional<Track<glm::dvec3>> read_direction_track(const Field& field) {
    auto track = read_track(field, kDirections);
    if (track) note_direction(field, *track);
    return track;
}

std::optional<Track<glm::dvec3>> read_scale_track(const Field& field) {
    auto track = read_track(field, kScales);
    if (track) note_scale(field, *track);
    return track;
}

std::optional<SwitchTrack> read_switch_track(const Field& field) {
    auto track = read_track(field, kSwitches);
    const YamlNode* interpolate = field && field.node->is_map() ? field.node->find("interpolate") : nullptr;
    if (interpolate && interpolate->text != "step")
        field.with(*interpolate, field.name + ".interpolate")
            .error(fmt::format("{}.interpolate is {}", field.name, shown_value(*interpolate)),
                   "expected step: what is true or false only jumps; remove the key");
    if (track) track->interpolation = Interpolation::step;
    return track;
}

std::optional<NodeReference> read_node(const Field& field) {
    if (!field) return std::nullopt;
    const std::string& text = field.node->text;
    const bool well_formed = field.node->is_scalar() && !text.empty() && text.front() != '/' && text.back() != '/' &&
                             text.find("//") == std::string::npos && !looks_like_number(*field.node);
    if (well_formed) return NodeReference{text, location_of(field.node->place)};
    field.mismatch();
    return std::nullopt;
}

std::optional<Target> read_target(const Field& field) {
    if (!field) return std::nullopt;
    if (field.node->is_scalar()) {
        const auto node = read_node(field);
        return node ? std::optional<Target>(*node) : std::nullopt;
    }
    auto points = read_position_track(field);
    return points ? std::optional<Target>(std::move(*points)) : std::nullopt;
}

}  // namespace kadr
