#pragma once

#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kadr {

/// Reads EXT_mesh_gpu_instancing: the places at which a node's mesh stands.
/// Source: the extension's README in KhronosGroup/glTF.
class InstancingReader {
public:
    explicit InstancingReader(GltfDocument& document) : document_(document) {}

    /// Gives the nodes that have the extension their set of places; nodes with the same accessors share one.
    /// @throws InputError  attributes of another shape or number, values that are not finite, a quaternion without length
    void read(std::vector<Node>& nodes, std::vector<std::vector<Placement>>& sets);

private:
    /// Accessors of a node's TRANSLATION, ROTATION and SCALE; -1: the node has none.
    struct Attributes {
        int translation = -1, rotation = -1, scale = -1;
        std::size_t count = 0;
        auto operator<=>(const Attributes&) const = default;
    };
    Attributes attributes_of(std::size_t node, const nlohmann::json& attributes) const;
    std::vector<Placement> read_set(std::size_t node, const Attributes& attributes) const;
    std::vector<float> read_finite(std::size_t node, const char* name, int accessor) const;

    GltfDocument& document_;
};

}  // namespace kadr
