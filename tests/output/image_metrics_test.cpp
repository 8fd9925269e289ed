#include "output/image_metrics.h"

#include <cmath>

#include <gtest/gtest.h>

#include "output/image_io.h"
#include "output_fixtures.h"

namespace kadr {
namespace {

using test::gradient;
using test::plain_image;

Image grey(int width, int height, float value) {
    return plain_image(width, height, {"R", "G", "B"}, {value, value, value});
}

TEST(RelativeMse, IsTheSquareOverTheSquareOfTheReference) {
    const Image reference = plain_image(3, 2, {"R", "G", "B"}, {1, 0, 10}),
                test = plain_image(3, 2, {"R", "G", "B"}, {1.5f, 0.1f, 11});
    // Single-precision inputs: 0.1f is off by 1.5e-9 in 0.1.
    EXPECT_NEAR(relative_mse(reference, test), (0.25 / 1.01 + 0.01 / 0.01 + 1 / 100.01) / 3, 1e-6);
    EXPECT_NEAR(relative_mse(test, reference), (0.25 / 2.26 + 0.01 / 0.02 + 1 / 121.01) / 3, 1e-6);
}

TEST(RelativeMse, FindsColoursByTheirNames) {
    const Image rgb = plain_image(2, 2, {"R", "G", "B"}, {0.1f, 0.2f, 0.3f});
    const Image abgr = plain_image(2, 2, {"A", "B", "G", "R"}, {1, 0.3f, 0.2f, 0.1f});
    EXPECT_EQ(relative_mse(rgb, abgr), 0);
    EXPECT_EQ(structural_similarity(rgb, abgr), 1);
}

TEST(StructuralSimilarity, OfEqualImagesIsOne) {
    EXPECT_DOUBLE_EQ(structural_similarity(gradient(40, 30), gradient(40, 30)), 1);
}

TEST(StructuralSimilarity, OfFlatImagesIsThatOfTheirMeans) {
    const double a = 0.25f, b = 0.75f, c1 = 1e-4;
    // Variances of flat images are differences of equal numbers: rounding alone against (K2 L)² = 9e-4.
    EXPECT_NEAR(structural_similarity(grey(16, 12, 0.25f), grey(16, 12, 0.75f)),
                (2 * a * b + c1) / (a * a + b * b + c1), 1e-9);
}

/// A sine of one period a window length: the structure is all there is.
Image waves(double amplitude) {
    Image image{44, 22, {"R", "G", "B"}, {}};
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(0.5 + amplitude * std::sin(x * 1.7)));
    return image;
}

TEST(StructuralSimilarity, OfInvertedStructureIsNegative) {
    EXPECT_LT(structural_similarity(waves(0.4), waves(-0.4)), -0.9);
    EXPECT_GT(structural_similarity(waves(0.4), waves(0.35)), 0.95);
}

// The definition without a separable filter, for one window that fills the image.
TEST(StructuralSimilarity, IsTheDefinitionOverOneWindow) {
    constexpr int kSize = 11;
    const Image a = gradient(kSize, kSize), b = gradient(kSize, kSize, 5);
    const auto luma = [](const Image& image, int x, int y) {
        return 0.2126 * image.at(x, y, 0) + 0.7152 * image.at(x, y, 1) + 0.0722 * image.at(x, y, 2);
    };
    double weights = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const double w = std::exp(-((x - 5) * (x - 5) + (y - 5) * (y - 5)) / 4.5), p = luma(a, x, y),
                         q = luma(b, x, y);
            weights += w, ma += w * p, mb += w * q, aa += w * p * p, bb += w * q * q, ab += w * p * q;
        }
    ma /= weights, mb /= weights;
    const double va = aa / weights - ma * ma, vb = bb / weights - mb * mb, cov = ab / weights - ma * mb;
    const double expected = (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
    EXPECT_NEAR(structural_similarity(a, b), expected, 1e-12);  // double sums of 121 terms
}

TEST(StructuralSimilarity, TakesImagesSmallerThanItsWindow) {
    EXPECT_DOUBLE_EQ(structural_similarity(grey(1, 1, 0.5f), grey(1, 1, 0.5f)), 1);
    EXPECT_LT(structural_similarity(grey(3, 1, 0.2f), grey(3, 1, 0.9f)), 0.5);
}

TEST(ValueDifference, IsThatOfTheClosedForm) {
    Image a = grey(10, 10, 0.5f), b = a;
    b.pixels[3 * (7 * 10 + 4) + 1] = 0.9f;  // 4, 7, G
    const ValueDifference found = image_io().compare(a, b);
    const double squares = 0.4 * 0.4 / 300;
    EXPECT_NEAR(found.mean, 0.4 / 300, 1e-7);
    EXPECT_NEAR(found.rms, std::sqrt(squares), 1e-7);
    EXPECT_NEAR(found.psnr_db, -10 * std::log10(squares), 1e-4);
    EXPECT_NEAR(found.largest, 0.4, 1e-7);
    EXPECT_EQ((std::vector{found.x, found.y, found.channel}), (std::vector{4, 7, 1}));
}

TEST(ValueDifference, OfEqualImagesIsNothing) {
    const ValueDifference found = image_io().compare(gradient(8, 8), gradient(8, 8));
    EXPECT_EQ(found.rms, 0);
    EXPECT_TRUE(std::isinf(found.psnr_db) && found.psnr_db > 0);
}

TEST(HeatMap, GetsBrighterWithTheValue) {
    Image ramp{256, 1, {"Y"}, {}};
    for (int x = 0; x < 256; ++x) ramp.pixels.push_back(static_cast<float>(x) / 255);
    const Image colors = image_io().heat_map(ramp);
    ASSERT_EQ(colors.pixels.size(), 3u * 256);
    const auto luma = [&](int x) {
        return 0.2126f * colors.at(x, 0, 0) + 0.7152f * colors.at(x, 0, 1) + 0.0722f * colors.at(x, 0, 2);
    };
    EXPECT_LT(luma(0), 0.01f);
    EXPECT_GT(luma(255), 0.9f);
    for (int x = 16; x < 256; x += 16) EXPECT_GT(luma(x), luma(x - 16)) << x;
}

}  // namespace
}  // namespace kadr
