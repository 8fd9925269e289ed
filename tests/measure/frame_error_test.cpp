// Noise and bias of images whose noise and bias are known.
#include "measure/frame_error.h"

#include <gtest/gtest.h>

#include <random>

#include "base/error.h"

namespace kadr {
namespace {

constexpr int kSide = 96;
constexpr double kPixels = 3.0 * kSide * kSide;

/// An image of a constant plus Gaussian noise.
StoredImage noisy(double value, double deviation, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(value, deviation);
    Image image{kSide, kSide, {"R", "G", "B"}, {}};
    for (int i = 0; i < 3 * kSide * kSide; ++i) image.pixels.push_back(static_cast<float>(deviation > 0 ? noise(random) : value));
    return {image, true};
}

TEST(FrameError, TellsNoiseFromBias) {
    const double level = 0.5, weight = 1 / (level * level + 0.01), bias = 0.03, sigma = 0.1, reference_sigma = 0.02;
    const Replicates reference{noisy(level, reference_sigma, 1), noisy(level, reference_sigma, 2)};
    const Replicates test{noisy(level + bias, sigma, 3), noisy(level + bias, sigma, 4)};
    const FrameError error = error_of(reference, test, {});
    // Four standard errors of a mean over all values: of squares of a Gaussian sqrt(2/n) of their mean; of the products
    // sigma² / sqrt(n) and what the bias adds, 2 bias sigma / sqrt(n). The weights vary with the reference by less than a percent.
    const double slack = 0.01;
    EXPECT_NEAR(error.noise, weight * sigma * sigma, weight * sigma * sigma * (4 * std::sqrt(2 / kPixels) + slack));
    EXPECT_NEAR(error.bias, weight * bias * bias, weight * (4 * (sigma * sigma + 2 * bias * sigma) / std::sqrt(kPixels) + slack * bias * bias));
    EXPECT_NEAR(error.relmse, error.noise + error.bias, weight * 4 * (sigma * sigma + 2 * bias * sigma) / std::sqrt(kPixels));
    EXPECT_NEAR(noise_of_mean(reference), weight * reference_sigma * reference_sigma / 2, 0.05 * weight * reference_sigma * reference_sigma);
}

TEST(FrameError, IsNothingForTheTruth) {
    const Replicates truth{noisy(0.4, 0, 1), noisy(0.4, 0, 1)};
    const FrameError error = error_of(truth, truth, {});
    EXPECT_EQ(error.relmse, 0);
    EXPECT_EQ(error.noise, 0);
    EXPECT_EQ(error.bias, 0);
    EXPECT_EQ(error.flip, 0);
    EXPECT_NEAR(error.ssim, 1, 1e-9);
}

TEST(FrameError, ReferenceNoiseIsNoBias) {
    const Replicates reference{noisy(0.5, 0.02, 5), noisy(0.5, 0.02, 6)};
    const FrameError error = error_of(reference, {noisy(0.5, 0, 7), noisy(0.5, 0, 7)}, {});
    EXPECT_EQ(error.noise, 0);
    // Each half is off by 0.0004 / 0.26; four standard errors of their products are a fortieth of that. (With a reference
    // whose noise is not small, the weights go with it.)
    EXPECT_LT(std::abs(error.bias), 4 * 0.0004 / 0.26 / std::sqrt(kPixels));
}

TEST(Flicker, CountsWhatTheTruthDoesNotDo) {
    ViewSpec plain;
    plain.transform = ViewTransform::none;
    const StoredImage dark = noisy(0.2, 0, 1), bright = noisy(0.5, 0, 1);
    EXPECT_NEAR(flicker(dark, bright, dark, bright, plain), 0, 1e-7);
    EXPECT_NEAR(flicker(dark, dark, dark, bright, plain), 0.3, 1e-6);
    EXPECT_NEAR(flicker(dark, bright, dark, dark, plain), 0.3, 1e-6);
    EXPECT_NEAR(flicker(dark, dark, bright, bright, plain), 0, 1e-7);  // wrong, but steadily so
}

TEST(FrameError, RefusesOtherSizes) {
    StoredImage small = noisy(0.5, 0, 1);
    small.image.width = kSide / 2, small.image.height = 2 * kSide;
    EXPECT_THROW(error_of({noisy(0.5, 0, 1), noisy(0.5, 0, 1)}, {small, small}, {}), InputError);
}

}  // namespace
}  // namespace kadr
