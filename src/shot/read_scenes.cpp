#include <fmt/format.h>

#include <map>

#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

/// Which parts of a transform its section gives.
struct GivenParts {
    bool translate = false, rotate = false, scale = false;
};

GivenParts read_transform(const Section& section, TransformTrack& transform) {
    assign(transform.translate, read_position_track(section["translate"], true));
    assign(transform.rotate, read_rotation_track(section["rotate"]));
    assign(transform.scale, read_scale_track(section["scale"]));
    return {section.has("translate"), section.has("rotate"), section.has("scale")};
}

void read_node_override(const Field& nodes, const YamlEntry& entry, SceneSpec& spec) {
    const std::string name = fmt::format("{}.{}", nodes.name, entry.key.text);
    if (!entry.value.is_map()) {
        nodes.with(entry.value, name).error(fmt::format("{} is {}", name, shown_value(entry.value)), "expected a map such as { rotate: [0, 90 deg, 0] }");
        return;
    }
    const Section section(*nodes.context, &entry.value, "scenes.nodes", name);
    NodeOverride node;
    node.name = entry.key.text;
    node.where = location_of(entry.key.place);
    const GivenParts given = read_transform(section, node.transform);
    node.translates = given.translate, node.rotates = given.rotate, node.scales = given.scale;
    node.visible = read_switch_track(section["visible"]);
    node.weights = read_weight_tracks(section["weights"]);
    if (const Field weights = section["weights"]) node.weights_where = location_of(weights.node->place);
    spec.nodes.push_back(std::move(node));
}

void read_nodes(const Field& nodes, SceneSpec& spec) {
    if (!nodes) return;
    if (!nodes.node->is_map()) return nodes.mismatch();
    for (const YamlEntry& entry : nodes.node->entries) read_node_override(nodes, entry, spec);
}

void read_hide(const Field& hide, SceneSpec& spec) {
    if (!hide) return;
    if (!hide.node->is_list()) return hide.mismatch("write [ Name ] for one");
    for (std::size_t i = 0; i < hide.node->items.size(); ++i) {
        const YamlNode& item = hide.node->items[i];
        if (item.is_scalar() && !item.text.empty()) {
            spec.hide.push_back({item.text, location_of(item.place)});
            continue;
        }
        const Field field = hide.with(item, fmt::format("{}.{}", hide.name, i));
        field.error(fmt::format("{} is {}", field.name, shown_value(item)), "expected a node's name, or Parent/Node");
    }
}

void read_gltf(const Field& field, SceneSpec& spec) {
    if (!field) return;
    spec.where = location_of(field.node->place);
    assign(spec.gltf, read_existing_file(field, {".gltf", ".glb"}));
    if (spec.id.empty()) spec.id = std::filesystem::path(field.node->text).stem().string();
}

/// Message name of a list entry: by its id when it has one, by its place otherwise; `--set` takes both.
std::string entry_name(std::string_view list, const YamlNode& entry, std::size_t index) {
    const YamlNode* id = entry.find("id");
    return id && id->is_scalar() && !id->text.empty() ? fmt::format("{}.{}", list, id->text)
                                                      : fmt::format("{}.{}", list, index);
}

void read_id(const Field& field, SceneSpec& spec) {
    const auto id = read_text(field);
    if (!id) return;
    if (id->find('/') != std::string::npos)
        field.error(fmt::format("{} is '{}'", field.name, *id),
                    "expected a name without '/', which separates a scene from its nodes");
    spec.id = *id;
}

SceneSpec read_scene(const Section& shot, const Field& list, const YamlNode& node, std::size_t index) {
    SceneSpec spec;
    if (node.is_scalar()) {  // a bare path
        Field path = list.with(node, fmt::format("scenes.{}", index));
        path.spec = find_field("scenes.gltf");
        read_gltf(path, spec);
        return spec;
    }
    if (!node.is_map()) {
        list.with(node, fmt::format("scenes.{}", index))
            .error(fmt::format("scenes.{} is {}", index, shown_value(node)),
                   "expected a map such as { id: helmet, gltf: assets/helmet.glb }");
        return spec;
    }
    const Section section(shot.context(), &node, "scenes", entry_name("scenes", node, index));
    read_id(section["id"], spec);
    read_gltf(section["gltf"], spec);
    read_transform(section.section("transform"), spec.transform);
    spec.layers = read_animation(section);
    read_nodes(section["nodes"], spec);
    read_hide(section["hide"], spec);
    assign(spec.skinning, read_choice<Skinning>(section["skinning"]));
    read_appearance(section, spec);
    spec.instances = read_instances(section);
    return spec;
}

const YamlPlace& id_place(const YamlNode& entry) {
    const YamlNode* id = entry.find("id");
    return id ? id->place : entry.place;
}

void check_ids(const Field& list, const std::vector<SceneSpec>& scenes) {
    std::map<std::string, std::size_t> seen;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const auto [first, fresh] = seen.emplace(scenes[i].id, i);
        if (fresh || scenes[i].id.empty()) continue;
        list.context->problems.error(id_place(list.node->items[i]),
                                     fmt::format("two scenes have the id '{}'", scenes[i].id),
                                     "give each scene an id of its own");
    }
}

}  // namespace

std::vector<SceneSpec> read_scenes(const Section& shot) {
    const Field list = shot["scenes"];
    std::vector<SceneSpec> scenes;
    if (!list) return scenes;  // reported as missing
    if (!list.node->is_list() || list.node->items.empty()) {
        list.mismatch("for example scenes: [ { gltf: assets/helmet.glb } ]");
        return scenes;
    }
    for (std::size_t i = 0; i < list.node->items.size(); ++i)
        scenes.push_back(read_scene(shot, list, list.node->items[i], i));
    check_ids(list, scenes);
    return scenes;
}

}  // namespace kadr
