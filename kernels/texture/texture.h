// Texture fetches, lane by lane: addresses and formats differ too much to share instructions.
#pragma once

#include "kernels/math/wide.h"
#include "kernels/scene/scene_types.h"
#include "kernels/texture/srgb_table.h"

namespace kadr::kernels {

/// x^(1/5) for x in (0, 1.1]: a guess from the exponent, then Newton. Basic operations only, the same everywhere.
SHARED_FN float fifth_root(float x) {
    float y = as_float(as_uint(x) / 5u + 0x32cccccdu);  // 4/5 of the exponent's bias
    for (int i = 0; i < 4; ++i) {
        const float y4 = (y * y) * (y * y);
        y = 0.8f * y + 0.2f * x / y4;
    }
    return y;
}

/// The sRGB transfer (IEC 61966-2-1) of a value in [0, 1]: ((x + 0.055) / 1.055)^2.4.
SHARED_FN float srgb_to_linear(float x) {
    if (x <= 0.04045f) return x * (1.0f / 12.92f);
    const float a = (x + 0.055f) * (1.0f / 1.055f);
    const float a2 = a * a;
    return a2 * fifth_root(a2);
}

/// One texel, linear.
SHARED_FN Vec4f fetch_texel(const Texture& t, int x, int y) {
    const long at = 4 * (static_cast<long>(y) * t.width + x);
    if (t.format == TexelFormat::rgba32f) {
        const float* p = static_cast<const float*>(t.texels) + at;
        return {p[0], p[1], p[2], p[3]};
    }
    if (t.format == TexelFormat::rgba8_srgb || t.format == TexelFormat::rgba8_linear) {
        constexpr float kScale = 1.0f / 255.0f;
        const unsigned char* p = static_cast<const unsigned char*>(t.texels) + at;
        if (t.format == TexelFormat::rgba8_srgb) {
            return {kSrgbToLinear[p[0]], kSrgbToLinear[p[1]], kSrgbToLinear[p[2]], static_cast<float>(p[3]) * kScale};
        }
        return {static_cast<float>(p[0]) * kScale, static_cast<float>(p[1]) * kScale, static_cast<float>(p[2]) * kScale,
                static_cast<float>(p[3]) * kScale};
    }
    constexpr float kScale = 1.0f / 65535.0f;
    const unsigned short* p = static_cast<const unsigned short*>(t.texels) + at;
    const Vec4f v{static_cast<float>(p[0]) * kScale, static_cast<float>(p[1]) * kScale,
                  static_cast<float>(p[2]) * kScale, static_cast<float>(p[3]) * kScale};
    if (t.format == TexelFormat::rgba16_linear) return v;
    return {srgb_to_linear(v.x), srgb_to_linear(v.y), srgb_to_linear(v.z), v.w};
}

/// A coordinate brought into [0, 1]; 0 for what is not finite.
template <class T>
SHARED_FN T wrap_coordinate(Wrap wrap, T u) {
    if (!(abs(u) < 1e9f)) return 0.0f;
    if (wrap == Wrap::clamp_to_edge) return saturate(u);
    if (wrap == Wrap::repeat) return u - floor(u);
    const T m = u - 2.0f * floor(u * 0.5f);
    return m > 1.0f ? 2.0f - m : m;
}

/// A texel's index, at most one step outside, brought inside. Mirrored and clamped edges repeat the edge texel.
SHARED_FN int wrap_index(Wrap wrap, int i, int size) {
    if (i < 0) return wrap == Wrap::repeat ? size - 1 : 0;
    if (i >= size) return wrap == Wrap::repeat ? 0 : size - 1;
    return i;
}

template <class T>
SHARED_FN T bilinear(float a, float b, float c, float d, T fx, T fy) {
    return lerp<T>(lerp<T>(a, b, fx), lerp<T>(c, d, fx), fy);
}

/// Interpolated in linear light: texels are decoded first.
template <class T>
SHARED_FN Vec4<T> sample_bilinear(const Texture& t, T u, T v) {
    const T x = u * static_cast<T>(t.width) - 0.5f;
    const T y = v * static_cast<T>(t.height) - 0.5f;
    const T left = floor(x), top = floor(y);
    const T fx = x - left, fy = y - top;
    const int x0 = wrap_index(t.wrap_s, static_cast<int>(left), t.width);
    const int x1 = wrap_index(t.wrap_s, static_cast<int>(left) + 1, t.width);
    const int y0 = wrap_index(t.wrap_t, static_cast<int>(top), t.height);
    const int y1 = wrap_index(t.wrap_t, static_cast<int>(top) + 1, t.height);
    const Vec4f a = fetch_texel(t, x0, y0), b = fetch_texel(t, x1, y0);
    const Vec4f c = fetch_texel(t, x0, y1), d = fetch_texel(t, x1, y1);
    return {bilinear(a.x, b.x, c.x, d.x, fx, fy), bilinear(a.y, b.y, c.y, d.y, fx, fy),
            bilinear(a.z, b.z, c.z, d.z, fx, fy), bilinear(a.w, b.w, c.w, d.w, fx, fy)};
}

template <class T>
SHARED_FN Vec4f sample_nearest(const Texture& t, T u, T v) {
    const int x = static_cast<int>(u * static_cast<T>(t.width));
    const int y = static_cast<int>(v * static_cast<T>(t.height));
    return fetch_texel(t, x < t.width ? x : t.width - 1, y < t.height ? y : t.height - 1);
}

/// One texture at one place.
template <class T>
SHARED_FN Vec4<T> sample_texture_scalar(const Texture& t, T u, T v) {
    const T wrapped_u = wrap_coordinate(t.wrap_s, u);
    const T wrapped_v = wrap_coordinate(t.wrap_t, v);
    if (!t.nearest) return sample_bilinear(t, wrapped_u, wrapped_v);
    const Vec4f texel = sample_nearest(t, wrapped_u, wrapped_v);
    return {texel.x, texel.y, texel.z, texel.w};
}

/// Colour and alpha of each lane's texture.
///
/// @param texture  index into `textures`; -1: white, opaque
/// @param active   other lanes fetch nothing and get white, opaque
template <class F>
SHARED_FN Vec4<F> sample_texture(const Texture* textures, Int<F> texture, Vec2<F> uv, Mask<F> active) {
    Vec4<F> result{F(1.0f), F(1.0f), F(1.0f), F(1.0f)};
    for (int i = 0; i < kLanes<F>; ++i) {
        const int index = lane(texture, i);
        if (index < 0 || !lane(active, i)) continue;
        const Vec4<Real<F>> value = sample_texture_scalar(textures[index], lane(uv.x, i), lane(uv.y, i));
        set_lane(result.x, i, value.x);
        set_lane(result.y, i, value.y);
        set_lane(result.z, i, value.z);
        set_lane(result.w, i, value.w);
    }
    return result;
}

/// A material's coordinates on its texture (KHR_texture_transform), from the two sets of the mesh.
template <class F>
SHARED_FN Vec2<F> apply_transform(const TextureSlot& slot, Vec2<F> uv0, Vec2<F> uv1) {
    const Vec2<F> uv = slot.uv_set == 0 ? uv0 : uv1;
    return {F(slot.m00) * uv.x + F(slot.m01) * uv.y + F(slot.m02),
            F(slot.m10) * uv.x + F(slot.m11) * uv.y + F(slot.m12)};
}

}  // namespace kadr::kernels
