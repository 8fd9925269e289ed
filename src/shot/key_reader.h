#pragma once

// Keys of tracks, whatever their values are. Used by track_reader.cpp and rotation_reader.cpp alone.

#include <fmt/format.h>

#include <optional>
#include <utility>
#include <vector>

#include "anim/track.h"
#include "shot/section.h"

namespace kadr {

/// How the values and the tangents of a track's keys are read.
template <class T>
struct KeyValues {
    std::optional<T> (*value)(const Field&);
    std::optional<T> (*tangent)(const Field&, const T& value);
};

/// A track and where its keys stand, for what can only be said once all are read.
template <class T>
struct KeyedTrack {
    Track<T> track;
    std::vector<const YamlEntry*> entries;  ///< parallel to the track's keys
};

std::optional<Ease> read_ease(const Field& field);
/// Seconds of a key: "2 s", "80 ms", "12 f" (the frame's own time, exact), a bare number of seconds.
std::optional<double> read_key_time(const Field& field);
/// The same of a field that is a point in time: `from: 12 f`.
std::optional<double> read_time_point(const Field& field);
std::optional<Spin> read_spin(const Section& key);

/// "camera.position.keys.2 s"
std::string name_of_key(const Field& field, const YamlEntry& entry);

// What only makes sense together: reported at the key that is in the way.
struct KeyFacts {
    double time_s;
    const YamlEntry* entry;
};
void check_order(const Field& field, const std::vector<KeyFacts>& keys);
void check_track(const Field& field, const Section& section, Interpolation interpolation, const std::vector<KeyFacts>& keys, bool is_rotation);

/// Reads a tangent by the row of its value, without that row's limits: a brightness may fall.
template <class T>
std::optional<T> read_tangent(const Section& key, const char* name, const Field& value_field, const KeyValues<T>& values, const T& value) {
    const Field tangent = key[name];
    if (!tangent) return std::nullopt;
    FieldSpec unlimited = *value_field.spec;
    unlimited.low = -kInfinity;
    unlimited.high = kInfinity;
    return values.tangent({tangent.context, tangent.node, &unlimited, tangent.name}, value);
}

template <class T>
std::optional<Key<T>> read_key(const Field& field, const YamlEntry& entry, const KeyValues<T>& values) {
    const auto time = read_key_time(field.with(entry.key, field.name));
    Field value_field = field.with(entry.value, field.name);
    if (!entry.value.is_map()) {
        const auto value = values.value(value_field);
        return time && value ? std::optional(Key<T>{*time, *value, {}, {}, {}}) : std::nullopt;
    }
    const Section section(*field.context, &entry.value, "key", name_of_key(field, entry));
    Key<T> key;
    key.ease = read_ease(section["ease"]);
    value_field.node = section["value"].node;
    if (!value_field) return std::nullopt;  // reported as missing
    const auto value = values.value(value_field);
    if (!time || !value) return std::nullopt;
    key.time_s = *time;
    key.value = *value;
    const auto in = read_tangent(section, "in_tangent", value_field, values, key.value);
    const auto out = read_tangent(section, "out_tangent", value_field, values, key.value);
    const T none = key.value * 0.0;
    key.in_tangent = in.value_or(out.value_or(none));
    key.out_tangent = out.value_or(in.value_or(none));
    if constexpr (kIsRotation<T>) key.spin = read_spin(section);
    return key;
}

/// `{ keys: { ... }, interpolate, ... }`; nothing when any key is wrong.
template <class T>
std::optional<KeyedTrack<T>> read_keyed_track(const Field& field, const KeyValues<T>& values) {
    const Section section(*field.context, field.node, "track", field.name);
    KeyedTrack<T> result;
    assign(result.track.interpolation, read_choice<Interpolation>(section["interpolate"]));
    assign(result.track.before, read_choice<Extrapolation>(section["before"]));
    assign(result.track.after, read_choice<Extrapolation>(section["after"]));
    assign(result.track.overshoot, read_boolean(section["overshoot"]));
    const Field keys = section["keys"];
    if (!keys) return std::nullopt;  // reported as missing
    if (!keys.node->is_map() || keys.node->entries.empty()) {
        keys.mismatch();
        return std::nullopt;
    }
    std::vector<KeyFacts> facts;
    for (const YamlEntry& entry : keys.node->entries) {
        auto key = read_key(field, entry, values);
        if (!key) continue;
        facts.push_back({key->time_s, &entry});
        result.entries.push_back(&entry);
        result.track.keys.push_back(std::move(*key));
    }
    check_order(field, facts);
    if (facts.size() != keys.node->entries.size()) return std::nullopt;
    check_track(field, section, result.track.interpolation, facts, kIsRotation<T>);
    return result;
}

template <class T>
std::optional<Track<T>> read_track(const Field& field, const KeyValues<T>& values) {
    if (!field) return std::nullopt;
    if (field.node->is_map()) {
        auto keyed = read_keyed_track(field, values);
        if (!keyed) return std::nullopt;
        note_limits(field, keyed->track);
        return std::move(keyed->track);
    }
    const auto constant = values.value(field);
    return constant ? std::optional(Track<T>(*constant)) : std::nullopt;
}

}  // namespace kadr
