#pragma once

#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kadr {

/// The animations of a file; nodes as glTF numbers them. Of those that are not chosen the name and the number of channels.
/// @throws InputError  for times that do not increase, outputs of the wrong type or count, values that are not finite
std::vector<Clip> read_animations(GltfDocument& document, const ClipChoice& choice);

}  // namespace kadr
