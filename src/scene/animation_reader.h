#pragma once

#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kadr {

/// The animations of a file; nodes as glTF numbers them.
/// @throws InputError  for times that do not increase, outputs of the wrong type or count, values that are not finite
std::vector<Clip> read_animations(GltfDocument& document);

}  // namespace kadr
