#pragma once

#include "scene/scene.h"

namespace kadr {

/// The least green value that a lookup in a texture may give, linear: glTF's roughness. Filters give no less than the
/// texels they mix.
float least_green(const TextureData& texture);

}  // namespace kadr
