// Mixes of pictures against values computed by hand.
#include "output/blend.h"

#include <gtest/gtest.h>

#include "output_fixtures.h"

namespace kadr {
namespace {

using test::plain_image;

const std::vector<std::string> kRgb{"R", "G", "B"};

// float has 24 bits; the curve adds a few roundings of double, which are far below.
constexpr double kRounding = 1e-7;

TEST(Blend, OfDisplayValuesIsTheirMean) {
    const Image a = plain_image(3, 2, kRgb, {1, 0.5f, 0}), b = plain_image(3, 2, kRgb, {0, 0.25f, 1});
    const Image mix = blend({{&a, 0.75}, {&b, 0.25}}, {}, ReelBlend::display);
    EXPECT_NEAR(mix.at(2, 1, 0), 0.75, kRounding);
    EXPECT_NEAR(mix.at(2, 1, 1), 0.4375, kRounding);
    EXPECT_NEAR(mix.at(2, 1, 2), 0.25, kRounding);
}

// sRGB of half the light of white: 1.055 * 0.5^(1/2.4) - 0.055 = 0.735357. Of 0.2 and 0.6, decoded 0.0331048 and 0.3185468,
// a quarter and three quarters: 0.2471863, encoded 0.534313.
TEST(Blend, OfLightIsBrighter) {
    const Image a = plain_image(1, 1, kRgb, {1, 0.2f, 0.3f}), b = plain_image(1, 1, kRgb, {0, 0.6f, 0.3f});
    EXPECT_NEAR(blend({{&a, 0.5}, {&b, 0.5}}, {}, ReelBlend::linear).at(0, 0, 0), 0.735357, 1e-6);
    const Image mix = blend({{&a, 0.25}, {&b, 0.75}}, {}, ReelBlend::linear);
    EXPECT_NEAR(mix.at(0, 0, 1), 0.534313, 1e-6);
    EXPECT_NEAR(mix.at(0, 0, 2), 0.3, 1e-6) << "what is equal stays";
}

TEST(Blend, FadesToAColour) {
    const Image a = plain_image(1, 1, kRgb, {0.5f, 0.5f, 0.5f});
    const Image mix = blend({{&a, 0.25}}, {{glm::dvec3(1, 0, 0.5), 0.75}}, ReelBlend::display);
    EXPECT_NEAR(mix.at(0, 0, 0), 0.875, kRounding);
    EXPECT_NEAR(mix.at(0, 0, 1), 0.125, kRounding);
    EXPECT_NEAR(mix.at(0, 0, 2), 0.5, kRounding);
}

TEST(Blend, OfOnePictureIsThePicture) {
    const Image image = test::gradient(7, 5);
    for (const ReelBlend space : {ReelBlend::display, ReelBlend::linear})
        EXPECT_EQ(blend({{&image, 1}}, {}, space).pixels, image.pixels);
}

TEST(Centred, PutsBarsAboveAndBelowOrBeside) {
    const Image small = plain_image(2, 2, {"R", "G", "B", "A"}, {0.5f, 0.25f, 0, 1});
    const Image wide = centred(small, 6, 2, glm::dvec3(0, 1, 0));
    EXPECT_EQ(wide.channels, kRgb);
    EXPECT_EQ(wide.at(1, 0, 1), 1);
    EXPECT_EQ(wide.at(2, 0, 0), 0.5f);
    EXPECT_EQ(wide.at(3, 1, 1), 0.25f);
    EXPECT_EQ(wide.at(4, 1, 0), 0);
    const Image high = centred(small, 2, 5, glm::dvec3(1));
    EXPECT_EQ(high.at(0, 0, 0), 1) << "one row above, two below";
    EXPECT_EQ(high.at(0, 1, 0), 0.5f);
    EXPECT_EQ(high.at(0, 3, 0), 1);
}

TEST(Centred, CutsWhatIsLarger) {
    const Image image = test::gradient(4, 4);
    const Image cut = centred(image, 2, 2, glm::dvec3(0));
    EXPECT_EQ(cut.at(0, 0, 1), image.at(1, 1, 1));
}

}  // namespace
}  // namespace kadr
