#include "device/tables/least_green.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "kernels/bsdf/ggx.h"
#include "kernels/texture/texture.h"

namespace kadr {
namespace {

/// The texel with the least green, of four channels of T: every decoding keeps their order.
template <class T>
int place_of_least(const TextureData& texture) {
    const auto green = [&](int i) {
        T value;
        std::memcpy(&value, texture.texels.data() + (static_cast<std::size_t>(i) * 4 + 1) * sizeof(T), sizeof value);
        return value;
    };
    int least = 0;
    for (int i = 1; i < texture.width * texture.height; ++i)
        if (green(i) < green(least)) least = i;
    return least;
}

int place_of_least(const TextureData& texture) {
    using kernels::TexelFormat;
    switch (texture.format) {
        case TexelFormat::rgba32f: return place_of_least<float>(texture);
        case TexelFormat::rgba16_srgb:
        case TexelFormat::rgba16_linear: return place_of_least<std::uint16_t>(texture);
        default: return place_of_least<std::uint8_t>(texture);
    }
}

}  // namespace

float least_green(const TextureData& texture) {
    if (texture.texels.empty()) return 1;  // nothing that is shown wears it, so it was not read
    const int place = place_of_least(texture);
    return kernels::fetch_texel(texture.view(), place % texture.width, place / texture.width).y;
}

bool is_mirror(const kernels::Material& material, const std::function<float(int)>& least) {
    if (material.unlit) return false;
    constexpr float kRounding = 1 - 1e-5f;  // of a lookup between texels
    const int texture = material.metallic_roughness_texture.texture;
    const float roughness = kRounding * material.roughness * (texture < 0 ? 1 : least(texture));
    return roughness * roughness < kernels::kMinAlpha;
}

}  // namespace kadr
