#include "shot/track_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"

namespace kadr {

namespace {

template <class T>
using ReadValue = std::optional<T> (*)(const Field&);

/// A key as read: what it says, and where, for what can only be said once all keys are sorted.
template <class T>
struct ReadKey {
    Key<T> key;
    const YamlEntry* entry;
};

/// CSS Easing Functions Level 1: ease-in, ease-out, ease-in-out; in the order of the row's choices.
constexpr std::array<Ease, 3> kNamedEases{{{0.42, 0, 1, 1}, {0, 0, 0.58, 1}, {0.42, 0, 0.58, 1}}};

std::optional<Ease> read_ease(const Field& field) {
    if (!field) return std::nullopt;
    if (!field.node->is_list()) {
        const auto index = read_choice_index(field);
        return index ? std::optional(kNamedEases[static_cast<std::size_t>(*index)]) : std::nullopt;
    }
    Ease ease{};
    bool fits = field.node->items.size() == ease.size();
    for (std::size_t i = 0; fits && i < ease.size(); ++i) {
        const ParsedQuantity number = parse_quantity(field.node->items[i].text, Quantity::number);
        const bool is_x = i % 2 == 0;
        fits = number.problem == ParsedQuantity::Problem::none && (!is_x || (number.value >= 0 && number.value <= 1));
        ease[i] = number.value;
    }
    if (fits) return ease;
    field.error(fmt::format("{} is {}", field.name, shown_value(*field.node)),
                "expected four numbers [x1, y1, x2, y2] with x1 and x2 from 0 to 1");
    return std::nullopt;
}

/// Seconds of a key: "2 s", "80 ms", "12 f" (the frame's own time, exact), a bare number of seconds.
std::optional<double> read_time(const Field& field) {
    const Timing& timing = field.context->timing;
    const ParsedQuantity parsed = parse_quantity(field.node->text, Quantity::time);
    if (parsed.problem == ParsedQuantity::Problem::none && std::abs(parsed.value) <= 1e9) {
        return parsed.in_frames ? seconds_of_frames(parsed.value - timing.first, timing.fps) : parsed.value;
    }
    field.error(fmt::format("the time of a key of {} is {}", field.name, shown_value(*field.node)),
                "expected a time such as 2.5 s, 80 ms, 12 f or a number of seconds");
    return std::nullopt;
}

template <class T>
std::optional<ReadKey<T>> read_key(const Field& field, const YamlEntry& entry, ReadValue<T> read_value) {
    const auto time = read_time(field.with(entry.key, field.name));
    ReadKey<T> result{{}, &entry};
    Field value = field.with(entry.value, field.name);
    if (entry.value.is_map()) {
        const Section section(*field.context, &entry.value, "key",
                              fmt::format("{}.keys.{}", field.name, entry.key.text));
        result.key.ease = read_ease(section["ease"]);
        value.node = section["value"].node;
        if (!value) return std::nullopt;  // reported as missing
    }
    const auto read = read_value(value);
    if (!time || !read) return std::nullopt;
    result.key.time_s = *time;
    result.key.value = *read;
    return result;
}

template <class T>
void check_distinct(const Field& field, const std::vector<ReadKey<T>>& keys) {
    for (std::size_t i = 1; i < keys.size(); ++i) {
        const YamlNode &before = keys[i - 1].entry->key, &here = keys[i].entry->key;
        if (keys[i].key.time_s != keys[i - 1].key.time_s || before.text == here.text)
            continue;  // same text: a duplicate key, reported as such
        field.context->problems.error(
            here.place,
            fmt::format("two keys of {} are at the same time, {} and {}", field.name, before.text, here.text),
            "expected one key a time");
    }
}

/// The keys of a track's map, sorted; nothing when any is wrong.
template <class T>
std::optional<std::vector<ReadKey<T>>> read_keys(const Field& field, const Field& keys, ReadValue<T> read_value) {
    if (!keys) return std::nullopt;  // reported as missing
    if (!keys.node->is_map() || keys.node->entries.empty()) {
        keys.mismatch();
        return std::nullopt;
    }
    std::vector<ReadKey<T>> result;
    for (const YamlEntry& entry : keys.node->entries) {
        if (auto key = read_key(field, entry, read_value)) result.push_back(std::move(*key));
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const auto& a, const auto& b) { return a.key.time_s < b.key.time_s; });
    check_distinct(field, result);
    return result.size() == keys.node->entries.size() ? std::optional(std::move(result)) : std::nullopt;
}

template <class T>
Track<T> track_of(std::vector<ReadKey<T>> keys, Interpolation interpolation) {
    Track<T> track;
    track.interpolation = interpolation;
    for (ReadKey<T>& key : keys) track.keys.push_back(std::move(key.key));
    return track;
}

template <class T>
struct KeyedTrack {
    Track<T> track;
    std::vector<const YamlEntry*> entries;  ///< parallel to the track's keys
};

template <class T>
std::optional<KeyedTrack<T>> read_keyed_track(const Field& field, ReadValue<T> read_value) {
    const Section section(*field.context, field.node, "track", field.name);
    const auto interpolation = read_choice<Interpolation>(section["interpolate"]);
    read_choice_index(section["before"]);
    read_choice_index(section["after"]);
    auto keys = read_keys(field, section["keys"], read_value);
    if (!keys) return std::nullopt;
    KeyedTrack<T> result;
    for (const auto& key : *keys) result.entries.push_back(key.entry);
    result.track = track_of(std::move(*keys), interpolation.value_or(Interpolation::linear));
    return result;
}

template <class T>
std::optional<Track<T>> read_track(const Field& field, ReadValue<T> read_value) {
    if (!field) return std::nullopt;
    if (field.node->is_map()) {
        auto keyed = read_keyed_track(field, read_value);
        return keyed ? std::optional(std::move(keyed->track)) : std::nullopt;
    }
    const auto constant = read_value(field);
    return constant ? std::optional(Track<T>(*constant)) : std::nullopt;
}

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

std::optional<glm::dquat> read_quaternion(const Field& field) {
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
    const glm::dquat quaternion(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    const double length = glm::length(quaternion);
    if (std::isfinite(length) && length > 0) return quaternion / length;
    field.error(fmt::format("{} is a quaternion of length {}", field.name, format_number(length)),
                "expected [x, y, z, w] that are not all zero");
    return std::nullopt;
}

std::optional<glm::dquat> read_orientation(const Field& field) {
    if (!field) return std::nullopt;
    if (field.node->is_list() && field.node->items.size() == 4) return read_quaternion(field);
    const auto angles_rad = read_vector3(field);
    if (!angles_rad) return std::nullopt;
    return rotation_from_degrees(glm::degrees(*angles_rad));
}

/// Between keys half a turn apart the way round is undefined; more than half a turn is silently the shorter way.
void check_turns(const Field& field, const KeyedTrack<glm::dquat>& keyed) {
    constexpr double kHalfTurn = 1e-9;  // |dot| of unit quaternions: within 2e-9 rad of 180 degrees, above rounding
    if (keyed.track.interpolation == Interpolation::step) return;
    for (std::size_t i = 1; i < keyed.entries.size(); ++i) {
        if (std::abs(glm::dot(keyed.track.keys[i - 1].value, keyed.track.keys[i].value)) > kHalfTurn) continue;
        field.context->problems.error(
            keyed.entries[i]->key.place,
            fmt::format("keys {} and {} of {} are 180 deg apart", keyed.entries[i - 1]->key.text,
                        keyed.entries[i]->key.text, field.name),
            "the way round is undefined; add a key between them, or write { axis: [x, y, z], angle: { keys: ... } }");
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
        if (!before || !here) continue;
        const glm::dvec3 turn = glm::abs(*here - *before);
        if (std::max({turn.x, turn.y, turn.z}) <= glm::radians(180.0)) continue;
        field.context->problems.warning(
            keyed.entries[i]->key.place, fmt::format("{} turns more than 180 deg between two keys", field.name),
            "the shorter way round is taken; write { axis: [x, y, z], angle: { keys: ... } } to turn on");
    }
}

std::optional<RotationTrack> read_axis_angle(const Field& field) {
    const Section section(*field.context, field.node, "rotation", field.name);
    const auto axis = read_direction(section["axis"]);
    const auto angle = read_number_track(section["angle"]);
    if (!axis || !angle) return std::nullopt;
    RotationTrack rotation;
    rotation.axis_angle = RotationTrack::AxisAngle{glm::normalize(*axis), *angle};
    return rotation;
}

}  // namespace

std::optional<Track<double>> read_number_track(const Field& field) { return read_track<double>(field, read_number); }
std::optional<Track<glm::dvec2>> read_vector2_track(const Field& field) {
    return read_track<glm::dvec2>(field, read_vector2);
}
std::optional<Track<glm::dvec3>> read_vector3_track(const Field& field) {
    return read_track<glm::dvec3>(field, read_vector3);
}
std::optional<Track<glm::dvec3>> read_direction_track(const Field& field) {
    return read_track<glm::dvec3>(field, read_direction);
}
std::optional<Track<glm::dvec3>> read_scale_track(const Field& field) {
    return read_track<glm::dvec3>(field, read_scale);
}

std::optional<SwitchTrack> read_switch_track(const Field& field) {
    auto track = read_track<double>(field, read_on_off);
    const YamlNode* interpolate = field && field.node->is_map() ? field.node->find("interpolate") : nullptr;
    if (interpolate && interpolate->text != "step")
        field.with(*interpolate, field.name + ".interpolate")
            .error(fmt::format("{}.interpolate is {}", field.name, shown_value(*interpolate)),
                   "expected step: what is true or false only jumps; remove the key");
    if (track) track->interpolation = Interpolation::step;
    return track;
}

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
    auto keyed = read_keyed_track<glm::dquat>(field, read_orientation);
    if (!keyed) return std::nullopt;
    check_turns(field, *keyed);
    warn_of_long_turns(field, *keyed);
    rotation.orientation = std::move(keyed->track);
    return rotation;
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
    auto points = read_vector3_track(field);
    return points ? std::optional<Target>(std::move(*points)) : std::nullopt;
}

}  // namespace kadr
