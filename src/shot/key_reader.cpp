#include "shot/key_reader.h"

#include <array>
#include <cmath>
#include <string_view>

namespace kadr {

namespace {

/// CSS Easing Functions Level 1: ease-in, ease-out, ease-in-out; in the order of the row's choices.
constexpr std::array<Ease, 3> kNamedEases{{{0.42, 0, 1, 1}, {0, 0, 0.58, 1}, {0.42, 0, 0.58, 1}}};

const YamlNode* inside_key(const YamlEntry& entry, std::string_view name) { return entry.value.is_map() ? entry.value.find(name) : nullptr; }

std::optional<double> read_time(const Field& field, const std::string& name) {
    const Timing& timing = field.context->timing;
    const ParsedQuantity parsed = parse_quantity(field.node->text, Quantity::time);
    if (parsed.problem == ParsedQuantity::Problem::none && std::abs(parsed.value) <= 1e9)
        return parsed.in_frames ? seconds_of_frames(parsed.value - timing.first, timing.fps) : parsed.value;
    field.error(fmt::format("{} is {}", name, shown_value(*field.node)), "expected a time such as 2.5 s, 80 ms, 12 f or a number of seconds");
    return std::nullopt;
}

std::string_view word_of(Interpolation interpolation) {
    constexpr std::string_view kWords[] = {"step", "linear", "smooth", "cubic"};
    return kWords[static_cast<int>(interpolation)];
}

/// Refuses what a key says where the track's interpolation has no use for it.
void refuse_in_keys(const Field& field, Interpolation interpolation, const std::vector<KeyFacts>& keys, std::string_view name, std::string_view belongs_to) {
    for (const KeyFacts& key : keys)
        if (const YamlNode* given = inside_key(*key.entry, name))
            field.context->problems.error(given->place, fmt::format("{}.{} is given, but interpolate is {}", name_of_key(field, *key.entry), name, word_of(interpolation)),
                                          std::string(belongs_to));
}

void check_tangents(const Field& field, const Section& section, Interpolation interpolation, const std::vector<KeyFacts>& keys) {
    constexpr const char* kTangents[] = {"in_tangent", "out_tangent"};
    bool any = false;
    for (const char* name : kTangents) {
        if (interpolation != Interpolation::cubic) refuse_in_keys(field, interpolation, keys, name, "in_tangent and out_tangent belong to interpolate: cubic");
        for (const KeyFacts& key : keys) any = any || inside_key(*key.entry, name);
    }
    if (interpolation == Interpolation::cubic && !any)
        section["interpolate"].error(fmt::format("{}.interpolate is cubic, but no key has a tangent", field.name),
                                     "expected keys such as { value: ..., in_tangent: ..., out_tangent: ... }; interpolate: smooth finds tangents itself");
}

void check_spins(const Field& field, Interpolation interpolation, const std::vector<KeyFacts>& keys, bool is_rotation) {
    for (const char* name : {"spin", "axis"}) {
        if (is_rotation && interpolation != Interpolation::linear && interpolation != Interpolation::smooth)
            refuse_in_keys(field, interpolation, keys, name, "spin and axis belong to interpolate: linear and smooth");
        for (const KeyFacts& key : keys) {
            const YamlNode* given = inside_key(*key.entry, name);
            const bool last = &key == &keys.back();
            if (!given || (is_rotation && !last)) continue;
            field.context->problems.error(given->place,
                                          is_rotation ? fmt::format("{}.{} is on the last key", name_of_key(field, *key.entry), name)
                                                      : fmt::format("{}.{} is given, but {} is no rotation", name_of_key(field, *key.entry), name, field.name),
                                          is_rotation ? fmt::format("{} is about the way to the next key; put it on the key before", name)
                                                      : fmt::format("{} belongs to the keys of rotations; remove it", name));
        }
    }
}

void check_overshoot(const Field& field, const Section& section, Interpolation interpolation, bool is_rotation) {
    const Field overshoot = section["overshoot"];
    if (!overshoot) return;
    if (interpolation != Interpolation::smooth)
        overshoot.error(fmt::format("{} is given, but interpolate is {}", overshoot.name, word_of(interpolation)), "overshoot belongs to interpolate: smooth");
    else if (is_rotation && is_word(overshoot, "false"))
        overshoot.error(fmt::format("{} is false, but {} is a rotation", overshoot.name, field.name),
                        "expected interpolate: linear, or { axis: [x, y, z], angle: { keys: ..., overshoot: false } }");
}

void check_ends(const Section& section, const std::vector<KeyFacts>& keys) {
    if (keys.size() > 1) return;
    for (const char* name : {"before", "after"})
        if (const Field end = section[name]; end && !is_word(end, "hold"))
            end.error(fmt::format("{} is {}, but there is one key", end.name, end.node->text), "expected two keys or more; one is a constant");
}

}  // namespace

std::string name_of_key(const Field& field, const YamlEntry& entry) { return fmt::format("{}.keys.{}", field.name, entry.key.text); }

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

std::optional<double> read_key_time(const Field& field) { return read_time(field, "the time of a key of " + field.name); }
std::optional<double> read_time_point(const Field& field) { return field ? read_time(field, field.name) : std::nullopt; }

std::optional<Spin> read_spin(const Section& key) {
    const auto turns = read_integer(key["spin"]);
    const Field axis_field = key["axis"];
    auto axis = read_vector3(axis_field);
    if (axis && !(glm::length(*axis) > 0)) {
        axis_field.error(fmt::format("{} is zero", axis_field.name), "expected a direction, a vector of any length but zero");
        axis.reset();
    }
    if (!turns && !axis) return std::nullopt;
    return Spin{static_cast<int>(turns.value_or(0)), axis ? glm::normalize(*axis) : glm::dvec3(0)};
}

void check_order(const Field& field, const std::vector<KeyFacts>& keys) {
    for (std::size_t i = 1; i < keys.size(); ++i) {
        const YamlNode &before = keys[i - 1].entry->key, &here = keys[i].entry->key;
        if (keys[i].time_s > keys[i - 1].time_s) continue;
        if (keys[i].time_s < keys[i - 1].time_s)
            field.context->problems.error(here.place, fmt::format("keys of {} are out of order: {} comes after {}", field.name, here.text, before.text),
                                          "expected keys in the order of their times");
        else if (before.text != here.text)  // same text: a duplicate key, reported as such
            field.context->problems.error(here.place, fmt::format("two keys of {} are at the same time, {} and {}", field.name, before.text, here.text),
                                          "expected one key a time");
    }
}

void check_track(const Field& field, const Section& section, Interpolation interpolation, const std::vector<KeyFacts>& keys, bool is_rotation) {
    check_tangents(field, section, interpolation, keys);
    check_spins(field, interpolation, keys, is_rotation);
    check_overshoot(field, section, interpolation, is_rotation);
    check_ends(section, keys);
}

}  // namespace kadr
