#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kadr {

/// Where the vertices of a geometry come from: `vertices` were read from accessors of `elements` elements, in their
/// order or (flat meshes with a normal texture) as `source` says.
struct VertexSource {
    std::string pointer;                 ///< of the primitive
    std::size_t elements = 0;
    std::vector<std::uint32_t> source;   ///< [vertex] element; empty: the same order
};

/// JOINTS_n and WEIGHTS_n of any number of sets. Weights are made to add up to 1; a vertex without any goes to the first
/// joint, with one warning for a primitive.
/// @throws InputError  for wrong types or counts, a set that is half there, weights that are not finite
SkinWeights read_skin_weights(const GltfDocument& document, const tinygltf::Primitive& primitive, const VertexSource& vertices,
                              std::vector<Diagnostic>& warnings);

/// Morph targets; positions are divided by `scale`.
/// @throws InputError  for wrong types or counts, values that are not finite
std::vector<MorphTarget> read_morph_targets(const GltfDocument& document, const tinygltf::Primitive& primitive, const VertexSource& vertices,
                                            double scale, std::vector<Diagnostic>& warnings);

/// The skins of a file; nodes as glTF numbers them. `skeleton` is ignored, as the specification says (3.7.3.1). Joints of
/// several trees have no root: -1. Without matrices.
/// @throws InputError  for a skin without joints, or with too many
std::vector<Skin> read_skins(const GltfDocument& document, const std::vector<Node>& nodes);

/// Skin::inverse_bind of a skin.
/// @throws InputError  for too few matrices, matrices that are not finite or not affine
std::vector<glm::dmat4> read_bind_matrices(const GltfDocument& document, std::size_t skin);

/// Morph weights at rest of every node with a mesh: the node's, else the mesh's, else 0.
/// @throws InputError  for another number of weights than the mesh has targets, or primitives that disagree
void read_morph_weights(const GltfDocument& document, std::vector<Node>& nodes);

/// Number of morph targets of a mesh: of its first primitive.
std::size_t target_count(const tinygltf::Mesh& mesh);

}  // namespace kadr
