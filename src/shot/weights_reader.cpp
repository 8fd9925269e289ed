// Weights of morph targets: a list of numbers, or a track of such lists.
#include <fmt/format.h>

#include "shot/key_reader.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

/// What the keys of such a track hold: one number for each morph target.
struct WeightList {
    std::vector<double> values;
    bool operator==(const WeightList&) const = default;
    WeightList operator*(double factor) const {
        WeightList scaled = *this;
        for (double& value : scaled.values) value *= factor;
        return scaled;
    }
};

std::optional<WeightList> read_list(const Field& field) {
    if (!field.node->is_list() || field.node->items.empty()) {
        field.mismatch();
        return std::nullopt;
    }
    WeightList list;
    for (std::size_t i = 0; i < field.node->items.size(); ++i)
        if (const auto value = read_number(field.with(field.node->items[i], fmt::format("{}[{}]", field.name, i)))) list.values.push_back(*value);
    return list.values.size() == field.node->items.size() ? std::optional(std::move(list)) : std::nullopt;
}

void refuse_count(const Field& field, const std::string& name, std::size_t found, std::size_t expected, const char* as_in) {
    field.error(fmt::format("{} has {} numbers", name, found), fmt::format("expected {}, as {}: one for each morph target", expected, as_in));
}

std::optional<WeightList> read_tangent_list(const Field& field, const WeightList& value) {
    auto list = read_list(field);
    if (!list || list->values.size() == value.values.size()) return list;
    refuse_count(field, field.name, list->values.size(), value.values.size(), "in the key's value");
    return std::nullopt;
}

constexpr KeyValues<WeightList> kWeightLists{read_list, read_tangent_list};

/// Whether every key has as many numbers as the first.
bool check_counts(const Field& field, const KeyedTrack<WeightList>& keyed) {
    bool same = true;
    const std::size_t count = keyed.track.keys.front().value.values.size();
    for (std::size_t i = 1; i < keyed.track.keys.size(); ++i) {
        const std::size_t found = keyed.track.keys[i].value.values.size();
        if (found == count) continue;
        const YamlNode& entry = keyed.entries[i]->value;
        const YamlNode* inner = entry.is_map() ? entry.find("value") : nullptr;
        refuse_count(field.with(inner ? *inner : entry, field.name), name_of_key(field, *keyed.entries[i]), found, count, "at the first key");
        same = false;
    }
    return same;
}

/// A key without tangents has none for any target.
double at(const WeightList& tangent, std::size_t target) { return tangent.values.empty() ? 0 : tangent.values[target]; }

std::vector<Track<double>> by_target(const Track<WeightList>& lists) {
    std::vector<Track<double>> tracks(lists.keys.front().value.values.size());
    for (std::size_t target = 0; target < tracks.size(); ++target) {
        Track<double>& track = tracks[target];
        track.interpolation = lists.interpolation;
        track.before = lists.before, track.after = lists.after, track.overshoot = lists.overshoot;
        for (const Key<WeightList>& key : lists.keys)
            track.keys.push_back({key.time_s, key.value.values[target], key.ease, at(key.in_tangent, target), at(key.out_tangent, target)});
    }
    return tracks;
}

}  // namespace

std::vector<Track<double>> read_weight_tracks(const Field& field) {
    if (!field) return {};
    if (!field.node->is_map()) {
        const auto list = read_list(field);
        return list ? std::vector<Track<double>>(list->values.begin(), list->values.end()) : std::vector<Track<double>>{};
    }
    const auto keyed = read_keyed_track(field, kWeightLists);
    if (!keyed || !check_counts(field, *keyed)) return {};
    return by_target(keyed->track);
}

}  // namespace kadr
