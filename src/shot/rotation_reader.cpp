#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "anim/rotation_math.h"
#include "base/text.h"
#include "shot/key_reader.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

/// [x, y, z, w] as written. @pre a list of four
std::optional<std::array<double, 4>> read_four_numbers(const Field& field) {
    std::array<double, 4> xyzw{};
    for (std::size_t i = 0; i < xyzw.size(); ++i) {
        const ParsedQuantity number = parse_quantity(field.node->items[i].text, Quantity::number);
        if (number.problem != ParsedQuantity::Problem::none) {
            field.with(field.node->items[i], fmt::format("{}[{}]", field.name, i))
                .error(fmt::format("{}[{}] is {}", field.name, i, shown_value(field.node->items[i])),
                       "expected a number: four of them are a quaternion [x, y, z, w]");
            return std::nullopt;
        }
        xyzw[i] = number.value;
    }
    return xyzw;
}

std::optional<glm::dquat> read_quaternion(const Field& field) {
    const auto xyzw = read_four_numbers(field);
    if (!xyzw) return std::nullopt;
    const glm::dquat quaternion((*xyzw)[3], (*xyzw)[0], (*xyzw)[1], (*xyzw)[2]);
    const double length = glm::length(quaternion);
    if (std::isfinite(length) && length > 0) return quaternion / length;
    field.error(fmt::format("{} is a quaternion of length {}", field.name, format_number(length)),
                "expected [x, y, z, w] that are not all zero");
    return std::nullopt;
}

/// A quaternion's own rates, or [x, y, z] degrees a second about the fixed axes: q' = omega * q / 2.
std::optional<glm::dquat> read_turn_rate(const Field& field, const glm::dquat& value) {
    if (field.node->is_list() && field.node->items.size() == 4) {
        const auto xyzw = read_four_numbers(field);
        return xyzw ? std::optional(glm::dquat((*xyzw)[3], (*xyzw)[0], (*xyzw)[1], (*xyzw)[2])) : std::nullopt;
    }
    const auto rate = read_vector3(field);
    return rate ? std::optional(glm::dquat(0, rate->x, rate->y, rate->z) * value * 0.5) : std::nullopt;
}

std::optional<glm::dquat> read_orientation(const Field& field) {
    if (!field) return std::nullopt;
    if (field.node->is_list() && field.node->items.size() == 4) return read_quaternion(field);
    const auto angles_rad = read_vector3(field);
    if (!angles_rad) return std::nullopt;
    return rotation_from_degrees(glm::degrees(*angles_rad));
}

constexpr double kHalfTurn = 1e-9;  // |dot| of unit quaternions: within 2e-9 rad of 180 degrees, above rounding
constexpr double kNoTurn = 1e-9;    // radians between keys that are the same

void check_undirected(const Field& field, const KeyedTrack<glm::dquat>& keyed, std::size_t i) {
    const Key<glm::dquat>&a = keyed.track.keys[i], &b = keyed.track.keys[i + 1];
    const std::string &from = keyed.entries[i]->key.text, &to = keyed.entries[i + 1]->key.text;
    if (std::abs(glm::dot(a.value, b.value)) <= kHalfTurn)
        field.context->problems.error(keyed.entries[i + 1]->key.place, fmt::format("keys {} and {} of {} are 180 deg apart", from, to, field.name),
                                      fmt::format("the way round is undefined; say it at the first, {}: {{ value: ..., axis: [x, y, z] }}, or add a key between them", from));
    else if (a.spin && a.spin->turns != 0 && glm::length(step_between(a.value, b.value)) < kNoTurn)
        field.context->problems.error(keyed.entries[i]->key.place, fmt::format("keys {} and {} of {} are the same rotation", from, to, field.name),
                                      "spin has no axis to turn about; add axis: [x, y, z]");
}

/// An axis says which of two ways to go, which one across the turn does not.
void check_directed(const Field& field, const KeyedTrack<glm::dquat>& keyed, std::size_t i) {
    constexpr double kAcross = 1e-6;
    const Key<glm::dquat>&a = keyed.track.keys[i], &b = keyed.track.keys[i + 1];
    const glm::dvec3 step = a.value * step_between(a.value, b.value);
    if (glm::length(step) < kNoTurn || std::abs(glm::dot(glm::normalize(step), a.spin->axis)) > kAcross) return;
    const YamlNode* axis = keyed.entries[i]->value.find("axis");
    const glm::dvec3 own = glm::normalize(step);
    field.context->problems.error(axis->place, fmt::format("{}.axis is at right angles to the turn to the next key", name_of_key(field, *keyed.entries[i])),
                                  fmt::format("expected a direction on one side of it: the turn is about [{:.3g}, {:.3g}, {:.3g}]", own.x, own.y, own.z));
}

/// Between keys half a turn apart the way round is undefined unless it is stated.
void check_turns(const Field& field, const KeyedTrack<glm::dquat>& keyed) {
    if (keyed.track.interpolation == Interpolation::step) return;
    for (std::size_t i = 0; i + 1 < keyed.entries.size(); ++i) {
        const std::optional<Spin>& spin = keyed.track.keys[i].spin;
        if (spin && spin->axis != glm::dvec3(0))
            check_directed(field, keyed, i);
        else
            check_undirected(field, keyed, i);
    }
}

const YamlNode& value_node(const YamlEntry& entry) {
    const YamlNode* inner = entry.value.is_map() ? entry.value.find("value") : nullptr;
    return inner ? *inner : entry.value;
}

/// Degrees of a key's angles as written, or nothing for a quaternion.
std::optional<glm::dvec3> written_angles_rad(const YamlEntry& entry) {
    const YamlNode& node = value_node(entry);
    if (node.items.size() != 3) return std::nullopt;
    glm::dvec3 angles(0);
    for (std::size_t i = 0; i < 3; ++i)
        angles[static_cast<int>(i)] = parse_quantity(node.items[i].text, Quantity::angle).value;
    return angles;
}

void warn_of_long_turns(const Field& field, const KeyedTrack<glm::dquat>& keyed) {
    if (keyed.track.interpolation == Interpolation::step) return;
    for (std::size_t i = 1; i < keyed.entries.size(); ++i) {
        const auto before = written_angles_rad(*keyed.entries[i - 1]), here = written_angles_rad(*keyed.entries[i]);
        if (!before || !here || keyed.track.keys[i - 1].spin) continue;
        const glm::dvec3 turn = glm::abs(*here - *before);
        if (std::max({turn.x, turn.y, turn.z}) <= glm::radians(180.0)) continue;
        field.context->problems.warning(
            keyed.entries[i]->key.place, fmt::format("{} turns more than 180 deg between two keys", field.name),
            "the shorter way round is taken; add spin or axis to the first key to turn on");
    }
}

std::optional<glm::dvec3> read_axis(const Field& field) {
    const auto axis = read_vector3(field);
    if (!axis || glm::length(*axis) > 0) return axis;
    field.error(fmt::format("{} is zero", field.name), "expected a direction, a vector of any length but zero");
    return std::nullopt;
}

std::optional<RotationTrack> read_axis_angle(const Field& field) {
    const Section section(*field.context, field.node, "rotation", field.name);
    const auto axis = read_axis(section["axis"]);
    const auto angle = read_number_track(section["angle"]);
    if (!axis || !angle) return std::nullopt;
    RotationTrack rotation;
    rotation.axis_angle = RotationTrack::AxisAngle{glm::normalize(*axis), *angle};
    return rotation;
}

}  // namespace

std::optional<RotationTrack> read_rotation_track(const Field& field) {
    if (!field) return std::nullopt;
    RotationTrack rotation;
    if (!field.node->is_map()) {
        const auto constant = read_orientation(field);
        if (!constant) return std::nullopt;
        rotation.orientation = Track<glm::dquat>(*constant);
        return rotation;
    }
    if (field.node->find("axis") || field.node->find("angle")) return read_axis_angle(field);
    auto keyed = read_keyed_track<glm::dquat>(field, {read_orientation, read_turn_rate});
    if (!keyed) return std::nullopt;
    check_turns(field, *keyed);
    warn_of_long_turns(field, *keyed);
    rotation.orientation = std::move(keyed->track);
    return rotation;
}

}  // namespace kadr
