#include "scene/texture_limit.h"

#include <cstring>
#include <numeric>

#include <gtest/gtest.h>

namespace kadr {
namespace {

using kernels::TexelFormat;

/// One row of 8-bit greys of full alpha.
TextureData row_of(std::vector<int> greys, TexelFormat format) {
    TextureData texture;
    texture.width = static_cast<int>(greys.size()), texture.height = 1;
    texture.format = format;
    for (const int grey : greys)
        for (const int channel : {grey, grey, grey, 255}) texture.texels.push_back(static_cast<std::uint8_t>(channel));
    return texture;
}

std::vector<int> greys_of(const TextureData& texture) {
    std::vector<int> greys;
    for (std::size_t i = 0; i < texture.texels.size(); i += 4) greys.push_back(texture.texels[i]);
    return greys;
}

TEST(TextureLimit, LeavesWhatFits) {
    TextureData texture = row_of({1, 2, 3}, TexelFormat::rgba8_linear);
    limit_size(texture, 3);
    EXPECT_EQ(greys_of(texture), (std::vector{1, 2, 3}));
}

TEST(TextureLimit, AveragesLinearValuesAsTheyAre) {
    TextureData texture = row_of({0, 100, 200, 40}, TexelFormat::rgba8_linear);
    limit_size(texture, 2);
    EXPECT_EQ(texture.width, 2);
    EXPECT_EQ(texture.height, 1);
    EXPECT_EQ(greys_of(texture), (std::vector{50, 120}));
}

// Half of the light of white is 188 of 255 in the sRGB transfer (1.055 · 0.5^(1/2.4) − 0.055 = 0.7354), not 128.
TEST(TextureLimit, AveragesColoursInLinearLightAndAlphaAsItIs) {
    TextureData texture = row_of({0, 255}, TexelFormat::rgba8_srgb);
    texture.texels[3] = 0;
    limit_size(texture, 1);
    EXPECT_EQ(texture.texels, (std::vector<std::uint8_t>{188, 188, 188, 128}));
}

// Three texels to two: each new one covers one and a half, (0 + 90 / 2) / 1.5 and (90 / 2 + 240) / 1.5.
TEST(TextureLimit, WeighsTexelsByTheAreaThatIsCovered) {
    TextureData texture = row_of({0, 90, 240}, TexelFormat::rgba8_linear);
    limit_size(texture, 2);
    EXPECT_EQ(greys_of(texture), (std::vector{30, 190}));
}

TEST(TextureLimit, KeepsTheShapeAndAtLeastOneTexel) {
    TextureData texture = row_of(std::vector<int>(1000, 77), TexelFormat::rgba8_linear);
    limit_size(texture, 8);
    EXPECT_EQ(texture.width, 8);
    EXPECT_EQ(texture.height, 1);
    EXPECT_EQ(greys_of(texture), std::vector<int>(8, 77));
}

TEST(TextureLimit, AveragesColumnsAndRowsOfSixteenBits) {
    TextureData texture;
    texture.width = 2, texture.height = 4;
    texture.format = TexelFormat::rgba16_linear;
    std::vector<std::uint16_t> values;
    for (std::uint16_t texel = 0; texel < 8; ++texel)
        for (std::uint16_t channel = 0; channel < 4; ++channel) values.push_back(static_cast<std::uint16_t>(1000 * texel + channel));
    texture.texels.resize(values.size() * sizeof values[0]);
    std::memcpy(texture.texels.data(), values.data(), texture.texels.size());
    limit_size(texture, 2);
    ASSERT_EQ(texture.texels.size(), 2u * 4 * 2);  // 1 x 2
    std::uint16_t means[8];
    std::memcpy(means, texture.texels.data(), sizeof means);
    EXPECT_EQ(std::vector<int>(means, means + 8), (std::vector{1500, 1501, 1502, 1503, 5500, 5501, 5502, 5503}));
}

TEST(TextureLimit, ChangesSizesAloneWhereHeadersAloneWereRead) {
    TextureData texture;
    texture.width = 4096, texture.height = 1024;
    limit_size(texture, 512);
    EXPECT_EQ(texture.width, 512);
    EXPECT_EQ(texture.height, 128);
    EXPECT_TRUE(texture.texels.empty());
}

}  // namespace
}  // namespace kadr
