#include "scene/accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace kadr {

namespace {

struct ComponentType {
    int code;
    std::size_t size;
    const char* name;
};
constexpr ComponentType kComponentTypes[] = {
    {TINYGLTF_COMPONENT_TYPE_BYTE, 1, "byte"},           {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, 1, "unsigned byte"},
    {TINYGLTF_COMPONENT_TYPE_SHORT, 2, "short"},         {TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, 2, "unsigned short"},
    {TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, 4, "unsigned int"}, {TINYGLTF_COMPONENT_TYPE_FLOAT, 4, "float"},
};

const ComponentType* find_type(int code) {
    for (const ComponentType& type : kComponentTypes)
        if (type.code == code) return &type;
    return nullptr;
}

/// Elements in a byte range that is known to hold them.
struct Elements {
    const std::uint8_t* first;
    std::size_t stride, count;
    int components;
};

/// Source: glTF 2.0 specification, 3.6.2.2 (integer to float).
template <class T>
float decode(const std::uint8_t* bytes, bool normalized) {
    T value;
    std::memcpy(&value, bytes, sizeof value);  // offsets need not be aligned in a broken file
    const float number = static_cast<float>(value);
    if (std::is_floating_point_v<T> || !normalized) return number;
    return std::max(number / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

template <class T>
void copy_elements(const Elements& from, bool normalized, float* out) {
    for (std::size_t i = 0; i < from.count; ++i) {
        const std::uint8_t* bytes = from.first + i * from.stride;
        for (int c = 0; c < from.components; ++c) *out++ = decode<T>(bytes + static_cast<std::size_t>(c) * sizeof(T), normalized);
    }
}

void decode_elements(const Elements& from, int component_type, bool normalized, float* out) {
    const std::size_t floats = from.count * static_cast<std::size_t>(from.components);
    if (component_type == TINYGLTF_COMPONENT_TYPE_FLOAT && from.stride == static_cast<std::size_t>(from.components) * sizeof(float)) {
        std::memcpy(out, from.first, floats * sizeof(float));
        return;
    }
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: return copy_elements<std::int8_t>(from, normalized, out);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return copy_elements<std::uint8_t>(from, normalized, out);
        case TINYGLTF_COMPONENT_TYPE_SHORT: return copy_elements<std::int16_t>(from, normalized, out);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return copy_elements<std::uint16_t>(from, normalized, out);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return copy_elements<std::uint32_t>(from, normalized, out);
        default: return copy_elements<float>(from, normalized, out);
    }
}

template <class T>
void copy_indices(const Elements& from, std::uint32_t* out) {
    for (std::size_t i = 0; i < from.count; ++i) {
        T value;
        std::memcpy(&value, from.first + i * from.stride, sizeof value);
        out[i] = static_cast<std::uint32_t>(value);
    }
}

void decode_indices(const Elements& from, int component_type, std::uint32_t* out) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return copy_indices<std::uint8_t>(from, out);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return copy_indices<std::uint16_t>(from, out);
        default: return copy_indices<std::uint32_t>(from, out);
    }
}

std::size_t element_size(const tinygltf::Accessor& accessor) {
    return component_size(accessor.componentType) * static_cast<std::size_t>(component_count(accessor.type));
}

Elements dense_elements(const GltfDocument& document, const tinygltf::Accessor& accessor) {
    const tinygltf::BufferView& view = document.model().bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    return {document.view(accessor.bufferView).data() + accessor.byteOffset, view.byteStride ? view.byteStride : element_size(accessor),
            accessor.count, component_count(accessor.type)};
}

std::vector<std::uint32_t> sparse_positions(const GltfDocument& document, const tinygltf::Accessor& accessor) {
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<std::size_t>(sparse.count);
    std::vector<std::uint32_t> positions(count);
    const std::uint8_t* first = document.view(sparse.indices.bufferView).data() + sparse.indices.byteOffset;
    decode_indices({first, component_size(sparse.indices.componentType), count, 1}, sparse.indices.componentType, positions.data());
    for (const std::uint32_t position : positions)
        if (position >= accessor.count)
            document.fail(fmt::format("/accessors/{}/sparse/indices", &accessor - document.model().accessors.data()),
                          fmt::format("replace element {}", position),
                          fmt::format("expected elements 0 to {}; the file is damaged", accessor.count - 1));
    return positions;
}

Elements sparse_values(const GltfDocument& document, const tinygltf::Accessor& accessor) {
    const auto& sparse = accessor.sparse;
    return {document.view(sparse.values.bufferView).data() + sparse.values.byteOffset, element_size(accessor),
            static_cast<std::size_t>(sparse.count), component_count(accessor.type)};
}

}  // namespace

std::size_t component_size(int component_type) {
    const ComponentType* type = find_type(component_type);
    return type ? type->size : 0;
}

int component_count(int accessor_type) {
    return tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor_type));
}

std::string describe_accessor(const tinygltf::Accessor& accessor) {
    const int components = component_count(accessor.type);
    const ComponentType* type = find_type(accessor.componentType);
    const std::string shape = accessor.type == TINYGLTF_TYPE_SCALAR ? "SCALAR" : accessor.type > 4 ? "a matrix" : fmt::format("VEC{}", components);
    return fmt::format("{} of {}{}", shape, type ? type->name : "unknown components", accessor.normalized ? ", normalized" : "");
}

void read_floats(const GltfDocument& document, int index, float* out) {
    const tinygltf::Accessor& accessor = document.model().accessors[static_cast<std::size_t>(index)];
    const auto components = static_cast<std::size_t>(component_count(accessor.type));
    if (accessor.bufferView >= 0) decode_elements(dense_elements(document, accessor), accessor.componentType, accessor.normalized, out);
    else std::fill_n(out, accessor.count * components, 0.0f);
    if (!accessor.sparse.isSparse) return;
    const std::vector<std::uint32_t> positions = sparse_positions(document, accessor);
    std::vector<float> values(positions.size() * components);
    decode_elements(sparse_values(document, accessor), accessor.componentType, accessor.normalized, values.data());
    for (std::size_t i = 0; i < positions.size(); ++i) std::copy_n(&values[i * components], components, out + positions[i] * components);
}

std::vector<float> read_floats(const GltfDocument& document, int index) {
    const tinygltf::Accessor& accessor = document.model().accessors[static_cast<std::size_t>(index)];
    std::vector<float> result(accessor.count * static_cast<std::size_t>(component_count(accessor.type)));
    read_floats(document, index, result.data());
    return result;
}

std::vector<std::uint32_t> read_indices(const GltfDocument& document, int index) {
    const tinygltf::Accessor& accessor = document.model().accessors[static_cast<std::size_t>(index)];
    std::vector<std::uint32_t> result(accessor.count);
    if (accessor.bufferView >= 0) decode_indices(dense_elements(document, accessor), accessor.componentType, result.data());
    if (!accessor.sparse.isSparse) return result;
    const std::vector<std::uint32_t> positions = sparse_positions(document, accessor);
    std::vector<std::uint32_t> values(positions.size());
    decode_indices(sparse_values(document, accessor), accessor.componentType, values.data());
    for (std::size_t i = 0; i < positions.size(); ++i) result[positions[i]] = values[i];
    return result;
}

}  // namespace kadr
