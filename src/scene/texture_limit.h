#pragma once

#include "scene/scene.h"

namespace kadr {

/// Averages a texture down so that its longer side has no more than `limit_px` texels; smaller ones stay as they are.
/// Each new texel is the mean of the area that it covers, in linear light; colour and alpha are averaged apart, as the
/// fetches of the kernels interpolate them apart.
///
/// @pre limit_px > 0; without texels (headers alone were read) only the size changes
void limit_size(TextureData& texture, int limit_px);

}  // namespace kadr
