// scenes.instances: a list of places, a grid, or a scatter on a mesh.
#include <fmt/format.h>

#include <cmath>

#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

constexpr const char* kPlaceKeys[] = {"translate", "rotate", "scale", "offset"};
constexpr const char* kArrangementKeys[] = {"grid",  "spacing", "jitter",     "scatter",      "count",
                                            "distance", "align", "seed", "random_yaw", "random_scale", "random_offset", "offset_steps"};

template <std::size_t N>
void refuse_keys(const Section& section, const char* const (&keys)[N], std::string_view expected) {
    for (const char* key : keys)
        if (section.has(key))
            section.context().problems.error(section.key_place(key), fmt::format("{}.{} does not apply here", section.name(), key),
                                             std::string(expected));
}

/// Rotations and scales of places do not move; tracks belong to the scene's transform and its clips.
template <class Track>
bool refuse_track(const Field& field, const Track& track) {
    if (track.is_constant()) return false;
    field.error(fmt::format("{} is keyed", field.name), "expected a constant: animate the scene's transform, or its clips with `offset`");
    return true;
}

void read_place_rotation(const Field& field, PlacementSpec& place) {
    const auto rotation = read_rotation_track(field);
    if (!rotation) return;
    const bool moves = rotation->axis_angle ? refuse_track(field, rotation->axis_angle->angle_rad) : refuse_track(field, rotation->orientation);
    if (!moves) place.rotate = evaluate(*rotation, 0);
}

void read_place_scale(const Field& field, PlacementSpec& place) {
    const auto scale = read_scale_track(field);
    if (scale && !refuse_track(field, *scale)) place.scale = evaluate(*scale, 0);
}

PlacementSpec read_place(const Section& scene, const Field& list, const YamlNode& node, std::size_t index) {
    PlacementSpec place;
    const std::string name = fmt::format("{}.{}", list.name, index);
    if (!node.is_map()) {
        list.with(node, name).error(fmt::format("{} is {}", name, shown_value(node)), "expected a place such as { translate: [2, 0, 0], rotate: [0, 90 deg, 0] }");
        return place;
    }
    const Section section(scene.context(), &node, "scenes.instances", name);
    refuse_keys(section, kArrangementKeys, "a list holds places: translate, rotate, scale, offset; for a grid or a scatter write a map");
    assign(place.translate_m, read_vector3(section["translate"]));
    read_place_rotation(section["rotate"], place);
    read_place_scale(section["scale"], place);
    assign(place.offset_s, read_number(section["offset"]));
    return place;
}

void check_total(const Field& field, double count) {
    if (count > static_cast<double>(kMostInstances))
        field.error(fmt::format("{} makes {:.0f} copies", field.name, count), fmt::format("expected at most {}", kMostInstances));
}

void read_grid(const Section& section, InstancesSpec& spec) {
    const Field field = section["grid"];
    if (!field) return;
    spec.grid.emplace();
    const auto counts = read_vector3(field);
    for (int i = 0; counts && i < 3; ++i) {
        if ((*counts)[i] != std::floor((*counts)[i])) return field.mismatch_with("expected whole numbers: copies along x, y and z");
        spec.grid->counts[static_cast<std::size_t>(i)] = static_cast<int>((*counts)[i]);
    }
    if (counts) check_total(field, counts->x * counts->y * counts->z);
    assign(spec.grid->spacing_m, read_vector3(section["spacing"]));
    assign(spec.grid->jitter, read_number(section["jitter"]));
}

void read_scatter(const Section& section, InstancesSpec& spec) {
    const Field field = section["scatter"];
    if (!field) return;
    spec.scatter.emplace();
    if (const auto target = read_node(field)) {
        spec.scatter->target = target->text;
        spec.scatter->where = target->where;
    }
    if (!section.has("count")) field.error(fmt::format("{} has no count", section.name()), "expected count: the number of copies");
    assign(spec.scatter->count, read_integer(section["count"]));
    assign(spec.scatter->distance_m, read_number(section["distance"]));
    assign(spec.scatter->align, read_choice<ScatterSpec::Align>(section["align"]));
}

/// [least, largest]
void read_range(const Field& field, glm::dvec2& range) {
    const auto read = read_vector2(field);
    if (!read) return;
    range = *read;
    if (range.x > range.y) field.error(fmt::format("{} is {}, from more to less", field.name, shown_value(*field.node)), "expected [least, largest]");
}

void read_arrangement(const Section& section, InstancesSpec& spec) {
    refuse_keys(section, kPlaceKeys, "it belongs to the places of a list: instances: [ { translate: [2, 0, 0] } ]");
    section.exclusive("grid", "scatter");
    if (!section.has("grid") && !section.has("scatter"))
        section.context().problems.error(section.node()->place, fmt::format("{} says neither grid nor scatter", section.name()),
                                         "expected one of them, or a list of places");
    for (const char* key : {"spacing", "jitter"}) section.exclusive("scatter", key);
    for (const char* key : {"count", "distance", "align"}) section.exclusive("grid", key);
    read_grid(section, spec);
    read_scatter(section, spec);
    assign(spec.seed, read_integer(section["seed"]));
    assign(spec.random_yaw_rad, read_number(section["random_yaw"]));
    read_range(section["random_scale"], spec.random_scale);
    read_range(section["random_offset"], spec.random_offset_s);
    assign(spec.offset_steps, read_integer(section["offset_steps"]));
    if (section.has("offset_steps") && !section.has("random_offset"))
        section["offset_steps"].error(fmt::format("{} has offset_steps and no random_offset", section.name()), "expected random_offset: the range that the steps divide");
}

}  // namespace

std::optional<InstancesSpec> read_instances(const Section& scene) {
    const Field field = scene["instances"];
    if (!field) return std::nullopt;
    InstancesSpec spec;
    spec.where = location_of(field.node->place);
    if (field.node->is_map()) {
        read_arrangement(scene.section("instances"), spec);
        return spec;
    }
    if (!field.node->is_list() || field.node->items.empty()) {
        field.mismatch("for example instances: { grid: [10, 1, 10], spacing: [2 m, 2 m, 2 m] }");
        return std::nullopt;
    }
    check_total(field, static_cast<double>(field.node->items.size()));
    for (std::size_t i = 0; i < field.node->items.size(); ++i) spec.list.push_back(read_place(scene, field, field.node->items[i], i));
    return spec;
}

}  // namespace kadr
