#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kadr {

/// Collects the textures that materials use, one per (image, colour space, sampler), then decodes them all at once: each
/// distinct image once, on all cores.
class TextureSet {
public:
    explicit TextureSet(GltfDocument& document) : document_(document) {}

    /// Index of the texture in the result of load(); -1 (with a warning) for a glTF texture that names no image.
    int use(int gltf_texture, bool srgb);

    /// Without options.decode_textures images are read and their headers checked, texels stay empty.
    std::vector<TextureData> load(const LoadOptions& options);

private:
    struct Use {
        std::size_t image;
        bool srgb;
        kernels::Wrap wrap_s, wrap_t;
        bool nearest;
        auto key() const { return std::tuple(image, srgb, wrap_s, wrap_t, nearest); }
    };

    GltfDocument& document_;
    std::vector<Use> uses_;
};

}  // namespace kadr
