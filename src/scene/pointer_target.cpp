#include "scene/pointer_target.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>
#include <vector>

namespace kadr {

namespace {

/// One property that clips may drive; '#' stands for the number of an object.
struct Pattern {
    std::string_view text;
    Property property;
    int components = 1;
    TextureUse use = TextureUse::base_color;
};

// Source: glTF 2.0 Asset Object Model, and the extensions' own pointers.
constexpr Pattern kPatterns[] = {
    {"/nodes/#/extensions/KHR_node_visibility/visible", Property::node_visible},
    {"/materials/#/pbrMetallicRoughness/baseColorFactor", Property::base_color, 4},
    {"/materials/#/pbrMetallicRoughness/metallicFactor", Property::metallic},
    {"/materials/#/pbrMetallicRoughness/roughnessFactor", Property::roughness},
    {"/materials/#/emissiveFactor", Property::emissive, 3},
    {"/materials/#/extensions/KHR_materials_emissive_strength/emissiveStrength", Property::emissive_strength},
    {"/materials/#/extensions/KHR_materials_ior/ior", Property::ior},
    {"/materials/#/alphaCutoff", Property::alpha_cutoff},
    {"/materials/#/normalTexture/scale", Property::normal_scale},
    {"/materials/#/occlusionTexture/strength", Property::occlusion_strength},
    {"/extensions/KHR_lights_punctual/lights/#/color", Property::light_color, 3},
    {"/extensions/KHR_lights_punctual/lights/#/intensity", Property::light_intensity},
    {"/extensions/KHR_lights_punctual/lights/#/range", Property::light_range},
    {"/extensions/KHR_lights_punctual/lights/#/spot/innerConeAngle", Property::light_inner},
    {"/extensions/KHR_lights_punctual/lights/#/spot/outerConeAngle", Property::light_outer},
    {"/cameras/#/perspective/yfov", Property::camera_yfov},
    {"/cameras/#/perspective/znear", Property::camera_znear},
    {"/cameras/#/perspective/zfar", Property::camera_zfar},
    {"/cameras/#/orthographic/xmag", Property::camera_xmag},
    {"/cameras/#/orthographic/ymag", Property::camera_ymag},
    {"/cameras/#/orthographic/znear", Property::camera_znear},
    {"/cameras/#/orthographic/zfar", Property::camera_zfar},
};

constexpr std::string_view kNodePaths[] = {"translation", "rotation", "scale", "weights"};

struct NamedUse {
    std::string_view text;
    TextureUse use;
};
constexpr NamedUse kTextures[] = {
    {"pbrMetallicRoughness/baseColorTexture", TextureUse::base_color}, {"pbrMetallicRoughness/metallicRoughnessTexture", TextureUse::metallic_roughness},
    {"normalTexture", TextureUse::normal},                             {"emissiveTexture", TextureUse::emissive},
    {"occlusionTexture", TextureUse::occlusion},
};
constexpr Pattern kTransforms[] = {
    {"offset", Property::texture_offset, 2},
    {"rotation", Property::texture_rotation},
    {"scale", Property::texture_scale, 2},
};

/// The number where the pattern has '#', when everything else is the same.
std::optional<int> match(std::string_view pattern, std::string_view text) {
    const std::size_t mark = pattern.find('#');
    if (text.substr(0, mark) != pattern.substr(0, mark)) return std::nullopt;
    int number = -1;
    const char* const end = text.data() + text.size();
    const auto [after, problem] = std::from_chars(text.data() + mark, end, number);
    if (problem != std::errc() || number < 0 || std::string_view(after, static_cast<std::size_t>(end - after)) != pattern.substr(mark + 1)) return std::nullopt;
    return number;
}

std::optional<PointerTarget> match_node(const std::string& text) {
    for (const std::string_view path : kNodePaths)
        if (const auto node = match(fmt::format("/nodes/#/{}", path), text)) {
            PointerTarget target;
            target.node = *node;
            target.node_path = path;
            return target;
        }
    return std::nullopt;
}

std::optional<PointerTarget> match_pattern(std::string_view pattern, const Pattern& row, TextureUse use, const std::string& text) {
    const auto index = match(pattern, text);
    if (!index) return std::nullopt;
    PointerTarget target;
    target.property = row.property;
    target.use = use;
    target.index = *index;
    target.components = row.components;
    target.is_switch = row.property == Property::node_visible;
    return target;
}

std::optional<PointerTarget> match_any(const std::string& text) {
    if (auto target = match_node(text)) return target;
    for (const Pattern& row : kPatterns)
        if (auto target = match_pattern(row.text, row, row.use, text)) return target;
    for (const NamedUse& texture : kTextures)
        for (const Pattern& row : kTransforms)
            if (auto target = match_pattern(fmt::format("/materials/#/{}/extensions/KHR_texture_transform/{}", texture.text, row.text), row, texture.use, text)) return target;
    return std::nullopt;
}

struct Collection {
    const char* name;
    std::size_t count;
};

Collection collection_of(const GltfDocument& document, const PointerTarget& target) {
    const tinygltf::Model& model = document.model();
    if (target.node >= 0) return {"/nodes", model.nodes.size()};
    switch (owner_of(target.property)) {
        case PropertyOwner::node: return {"/nodes", model.nodes.size()};
        case PropertyOwner::material: return {"/materials", model.materials.size()};
        case PropertyOwner::light: return {"/extensions/KHR_lights_punctual/lights", model.lights.size()};
        case PropertyOwner::camera: break;
    }
    return {"/cameras", model.cameras.size()};
}

/// A camera has the properties of its own type alone.
bool exists(const GltfDocument& document, const PointerTarget& target, const std::string& text) {
    if (target.node >= 0 || owner_of(target.property) != PropertyOwner::camera) return true;
    return text.find("/" + document.model().cameras[static_cast<std::size_t>(target.index)].type + "/") != std::string::npos;
}

}  // namespace

std::optional<PointerTarget> parse_pointer(const GltfDocument& document, const std::string& text, const std::string& where) {
    constexpr std::size_t kLongest = 120;
    if (text.empty() || text.front() != '/')
        document.fail(where, fmt::format("is \"{}\"", text.substr(0, kLongest)), "expected a JSON pointer such as /materials/0/emissiveFactor");
    const std::optional<PointerTarget> target = match_any(text);
    if (!target) return std::nullopt;
    const Collection collection = collection_of(document, *target);
    const int index = target->node >= 0 ? target->node : target->index;
    if (static_cast<std::size_t>(index) >= collection.count)
        document.fail(where, fmt::format("is \"{}\"", text.substr(0, kLongest)),
                      collection.count ? fmt::format("expected an index into {}: 0 to {}", collection.name, collection.count - 1)
                                       : fmt::format("expected an index into {}, but the file has none", collection.name));
    return exists(document, *target, text) ? target : std::nullopt;
}

}  // namespace kadr
