#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "kernels/texture/texture.h"

namespace kadr::kernels {
namespace {

double srgb(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }

Vec4f at(const Texture& t, float u, float v) {
    const Vec4<float> r = sample_texture<float>(&t, 0, Vec2f{u, v}, true);
    return {r.x, r.y, r.z, r.w};
}

TEST(Texture, DecodesSrgb) {
    for (int i = 0; i < 256; ++i) EXPECT_NEAR(kSrgbToLinear[i], srgb(i / 255.0), 1e-7);
    for (int i = 0; i <= 65535; i += 13) {
        const double x = i / 65535.0;
        EXPECT_NEAR(srgb_to_linear(static_cast<float>(x)), srgb(x), 5e-7);  // a few roundings
    }
}

TEST(Texture, InterpolatesInLinearLight) {
    const unsigned char black_white[8] = {0, 0, 0, 0, 255, 255, 255, 255};
    const Texture colour{black_white, 2, 1, TexelFormat::rgba8_srgb, Wrap::clamp_to_edge, Wrap::clamp_to_edge, false};
    EXPECT_NEAR(at(colour, 0.5f, 0.5f).x, 0.5f, 1e-6);
    EXPECT_NEAR(at(colour, 0.375f, 0.5f).y, 0.25f, 1e-6);
    EXPECT_NEAR(at(colour, 0.375f, 0.5f).w, 0.25f, 1e-6);
    const unsigned char greys[8] = {64, 64, 64, 64, 192, 192, 192, 192};
    const Texture grey{greys, 2, 1, TexelFormat::rgba8_srgb, Wrap::clamp_to_edge, Wrap::clamp_to_edge, false};
    EXPECT_NEAR(at(grey, 0.5f, 0.5f).x, 0.5 * (srgb(64 / 255.0) + srgb(192 / 255.0)), 1e-6);
    EXPECT_NEAR(at(grey, 0.5f, 0.5f).w, 128.0 / 255.0, 1e-6);  // alpha is linear
}

TEST(Texture, ReadsEveryFormat) {
    const unsigned char bytes[4] = {51, 102, 153, 204};
    const unsigned short words[4] = {13107, 26214, 39321, 52428};
    const float floats[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    const auto texture = [](const void* p, TexelFormat f) {
        return Texture{p, 1, 1, f, Wrap::repeat, Wrap::repeat, false};
    };
    for (const Texture& t : {texture(bytes, TexelFormat::rgba8_linear), texture(words, TexelFormat::rgba16_linear),
                             texture(floats, TexelFormat::rgba32f)}) {
        const Vec4f v = at(t, 0.3f, 0.9f);
        EXPECT_NEAR(v.x, 0.2, 1e-6);
        EXPECT_NEAR(v.y, 0.4, 1e-6);
        EXPECT_NEAR(v.z, 0.6, 1e-6);
        EXPECT_NEAR(v.w, 0.8, 1e-6);
    }
    for (const Texture& t : {texture(bytes, TexelFormat::rgba8_srgb), texture(words, TexelFormat::rgba16_srgb)}) {
        const Vec4f v = at(t, 0.3f, 0.9f);
        EXPECT_NEAR(v.x, srgb(0.2), 1e-6);
        EXPECT_NEAR(v.y, srgb(0.4), 1e-6);
        EXPECT_NEAR(v.z, srgb(0.6), 1e-6);
        EXPECT_NEAR(v.w, 0.8, 1e-6);
    }
}

/// A row of four texels 0, 1, 2, 3.
struct Row {
    std::vector<float> texels = {0, 0, 0, 1, 1, 0, 0, 1, 2, 0, 0, 1, 3, 0, 0, 1};
    Texture texture(Wrap wrap, bool nearest) const {
        return {texels.data(), 4, 1, TexelFormat::rgba32f, wrap, wrap, nearest};
    }
};

TEST(Texture, WrapsAsTold) {
    const Row row;
    const struct {
        Wrap wrap;
        float u, nearest, linear;
    } kCases[] = {
        {Wrap::repeat, 0.125f, 0, 0},          {Wrap::repeat, 1.375f, 1, 1},
        {Wrap::repeat, -0.125f, 3, 3},         {Wrap::repeat, 0.0f, 0, 1.5f},
        {Wrap::mirrored_repeat, 1.125f, 3, 3}, {Wrap::mirrored_repeat, -0.375f, 1, 1},
        {Wrap::mirrored_repeat, 2.625f, 2, 2}, {Wrap::mirrored_repeat, 0.0f, 0, 0},
        {Wrap::clamp_to_edge, -7.0f, 0, 0},    {Wrap::clamp_to_edge, 1.0f, 3, 3},
        {Wrap::clamp_to_edge, 5.0f, 3, 3},     {Wrap::clamp_to_edge, 0.5f, 2, 1.5f},
    };
    for (const auto& c : kCases) {
        EXPECT_EQ(at(row.texture(c.wrap, true), c.u, 0.5f).x, c.nearest) << static_cast<int>(c.wrap) << ' ' << c.u;
        EXPECT_EQ(at(row.texture(c.wrap, false), c.u, 0.5f).x, c.linear) << static_cast<int>(c.wrap) << ' ' << c.u;
    }
}

TEST(Texture, FirstRowIsTheTop) {
    const float texels[8] = {1, 0, 0, 1, 2, 0, 0, 1};
    const Texture t{texels, 1, 2, TexelFormat::rgba32f, Wrap::clamp_to_edge, Wrap::clamp_to_edge, true};
    EXPECT_EQ(at(t, 0.5f, 0.1f).x, 1.0f);
    EXPECT_EQ(at(t, 0.5f, 0.9f).x, 2.0f);
}

TEST(Texture, SurvivesAnyCoordinate) {
    const Row row;
    const float kOdd[] = {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(),
                          -1e38f,
                          1e9f,
                          16777217.0f,
                          -1e-9f,
                          0.99999994f,
                          1e-45f};
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge}) {
        for (const bool nearest : {false, true}) {
            for (const float u : kOdd) {
                const float x = at(row.texture(wrap, nearest), u, u).x;
                EXPECT_TRUE(x >= 0.0f && x <= 3.0f) << u;
            }
        }
    }
}

TEST(Texture, NoneAndIdleLanesAreWhite) {
    const Row row;
    const Texture t = row.texture(Wrap::repeat, true);
    EXPECT_EQ(sample_texture<float>(&t, -1, Vec2f{0, 0}, true).x, 1.0f);
    EXPECT_EQ(sample_texture<float>(&t, 0, Vec2f{0, 0}, false).x, 1.0f);
    EXPECT_EQ(sample_texture<float>(&t, 0, Vec2f{0, 0}, true).x, 0.0f);
}

TEST(Texture, TransformsTheChosenSet) {
    TextureSlot slot;
    EXPECT_EQ(apply_transform(slot, Vec2f{0.3f, 0.7f}, Vec2f{0.1f, 0.2f}).y, 0.7f);
    slot.uv_set = 1;
    slot.m00 = 0, slot.m01 = -2, slot.m02 = 0.5f, slot.m10 = 3, slot.m11 = 0, slot.m12 = 0.25f;
    const Vec2f uv = apply_transform(slot, Vec2f{0.3f, 0.7f}, Vec2f{0.1f, 0.2f});
    EXPECT_FLOAT_EQ(uv.x, 0.1f);
    EXPECT_FLOAT_EQ(uv.y, 0.55f);
}

}  // namespace
}  // namespace kadr::kernels
