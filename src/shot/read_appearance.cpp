// What a scene entry changes of how its file looks: materials, variant, visible.
#include <fmt/format.h>

#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

MaterialSpec read_material(const Section& section, const YamlEntry& entry) {
    MaterialSpec material;
    material.name = entry.key.text;
    material.where = location_of(entry.key.place);
    material.base_color = read_vector3_track(section["base_color"]);
    material.metallic = read_number_track(section["metallic"]);
    material.roughness = read_number_track(section["roughness"]);
    material.ior = read_number_track(section["ior"]);
    material.emissive = read_vector3_track(section["emissive"]);
    material.emissive_strength = read_number_track(section["emissive_strength"]);
    material.alpha = read_number_track(section["alpha"]);
    material.alpha_cutoff = read_number_track(section["alpha_cutoff"]);
    material.normal_scale = read_number_track(section["normal_scale"]);
    return material;
}

std::vector<MaterialSpec> read_materials(const Field& field) {
    std::vector<MaterialSpec> materials;
    if (!field) return materials;
    if (!field.node->is_map()) {
        field.mismatch("for example materials: { Paint: { base_color: [0.8, 0.1, 0.1] } }");
        return materials;
    }
    for (const YamlEntry& entry : field.node->entries) {
        const std::string name = fmt::format("{}.{}", field.name, entry.key.text);
        if (!entry.value.is_map())
            field.with(entry.value, name).error(fmt::format("{} is {}", name, shown_value(entry.value)),
                                                "expected a map such as { base_color: [0.8, 0.1, 0.1], roughness: 0.3 }");
        else
            materials.push_back(read_material(Section(*field.context, &entry.value, field.spec->path, name), entry));
    }
    return materials;
}

}  // namespace

void read_appearance(const Section& scene, SceneSpec& spec) {
    assign(spec.visible, read_switch_track(scene["visible"]));
    const Field variant = scene["variant"];
    if (!is_word(variant, "none")) spec.variant = read_text(variant);
    if (variant) spec.variant_where = location_of(variant.node->place);
    spec.materials = read_materials(scene["materials"]);
}

}  // namespace kadr
