// lights and environment.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

enum Kinds : unsigned { kDirectional = 1, kPoint = 2, kSpot = 4, kArea = 8 };

/// Which kinds of light have a key; keys that are not here belong to all.
struct KeyKinds {
    const char* key;
    unsigned kinds;
};
constexpr KeyKinds kKeyKinds[] = {
    {"illuminance", kDirectional},
    {"intensity", kPoint | kSpot},
    {"power", kPoint | kSpot},
    {"luminance", kArea},
    {"look_at", kDirectional | kSpot | kArea},
    {"direction", kDirectional | kSpot | kArea},
    {"angular_diameter", kDirectional},
    {"inner", kSpot},
    {"outer", kSpot},
    {"range", kPoint | kSpot},
    {"falloff", kSpot},
    {"radius", kPoint | kSpot},
    {"size", kArea},
};

unsigned bit_of(LightKind kind) { return 1u << static_cast<unsigned>(kind); }

std::string kind_name(LightKind kind) {
    return choices_of(*find_field("lights.type"))[static_cast<std::size_t>(kind)].name;
}

/// "an area", "a point or spot"
std::string kind_names(unsigned kinds) {
    std::string names;
    for (unsigned i = 0; i < 4; ++i) {
        if (!(kinds & (1u << i))) continue;
        if (!names.empty()) names += ", ";
        names += kind_name(static_cast<LightKind>(i));
    }
    return names;
}

void check_keys_of_kind(const Section& section, LightKind kind) {
    for (const KeyKinds& row : kKeyKinds) {
        if ((row.kinds & bit_of(kind)) || !section.has(row.key)) continue;
        section.context().problems.error(
            section.key_place(row.key),
            fmt::format("{}.{} does not apply to a light of type {}", section.name(), row.key, kind_name(kind)),
            fmt::format("{} belongs to lights of type {}; remove the key or change the type", row.key,
                        kind_names(row.kinds)));
    }
}

/// Candela of a light that sends its power evenly into all directions.
std::optional<Track<double>> intensity_of_power(std::optional<Track<double>> power) {
    if (!power) return std::nullopt;
    for (Key<double>& key : power->keys)
        for (double* number : {&key.value, &key.in_tangent, &key.out_tangent}) *number /= 4 * std::numbers::pi;
    return power;
}

void read_strength(const Section& section, LightSpec& light) {
    section.exclusive("intensity", "power");
    assign(light.strength, read_number_track(section["illuminance"]));
    assign(light.strength, read_number_track(section["luminance"]));
    assign(light.strength, read_number_track(section["intensity"]));
    assign(light.strength, intensity_of_power(read_number_track(section["power"])));
}

void read_place(const Section& section, LightSpec& light) {
    section.exclusive("direction", "look_at");
    assign(light.position, read_position_track(section["position"]));
    light.look_at = read_target(section["look_at"]);
    assign(light.direction, read_direction_track(section["direction"]));
}

void read_cone(const Section& section, LightSpec& light) {
    const auto inner = read_number_track(section["inner"]), outer = read_number_track(section["outer"]);
    assign(light.inner_rad, inner);
    assign(light.outer_rad, outer);
    assign(light.falloff, read_choice<SpotFalloff>(section["falloff"]));
    if (!inner) return;
    if (!light.inner_rad.is_constant() || !light.outer_rad.is_constant()) return note_cone(section["inner"], light.inner_rad, light.outer_rad);
    if (light.inner_rad.keys.front().value <= light.outer_rad.keys.front().value) return;
    const Field outer_field = section["outer"];
    section["inner"].error(
        fmt::format("{}.inner is {}, wider than outer at {}", section.name(), section["inner"].node->text,
                    outer_field ? outer_field.node->text : outer_field.spec->fallback),
        "expected inner to be at most outer; both are half-angles");
}

/// What is infinite has no value between it and another.
bool has_infinite_key(const Field& range) {
    const YamlNode* keys = range.node->find("keys");
    if (!keys || !keys->is_map()) return false;
    for (const YamlEntry& entry : keys->entries) {
        const YamlNode* inner = entry.value.is_map() ? entry.value.find("value") : nullptr;
        const YamlNode& value = inner ? *inner : entry.value;
        if (!value.is_scalar() || value.text != "infinite") continue;
        range.with(value, range.name).error(fmt::format("{} is infinite at a key", range.name),
                                            "expected a distance: nothing lies between it and infinity; key a large one, such as 1000 m");
        return true;
    }
    return false;
}

void read_range(const Field& range, LightSpec& light) {
    if (!range || is_word(range, "infinite")) return;
    if (range.node->is_map() && has_infinite_key(range)) return;
    assign(light.range_m, read_number_track(range));
}

void read_extent(const Section& section, LightSpec& light) {
    read_range(section["range"], light);
    assign(light.radius_m, read_number_track(section["radius"]));
    assign(light.angular_diameter_rad, read_number_track(section["angular_diameter"]));
    assign(light.size_m, read_vector2_track(section["size"]));
}

std::string light_name(const YamlNode& node, std::size_t index) {
    const YamlNode* id = node.find("id");
    return id && id->is_scalar() && !id->text.empty() ? fmt::format("lights.{}", id->text)
                                                      : fmt::format("lights.{}", index);
}

LightSpec read_light(const Section& shot, const YamlNode& node, std::size_t index) {
    LightSpec light;
    const Section section(shot.context(), &node, "lights", light_name(node, index));
    light.where = location_of(node.place);
    const auto kind = read_choice<LightKind>(section["type"]);
    if (kind) check_keys_of_kind(section, *kind);
    assign(light.kind, kind);
    light.id = read_text(section["id"]).value_or(fmt::format("{}-{}", kind_name(light.kind), index));
    assign(light.color, read_vector3_track(section["color"]));
    read_strength(section, light);
    read_place(section, light);
    read_cone(section, light);
    read_extent(section, light);
    assign(light.visible, read_switch_track(section["visible"]));
    return light;
}

void check_ids(const Field& list, const std::vector<LightSpec>& lights) {
    std::map<std::string, std::size_t> seen;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (seen.emplace(lights[i].id, i).second) continue;
        const YamlNode* id = list.node->items[i].find("id");
        list.context->problems.error(id ? id->place : list.node->items[i].place,
                                     fmt::format("two lights have the id '{}'", lights[i].id),
                                     "give each light an id of its own");
    }
}

const glm::dvec3 kSky(0.53, 0.81, 0.92);

}  // namespace

std::vector<LightSpec> read_lights(const Section& shot) {
    const Field list = shot["lights"];
    std::vector<LightSpec> lights;
    if (!list) return lights;
    const bool maps = list.node->is_list() && std::all_of(list.node->items.begin(), list.node->items.end(),
                                                          [](const YamlNode& item) { return item.is_map(); });
    if (!maps) {
        list.mismatch("for example lights: [ { id: key, type: point, intensity: 100 cd, position: [2, 3, 2] } ]");
        return lights;
    }
    for (std::size_t i = 0; i < list.node->items.size(); ++i)
        lights.push_back(read_light(shot, list.node->items[i], i));
    check_ids(list, lights);
    return lights;
}

EnvironmentSpec read_environment(const Section& shot, bool has_lights) {
    EnvironmentSpec environment;
    const Section section = shot.section("environment");
    environment.given = section.has("color") || section.has("image") || section.has("strength");
    if (section.present()) environment.where = location_of(shot.key_place("environment"));
    section.exclusive("color", "image");
    const bool sky = environment.given || !has_lights;
    environment.color = Track<glm::dvec3>(sky ? kSky : glm::dvec3(0));
    environment.image = read_existing_file(section["image"], {});
    if (section.has("image")) environment.color = Track<glm::dvec3>(glm::dvec3(1));
    assign(environment.color, read_vector3_track(section["color"]));
    assign(environment.strength, read_number_track(section["strength"]));
    assign(environment.rotate_rad, read_number_track(section["rotate"]));
    assign(environment.visible, read_boolean(section["visible"]));
    return environment;
}

}  // namespace kadr
