#pragma once

#include <functional>

#include "scene/scene.h"

namespace kadr {

/// The least green value that a lookup in a texture may give, linear: glTF's roughness. Filters give no less than the
/// texels they mix.
float least_green(const TextureData& texture);

/// Whether a material reflects, at some point of it, in a lobe that only kernels with requirement::kMirrors draw.
/// @param least  least_green of a texture of its scene; asked where it has one for its roughness
bool is_mirror(const kernels::Material& material, const std::function<float(int texture)>& least);

}  // namespace kadr
