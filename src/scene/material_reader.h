#pragma once

#include "scene/gltf_document.h"
#include "scene/scene.h"
#include "scene/texture_set.h"

namespace kadr {

/// One glTF material; its textures are registered with `textures`.
/// @throws InputError for texture coordinates beyond the second set, and for an index of refraction that there is not
kernels::Material read_material(const GltfDocument& document, std::size_t index, TextureSet& textures);

/// The factors that read_material multiplied.
MaterialSource material_source(const GltfDocument& document, std::size_t index);

/// Texture coordinates of the material's normal texture (with KHR_texture_transform's override); -1: it has none.
int normal_uv_set(const GltfDocument& document, int material);

}  // namespace kadr
