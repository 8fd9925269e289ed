#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "scene/gltf_document.h"

namespace kadr {

/// Bytes of a component type (5120 to 5126), 0 for others.
std::size_t component_size(int component_type);
int component_count(int accessor_type);
/// "VEC3 of unsigned short, normalised", as messages say it.
std::string describe_accessor(const tinygltf::Accessor& accessor);

/// All elements as floats, component after component: interleaved, normalised and sparse storage are resolved.
/// The accessor's bounds must have been checked (GltfDocument does).
std::vector<float> read_floats(const GltfDocument& document, int accessor);
/// The same into memory for count * components floats.
void read_floats(const GltfDocument& document, int accessor, float* out);
/// Elements of a scalar unsigned integer accessor.
std::vector<std::uint32_t> read_indices(const GltfDocument& document, int accessor);

}  // namespace kadr
