#include "scene/texture_set.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <exception>

#include "scene/image_decoder.h"
#include "scene/texture_limit.h"

namespace kadr {

namespace {

using kernels::TexelFormat;
using kernels::Wrap;

Wrap wrap_of(int gltf_wrap) {
    if (gltf_wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp_to_edge;
    if (gltf_wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::mirrored_repeat;
    return Wrap::repeat;
}

TexelFormat format_of(int bits, bool srgb) {
    if (bits == 16) return srgb ? TexelFormat::rgba16_srgb : TexelFormat::rgba16_linear;
    return srgb ? TexelFormat::rgba8_srgb : TexelFormat::rgba8_linear;
}

/// Runs all tasks in parallel; of several failures the first in order is thrown, so that messages do not depend on timing.
template <class Task>
void run_all(std::size_t count, const Task& task) {
    std::vector<std::exception_ptr> failures(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        try {
            task(i);
        } catch (...) {
            failures[i] = std::current_exception();
        }
    });
    for (const std::exception_ptr& failure : failures)
        if (failure) std::rethrow_exception(failure);
}

/// Which images have the same bytes: for each, the first that has.
std::vector<std::size_t> first_of_same_bytes(const std::vector<ByteView>& images) {
    std::vector<std::size_t> first(images.size());
    for (std::size_t i = 0; i < images.size(); ++i) {
        first[i] = i;
        for (std::size_t j = 0; j < i && first[i] == i; ++j)
            if (first[j] == j && std::equal(images[i].begin(), images[i].end(), images[j].begin(), images[j].end())) first[i] = j;
    }
    return first;
}

}  // namespace

int TextureSet::use(int gltf_texture, bool srgb) {
    const tinygltf::Texture& texture = document_.model().textures[static_cast<std::size_t>(gltf_texture)];
    if (texture.source < 0) {
        const nlohmann::json& json = document_.json()["textures"][static_cast<std::size_t>(gltf_texture)];
        const std::string pointer = fmt::format("/textures/{}", gltf_texture);
        if (const auto extensions = json.find("extensions"); extensions != json.end() && extensions->is_object() && !extensions->empty())
            document_.fail(pointer, fmt::format("has its image only in {}, which is not supported yet", extensions->begin().key()),
                           "export the textures as PNG or JPEG");
        Diagnostic warning = document_.warning(pointer, "names no image (source); the texture is left out");
        const auto same = [&](const Diagnostic& other) { return other.found == warning.found; };
        if (std::none_of(document_.warnings.begin(), document_.warnings.end(), same)) document_.warnings.push_back(std::move(warning));
        return -1;
    }
    Use wanted{static_cast<std::size_t>(texture.source), srgb, Wrap::repeat, Wrap::repeat, false};
    if (texture.sampler >= 0) {
        const tinygltf::Sampler& sampler = document_.model().samplers[static_cast<std::size_t>(texture.sampler)];
        wanted.wrap_s = wrap_of(sampler.wrapS);
        wanted.wrap_t = wrap_of(sampler.wrapT);
        wanted.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    const auto found = std::find_if(uses_.begin(), uses_.end(), [&](const Use& other) { return other.key() == wanted.key(); });
    const auto index = static_cast<int>(found - uses_.begin());
    if (found == uses_.end()) uses_.push_back(wanted);
    return index;
}

std::vector<TextureData> TextureSet::outlines() const {
    std::vector<TextureData> textures;
    for (const Use& use : uses_) {
        TextureData& texture = textures.emplace_back();
        texture.name = document_.image_name(use.image);
        texture.format = format_of(8, use.srgb);
        texture.wrap_s = use.wrap_s;
        texture.wrap_t = use.wrap_t;
        texture.nearest = use.nearest;
    }
    return textures;
}

std::vector<std::string> TextureSet::unused_images() const {
    std::vector<std::string> names;
    for (std::size_t image = 0; image < document_.image_count(); ++image)
        if (std::none_of(uses_.begin(), uses_.end(), [image](const Use& use) { return use.image == image; })) names.push_back(document_.image_name(image));
    return names;
}

void TextureSet::load(const LoadOptions& options, const std::vector<bool>& needed, std::span<TextureData> textures) {
    std::vector<std::size_t> images;  // those in use, ascending
    for (std::size_t i = 0; i < uses_.size(); ++i)
        if (needed[i]) images.push_back(uses_[i].image);
    std::sort(images.begin(), images.end());
    images.erase(std::unique(images.begin(), images.end()), images.end());

    std::vector<ByteView> bytes(images.size());
    run_all(images.size(), [&](std::size_t i) { bytes[i] = document_.image(images[i]); });
    const std::vector<std::size_t> first = first_of_same_bytes(bytes);
    std::vector<DecodedImage> decoded(images.size());
    run_all(images.size(), [&](std::size_t i) {
        if (first[i] != i) return;
        const std::string pointer = fmt::format("/images/{} ({})", images[i], document_.image_name(images[i]));
        if (options.decode_textures) {
            decoded[i] = decode_image(document_, pointer, bytes[i]);
        } else {
            const ImageHeader header = read_image_header(document_, pointer, bytes[i]);
            decoded[i].width = header.width;
            decoded[i].height = header.height;
            decoded[i].bits = header.bits;
        }
    });

    const auto source_of = [&](const Use& use) {
        return first[static_cast<std::size_t>(std::lower_bound(images.begin(), images.end(), use.image) - images.begin())];
    };
    std::vector<int> remaining(images.size(), 0);
    for (std::size_t i = 0; i < uses_.size(); ++i)
        if (needed[i]) ++remaining[source_of(uses_[i])];
    for (std::size_t i = 0; i < uses_.size(); ++i) {
        if (!needed[i]) continue;
        const std::size_t source = source_of(uses_[i]);
        DecodedImage& image = decoded[source];
        TextureData& texture = textures[i];
        texture.width = image.width;
        texture.height = image.height;
        texture.format = format_of(image.bits, uses_[i].srgb);
        if (--remaining[source] == 0) texture.texels = std::move(image.texels);
        else texture.texels = image.texels;
    }
    if (options.texture_limit_px > 0)
        run_all(uses_.size(), [&](std::size_t i) {
            if (needed[i]) limit_size(textures[i], options.texture_limit_px);
        });
}

}  // namespace kadr
