#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf_document.h"

namespace kadr {

/// What an image's first bytes say.
struct ImageHeader {
    int width = 0, height = 0;
    int bits = 8;   ///< 8 or 16 a channel, as they will be decoded
};

struct DecodedImage {
    int width = 0, height = 0;
    int bits = 8;                       ///< 8 or 16 a channel
    std::vector<std::uint8_t> texels;   ///< RGBA, rows from the top
};

/// Size and depth of a PNG or JPEG image.
/// @throws InputError  at `pointer`, when the bytes are neither (naming KTX2, WebP and others), or beyond the limits
///                     (32768 pixels a side, 2^28 pixels, and no more than the compressed bytes can hold)
ImageHeader read_image_header(const GltfDocument& document, const std::string& pointer, ByteView bytes);

/// All texels. @throws InputError when the image cannot be decoded
DecodedImage decode_image(const GltfDocument& document, const std::string& pointer, ByteView bytes);

}  // namespace kadr
