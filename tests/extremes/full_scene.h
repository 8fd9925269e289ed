#pragma once

#include "scene/gltf_builder.h"

namespace kadr::test {

/// A file that has every kind of number that Kadr reads: a textured square ("Square"), a skinned one ("Cloth"), one that
/// bends by morph targets ("Morph"), copies ("Crowd"), a spot ("Lamp"), a camera ("Camera"), a node with a matrix, and the clip
/// "all" that moves nodes, weights, a material, a light and a camera.
void fill_with_everything(GltfBuilder& file);

}  // namespace kadr::test
