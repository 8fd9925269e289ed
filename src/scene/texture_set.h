#pragma once

#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kadr {

/// Collects the textures that materials use, one per (image, colour space, sampler), then decodes those that are needed all
/// at once: each distinct image once, on all cores.
class TextureSet {
public:
    explicit TextureSet(GltfDocument& document) : document_(document) {}

    /// Number of the texture among outlines(); -1 (with a warning) for a glTF texture that names no image.
    int use(int gltf_texture, bool srgb);

    /// All that were asked for, without size or texels.
    std::vector<TextureData> outlines() const;
    /// Names of the document's images that no texture of the set shows.
    std::vector<std::string> unused_images() const;

    /// Fills in the textures that are needed. Without options.decode_textures images are read and their headers checked,
    /// texels stay empty.
    /// @param textures  outlines(); @param needed  [texture]
    void load(const LoadOptions& options, const std::vector<bool>& needed, std::span<TextureData> textures);

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
