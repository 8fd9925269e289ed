#pragma once

#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kadr {

/// The node tree without meshes: names, parents, transforms, lights and cameras, as glTF numbers them.
/// @throws InputError  for nodes with two parents, cycles, singular quaternions, matrices with a projection
std::vector<Node> read_nodes(const GltfDocument& document);

/// Root nodes of the default scene: of `scene`, else of the first scene, else every node without parent.
std::vector<int> read_roots(const GltfDocument& document, const std::vector<Node>& nodes);

std::vector<SceneLight> read_lights(const GltfDocument& document);
std::vector<SceneCamera> read_cameras(const GltfDocument& document);

}  // namespace kadr
