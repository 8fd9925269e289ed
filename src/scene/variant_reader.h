#pragma once

#include <string>
#include <vector>

#include "scene/gltf_document.h"

namespace kadr {

/// The material of a primitive under some of the file's variants (KHR_materials_variants).
struct VariantMapping {
    int material = -1;          ///< as the file numbers it
    std::vector<int> variants;  ///< as the file numbers them
};

/// Names of the file's variants.
std::vector<std::string> read_variants(const GltfDocument& document);

/// What a primitive wears under which variant.
/// @throws InputError  where one variant has two materials
std::vector<VariantMapping> read_variant_mappings(const GltfDocument& document, std::size_t mesh, std::size_t primitive);

}  // namespace kadr
