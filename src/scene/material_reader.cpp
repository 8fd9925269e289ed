#include "scene/material_reader.h"

#include <fmt/format.h>

#include <cmath>

namespace kadr {

namespace {

using kernels::AlphaMode;
using kernels::TextureSlot;

const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto found = extensions.find(name);
    return found == extensions.end() ? nullptr : &found->second;
}

double number(const tinygltf::Value& object, const char* key, double otherwise) {
    return object.Has(key) && object.Get(key).IsNumber() ? object.Get(key).GetNumberAsDouble() : otherwise;
}

double number_at(const tinygltf::Value& object, const char* key, int index, double otherwise) {
    if (!object.Has(key) || !object.Get(key).IsArray() || object.Get(key).ArrayLen() <= static_cast<std::size_t>(index)) return otherwise;
    return object.Get(key).Get(index).GetNumberAsDouble();
}

TextureTransform transform_of(const tinygltf::ExtensionMap& extensions) {
    TextureTransform result;
    const tinygltf::Value* transform = extension(extensions, "KHR_texture_transform");
    if (!transform) return result;
    result.offset = {number_at(*transform, "offset", 0, 0), number_at(*transform, "offset", 1, 0)};
    result.rotation_rad = number(*transform, "rotation", 0);
    result.scale = {number_at(*transform, "scale", 0, 1), number_at(*transform, "scale", 1, 1)};
    return result;
}

template <class Info>
int uv_set_of(const Info& info) {
    const tinygltf::Value* transform = extension(info.extensions, "KHR_texture_transform");
    return transform ? static_cast<int>(number(*transform, "texCoord", info.texCoord)) : info.texCoord;
}

struct SlotReader {
    const GltfDocument& document;
    std::string pointer;  ///< of the material
    TextureSet& textures;

    template <class Info>
    TextureSlot read(const Info& info, const char* member, bool srgb) const {
        TextureSlot slot;
        if (info.index < 0) return slot;
        slot.uv_set = uv_set_of(info);
        if (slot.uv_set > 1)
            document.fail(fmt::format("{}/{}", pointer, member), fmt::format("uses TEXCOORD_{}: more than two sets of texture coordinates are not supported yet", slot.uv_set),
                          "expected texCoord 0 or 1");
        slot.texture = textures.use(info.index, srgb);
        return transformed(slot, transform_of(info.extensions));
    }
};

AlphaMode alpha_mode(const std::string& name) {
    if (name == "MASK") return AlphaMode::mask;
    return name == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
}

kernels::Vec3f vector3(const std::vector<double>& values, float otherwise) {
    if (values.size() < 3) return {otherwise, otherwise, otherwise};
    return {static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2])};
}

double emissive_strength(const tinygltf::Material& source) {
    const tinygltf::Value* strength = extension(source.extensions, "KHR_materials_emissive_strength");
    return strength ? number(*strength, "emissiveStrength", 1) : 1;
}

/// Either of the two meanings that the extension knows.
double index_of_refraction(const GltfDocument& document, std::size_t material) {
    const tinygltf::Value* values = extension(document.model().materials[material].extensions, "KHR_materials_ior");
    const double ior = values ? number(*values, "ior", kDefaultIor) : kDefaultIor;
    if (ior > 0 && ior < 1)
        document.fail(fmt::format("/materials/{}/extensions/KHR_materials_ior/ior", material), fmt::format("is {}", ior),
                      "expected an index of refraction of at least 1, or 0: all light is reflected");
    return ior;
}

}  // namespace

/// Source: KHR_materials_ior; Fresnel's equations at normal incidence. An index of 0 stands for an infinite one.
float dielectric_f0(double ior) {
    const double r = (ior - 1) / (ior + 1);
    return static_cast<float>(r * r);
}

/// Source: KHR_texture_transform (the text; its TextureTransformTest tells the sign of the rotation).
TextureSlot transformed(TextureSlot slot, const TextureTransform& transform) {
    const double c = std::cos(transform.rotation_rad), s = std::sin(transform.rotation_rad);
    slot.m00 = static_cast<float>(c * transform.scale.x);
    slot.m01 = static_cast<float>(s * transform.scale.y);
    slot.m02 = static_cast<float>(transform.offset.x);
    slot.m10 = static_cast<float>(-s * transform.scale.x);
    slot.m11 = static_cast<float>(c * transform.scale.y);
    slot.m12 = static_cast<float>(transform.offset.y);
    return slot;
}

MaterialSource material_source(const GltfDocument& document, std::size_t index) {
    const tinygltf::Material& source = document.model().materials[index];
    MaterialSource result;
    result.index = static_cast<int>(index);
    if (source.emissiveFactor.size() == 3) result.emissive = {source.emissiveFactor[0], source.emissiveFactor[1], source.emissiveFactor[2]};
    result.emissive_strength = emissive_strength(source);
    result.ior = index_of_refraction(document, index);
    result.transforms = {transform_of(source.pbrMetallicRoughness.baseColorTexture.extensions), transform_of(source.pbrMetallicRoughness.metallicRoughnessTexture.extensions),
                         transform_of(source.normalTexture.extensions), transform_of(source.emissiveTexture.extensions), transform_of(source.occlusionTexture.extensions)};
    return result;
}

int normal_uv_set(const GltfDocument& document, int material) {
    if (material < 0) return -1;
    const tinygltf::NormalTextureInfo& info = document.model().materials[static_cast<std::size_t>(material)].normalTexture;
    return info.index < 0 ? -1 : uv_set_of(info);
}

kernels::Material read_material(const GltfDocument& document, std::size_t index, TextureSet& textures) {
    const tinygltf::Material& source = document.model().materials[index];
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    const SlotReader slots{document, fmt::format("/materials/{}", index), textures};
    kernels::Material material;
    material.base_color = vector3(pbr.baseColorFactor, 1);
    material.alpha = pbr.baseColorFactor.size() == 4 ? static_cast<float>(pbr.baseColorFactor[3]) : 1.0f;
    material.metallic = static_cast<float>(pbr.metallicFactor);
    material.roughness = static_cast<float>(pbr.roughnessFactor);
    material.emission = vector3(source.emissiveFactor, 0) * static_cast<float>(emissive_strength(source));
    material.dielectric_f0 = dielectric_f0(index_of_refraction(document, index));
    material.unlit = extension(source.extensions, "KHR_materials_unlit") != nullptr;
    material.alpha_mode = alpha_mode(source.alphaMode);
    material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
    material.double_sided = source.doubleSided;
    material.normal_scale = static_cast<float>(source.normalTexture.scale);
    material.occlusion_strength = static_cast<float>(source.occlusionTexture.strength);
    material.base_color_texture = slots.read(pbr.baseColorTexture, "pbrMetallicRoughness/baseColorTexture", true);
    material.metallic_roughness_texture = slots.read(pbr.metallicRoughnessTexture, "pbrMetallicRoughness/metallicRoughnessTexture", false);
    material.normal_texture = slots.read(source.normalTexture, "normalTexture", false);
    material.emissive_texture = slots.read(source.emissiveTexture, "emissiveTexture", true);
    material.occlusion_texture = slots.read(source.occlusionTexture, "occlusionTexture", false);
    return material;
}

}  // namespace kadr
