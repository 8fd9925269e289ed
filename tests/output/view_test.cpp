#include "output/view.h"

#include <chrono>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "output_fixtures.h"

namespace kadr {
namespace {

using test::plain_image;

// Single-precision series of degree 7 to 9 (2e-7) after a division and two matrices: a sixteenth of an 8-bit step is 2.4e-4.
constexpr double kTolerance = 5e-6;
constexpr ViewTransform kAll[] = {ViewTransform::none, ViewTransform::srgb, ViewTransform::agx, ViewTransform::aces,
                                  ViewTransform::pbr_neutral};

// The same cases in every run; RC_PARAMS in the environment wins.
const int kSeeded = ::setenv("RC_PARAMS", "seed=20240229", 0);

ViewSpec view_of(ViewTransform transform, double stops = 0) {
    ViewSpec view;
    view.transform = transform;
    view.exposure_stops = stops;
    return view;
}

std::vector<float> shown(ViewTransform transform, std::vector<float> rgb, double stops = 0) {
    return apply_view(plain_image(1, 1, {"R", "G", "B"}, rgb), view_of(transform, stops), false).pixels;
}

double srgb(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

TEST(View, SrgbIsTheExactPiecewiseTransfer) {
    for (int i = 0; i <= 4096; ++i) {
        const double x = i / 4096.0;
        ASSERT_NEAR(shown(ViewTransform::srgb, {static_cast<float>(x), 0, 0})[0], srgb(x), kTolerance) << x;
    }
    EXPECT_EQ(shown(ViewTransform::srgb, {0, 1, 2}), (std::vector<float>{0, 1, 1}));
}

TEST(View, NoneScalesByTheExposureAndClamps) {
    EXPECT_EQ(shown(ViewTransform::none, {0.25f, 0.5f, 3}, 1), (std::vector<float>{0.5f, 1, 1}));
    EXPECT_EQ(shown(ViewTransform::none, {0.25f, 0.5f, 1}, -2), (std::vector<float>{0.0625f, 0.125f, 0.25f}));
}

TEST(View, AgxPutsMidGreyInTheMiddle) {
    // The curve's pivot: 0.18 becomes 0.5, encoded for a display power of 2.2. The polynomial's error is 1.9e-3 (root mean
    // square), and twice that is allowed.
    const std::vector<float> grey = shown(ViewTransform::agx, {0.18f, 0.18f, 0.18f});
    EXPECT_NEAR(grey[0], srgb(std::pow(0.5, 2.2)), 3.8e-3);
}

TEST(View, AgxMapsItsEndsToBlackAndWhite) {
    EXPECT_NEAR(shown(ViewTransform::agx, {0, 0, 0})[1], 0, 1e-6);
    // 0.99858 is what the published polynomial gives at 1.
    EXPECT_NEAR(shown(ViewTransform::agx, {1e6f, 1e6f, 1e6f})[1], srgb(std::pow(0.99858, 2.2)), 1e-4);
}

TEST(View, AgxBleachesABrightPrimary) {
    // What makes it AgX: a very bright pure blue goes to white instead of staying blue.
    const std::vector<float> dim = shown(ViewTransform::agx, {0, 0, 0.2f}), bright = shown(ViewTransform::agx, {0, 0, 1000});
    EXPECT_GT(dim[2], 2 * dim[0]);
    EXPECT_GT(bright[0], 0.8f);
}

TEST(View, AcesIsHillsFit) {
    // In double, by hand: the input matrix' rows and the output matrix' rows, then the curve.
    const auto curve = [](double v) { return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081); };
    const double in[3] = {0.59719 * 0.8 + 0.35458 * 0.3 + 0.04823 * 0.1, 0.07600 * 0.8 + 0.90834 * 0.3 + 0.01566 * 0.1,
                          0.02840 * 0.8 + 0.13383 * 0.3 + 0.83777 * 0.1};
    const double red = 1.60475 * curve(in[0]) - 0.53108 * curve(in[1]) - 0.07367 * curve(in[2]);
    EXPECT_NEAR(shown(ViewTransform::aces, {0.8f, 0.3f, 0.1f})[0], srgb(red), kTolerance);
}

TEST(View, PbrNeutralKeepsBaseColoursAndCompressesHighlights) {
    // Below the start of compression the specification only takes off the 4 % of a dielectric's reflection.
    EXPECT_NEAR(shown(ViewTransform::pbr_neutral, {0.5f, 0.3f, 0.2f})[0], srgb(0.46), kTolerance);
    EXPECT_NEAR(shown(ViewTransform::pbr_neutral, {0.5f, 0.3f, 0.04f})[1], srgb(0.3 - (0.04 - 6.25 * 0.04 * 0.04)), kTolerance);
    // Grey 2: peak 1.96, new peak 1 - 0.24^2 / (1.96 + 0.24 - 0.76) = 0.96.
    EXPECT_NEAR(shown(ViewTransform::pbr_neutral, {2, 2, 2})[1], srgb(0.96), kTolerance);
}

RC_GTEST_PROP(View, GreyStaysGrey, ()) {
    const float grey = std::exp2(static_cast<float>(*rc::gen::inRange(-1200, 700)) / 100.0f);
    for (const ViewTransform transform : kAll) {
        const std::vector<float> rgb = shown(transform, {grey, grey, grey});
        // Rows of the published matrices sum to 1 within 5e-5 (ACES is given with five digits): a hundredth of an 8-bit step.
        RC_ASSERT(std::abs(rgb[0] - rgb[1]) < 1e-4f);
        RC_ASSERT(std::abs(rgb[2] - rgb[1]) < 1e-4f);
    }
}

RC_GTEST_PROP(View, AnyInputGivesAValueInsideTheUnitInterval, ()) {
    const auto value = rc::gen::oneOf(rc::gen::arbitrary<float>(), rc::gen::element(std::numeric_limits<float>::infinity(),
                                                                                   std::numeric_limits<float>::quiet_NaN(), -1.0f, 1e38f));
    const std::vector<float> rgb{*value, *value, *value};
    for (const ViewTransform transform : kAll)
        for (const float shown_value : shown(transform, rgb, *rc::gen::inRange(-20, 20)))
            RC_ASSERT(shown_value >= 0.0f && shown_value <= 1.0f);
}

TEST(View, BrighterGreyIsNeverDarker) {
    for (const ViewTransform transform : kAll) {
        float before = 0;
        for (int i = -120; i <= 60; ++i) {
            const float grey = std::exp2(static_cast<float>(i) / 10.0f), value = shown(transform, {grey, grey, grey})[1];
            ASSERT_GE(value, before - 1e-6f) << static_cast<int>(transform) << " at " << grey;
            before = value;
        }
    }
}

TEST(View, EncodesUnpremultipliedColourAndPremultipliesAgain) {
    const Image half = plain_image(1, 1, {"R", "G", "B", "A"}, {0.25f, 0.125f, 0, 0.5f});
    const std::vector<float> kept = apply_view(half, view_of(ViewTransform::srgb), true).pixels;
    EXPECT_NEAR(kept[0], srgb(0.5) * 0.5, kTolerance);
    EXPECT_NEAR(kept[1], srgb(0.25) * 0.5, kTolerance);
    EXPECT_EQ(kept[3], 0.5f);
    const std::vector<float> linear = apply_view(half, view_of(ViewTransform::none), true).pixels;
    EXPECT_EQ(linear, half.pixels);
}

TEST(View, KeepsOnlyTheColourChannelsWhereverTheyStand) {
    const Image image = plain_image(3, 2, {"depth.Z", "A", "B", "G", "R", "normal.X"}, {9, 1, 0.1f, 0.2f, 0.3f, -1});
    const Image display = apply_view(image, view_of(ViewTransform::none), false);
    EXPECT_EQ(display.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(display.pixels.size(), 18u);
    EXPECT_EQ(display.at(2, 1, 0), 0.3f);
    EXPECT_EQ(display.at(2, 1, 2), 0.1f);
    EXPECT_EQ(apply_view(image, view_of(ViewTransform::none), true).channels.back(), "A");
}

TEST(View, EveryPixelOfAnImageThatIsNoMultipleOfTheBlock) {
    Image image = plain_image(257, 3, {"R", "G", "B"}, {0, 0, 0});
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i) / 1000;
    EXPECT_EQ(apply_view(image, view_of(ViewTransform::none, -2), false).at(256, 2, 2), image.pixels.back() / 4);
}

TEST(View, MetersTheLogAverageOfLitPixels) {
    Image image = plain_image(2, 2, {"R", "G", "B"}, {4, 4, 4});
    EXPECT_NEAR(metered_exposure(image), std::log2(0.18 / 4), 1e-6);
    for (std::size_t i = 0; i < 3; ++i) image.pixels[i] = 0;                                       // black carries no logarithm
    for (std::size_t i = 3; i < 6; ++i) image.pixels[i] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NEAR(metered_exposure(image), std::log2(0.18 / 4), 1e-6);
    for (std::size_t i = 6; i < 9; ++i) image.pixels[i] = 1;                                       // geometric mean of 1 and 4
    EXPECT_NEAR(metered_exposure(image), std::log2(0.18 / 2), 1e-6);
    EXPECT_EQ(metered_exposure(plain_image(2, 2, {"R", "G", "B"}, {0, 0, 0})), 0);
}

}  // namespace
}  // namespace kadr
