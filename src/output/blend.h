#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "film/film.h"
#include "shot/reel.h"

namespace kadr {

/// A picture of a mix and its share.
struct BlendLayer {
    const Image* image = nullptr;  ///< R, G, B, display-referred in [0, 1]
    double weight = 1;
};
/// A plain colour of a mix, display-referred, and its share.
struct BlendColor {
    glm::dvec3 color{0};
    double weight = 0;
};

/// The weighted mean of pictures of one size and of colours; the weights add up to 1. `display` mixes the values as they
/// are, as editing programs do; `linear` mixes the light that the display makes of them (sRGB curve, IEC 61966-2-1).
/// A single picture of weight 1 comes back bit for bit.
Image blend(const std::vector<BlendLayer>& layers, const std::vector<BlendColor>& colors, ReelBlend space);

/// The colours of a display-referred image of any channels, in the middle of a picture of this size; what it does not
/// cover has the colour of the bars. A larger image is cut. Alpha is dropped: premultiplied colour is over black.
Image centred(const Image& display, int width, int height, const glm::dvec3& bars);

}  // namespace kadr
