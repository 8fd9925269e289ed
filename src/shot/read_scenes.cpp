#include <fmt/format.h>

#include <map>

#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

void read_transform(const Section& scene, SceneSpec& spec) {
    const Section section = scene.section("transform");
    assign(spec.transform.translate, read_position_track(section["translate"], true));
    assign(spec.transform.rotate, read_rotation_track(section["rotate"]));
    assign(spec.transform.scale, read_scale_track(section["scale"]));
}

void read_clip(const Field& clip, SceneSpec& spec) {
    if (!clip) return;
    spec.clip_where = location_of(clip.node->place);
    if (clip.node->is_map() || clip.node->is_list()) {
        clip.error(fmt::format("{}: several clips with weights are not supported yet", clip.name),
                   "expected " + expectation(*clip.spec));
    } else if (is_word(clip, "all")) {
        spec.clips = SceneSpec::Clips::all;
    } else if (is_word(clip, "none")) {
        spec.clips = SceneSpec::Clips::none;
    } else if (looks_like_number(*clip.node)) {
        spec.clips = SceneSpec::Clips::one;
        const auto index = read_integer(clip);
        if (index && (*index < 0 || *index > 1000000))
            clip.mismatch("an index counts from 0");
        else
            assign(spec.clip_index, index);
    } else if (const auto name = read_text(clip)) {
        spec.clips = SceneSpec::Clips::one;
        spec.clip_name = *name;
    }
}

void read_animation(const Section& scene, SceneSpec& spec) {
    const Section section = scene.section("animation");
    read_clip(section["clip"], spec);
    assign(spec.clip_start_s, read_number(section["start"]));
    assign(spec.clip_speed, read_number(section["speed"]));
    read_choice_index(section["loop"]);
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
    assign(spec.skinning, read_choice<Skinning>(section["skinning"]));
    read_transform(section, spec);
    read_animation(section, spec);
    read_appearance(section, spec);
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
