// The statistics by which devices are compared: how often they cry wolf, and how small a difference they find.
#include "measure/z_test.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace kadr {
namespace {

constexpr int kWidth = 64, kHeight = 48, kSamples = 16, kReplicates = 8;

/// A picture whose pixels are means of so many exponential numbers (skewed, as light is): around 1, or `mean(x, y)`.
template <class Mean>
ReplicateSums drawn(std::mt19937& random, const Mean& mean, int replicates = kReplicates) {
    std::gamma_distribution<double> draw(kSamples, 1.0 / kSamples);
    ReplicateSums sums;
    for (int r = 0; r < replicates; ++r) {
        Image image{kWidth, kHeight, {"R", "G", "B", "A"}, {}};
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(mean(x, y) * draw(random)));
                image.pixels.push_back(1);
            }
        sums.add(image);
    }
    return sums;
}

constexpr auto kEven = [](int, int) { return 1.0; };

TEST(Moments, AreThoseOfTheirValues) {
    Moments m;
    for (const double x : {1.0, 2.0, 4.0}) m.add(x);
    EXPECT_DOUBLE_EQ(m.mean, 7.0 / 3);
    EXPECT_DOUBLE_EQ(m.variance(), 7.0 / 3);
    EXPECT_DOUBLE_EQ(m.variance_of_mean(), 7.0 / 9);
}

/// Against the tables of Student's distribution; Wallace's approximation is within 0.02 of the exact number.
TEST(NormalOfStudent, HasTheSameTail) {
    EXPECT_NEAR(normal_of_student(2.228, 10), 1.960, 0.02);    // 5 %
    EXPECT_NEAR(normal_of_student(4.587, 10), 3.291, 0.02);    // 0.1 %
    EXPECT_NEAR(normal_of_student(-2.977, 14), -2.576, 0.02);  // 1 %
    EXPECT_NEAR(normal_of_student(3, 1e6), 3, 1e-4);
    EXPECT_EQ(normal_of_student(0, 5), 0);
}

TEST(ZTest, TheSharesBeyondAreThoseOfNormalNumbersWhereNothingDiffers) {
    std::mt19937 random(1);
    double beyond[3] = {};
    int rejected = 0;
    constexpr int kTrials = 20;
    for (int i = 0; i < kTrials; ++i) {
        const ZTest test = compare_replicates(drawn(random, kEven), drawn(random, kEven), kSamples);
        for (std::size_t k = 0; k < 3; ++k) beyond[k] += test.scales[0].beyond[k] / kTrials;
        rejected += test.differs() ? 1 : 0;
    }
    // 184,320 numbers: four standard errors of the shares are 0.002, 0.0005 and 0.00008. Exponential tails, and a
    // quantum that is added to the variance, take up to a third of the far shares away.
    EXPECT_NEAR(beyond[0], kNormalBeyond[0], 0.008);
    EXPECT_NEAR(beyond[1], kNormalBeyond[1], 0.0012);
    EXPECT_LT(beyond[2], kNormalBeyond[2] + 8e-5);
    EXPECT_EQ(rejected, 0);  // at a chance of 2 % over the twenty
}

TEST(ZTest, OnePercentMoreLightIsFoundInThePicture) {
    std::mt19937 random(2);
    const ZTest test = compare_replicates(drawn(random, kEven), drawn(random, [](int, int) { return 1.01; }), kSamples);
    EXPECT_TRUE(test.differs());
    EXPECT_GT(test.scales[2].rejected, 0u);
    EXPECT_NEAR(test.difference, 0.01, 0.005);
    EXPECT_LT(test.difference_from, 0.01);
    EXPECT_GT(test.difference_to, 0.01);
    EXPECT_GT(test.difference_from, 0);
}

TEST(ZTest, AFewPixelsAreFoundAmongThePixels) {
    std::mt19937 random(3);
    const auto spotted = [](int x, int y) { return x == 40 && y == 30 ? 3.0 : 1.0; };
    const ZTest test = compare_replicates(drawn(random, kEven), drawn(random, spotted), kSamples);
    EXPECT_TRUE(test.differs());
    EXPECT_EQ(test.scales[0].x, 40);
    EXPECT_EQ(test.scales[0].y, 30);
    EXPECT_GE(test.scales[0].rejected, 1u);
    EXPECT_LE(test.scales[0].rejected, 3u);
    EXPECT_GT(test.z[30 * kWidth + 40], 5.5);  // what 9,216 tests at a third of kLevel ask for
    EXPECT_EQ(test.scales[2].rejected, 0u) << "the picture's mean hardly changes";
}

TEST(ZTest, AFaintRegionIsFoundAmongTheTiles) {
    std::mt19937 random(4);
    const auto faint = [](int x, int y) { return x / 16 == 2 && y / 16 == 1 ? 1.06 : 1.0; };
    const ZTest test = compare_replicates(drawn(random, kEven), drawn(random, faint), kSamples);
    EXPECT_GT(test.scales[1].rejected, 0u);
    EXPECT_EQ(test.scales[1].x, 2);
    EXPECT_EQ(test.scales[1].y, 1);
}

/// Replicates of an edge may all agree on a count of samples by chance, on either device on another.
TEST(ZTest, OneSampleOnTheOtherSideOfAnEdgeIsNoDifference) {
    const auto edge = [](int covered) {
        ReplicateSums sums;
        for (int r = 0; r < kReplicates; ++r) {
            Image image{9, 1, {"R", "G", "B"}, {}};
            for (int x = 0; x < 9; ++x)
                for (int c = 0; c < 3; ++c)
                    image.pixels.push_back(x < 4 ? 1 : x > 4 ? 0 : static_cast<float>(covered) / kSamples);
            sums.add(image);
        }
        return sums;
    };
    EXPECT_FALSE(compare_replicates(edge(7), edge(7), kSamples).differs());
    EXPECT_FALSE(compare_replicates(edge(7), edge(8), kSamples).scales[0].rejected > 0);
    EXPECT_TRUE(compare_replicates(edge(7), edge(11), kSamples).scales[0].rejected > 0);
}

TEST(ZTest, RoundingIsNoDifferenceWhereThereIsNoNoise) {
    const auto flat = [](float value) {
        ReplicateSums sums;
        for (int r = 0; r < kReplicates; ++r) sums.add({4, 4, {"R", "G", "B"}, std::vector<float>(48, value)});
        return sums;
    };
    EXPECT_FALSE(compare_replicates(flat(2), flat(2.0002f), kSamples).differs());
    EXPECT_TRUE(compare_replicates(flat(2), flat(2.02f), kSamples).differs());
    EXPECT_EQ(compare_replicates(flat(2), flat(2), kSamples).scales[0].tests, 0u);
    EXPECT_FALSE(compare_replicates(flat(0), flat(0), kSamples).differs());
    EXPECT_TRUE(compare_replicates(flat(1), flat(std::nanf("")), kSamples).differs());
}

}  // namespace
}  // namespace kadr
