#include "film/error_estimate.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace kadr {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// One pixel's halves: means of equal R, G and B, and samples.
void put(Film& film, int x, int y, float a, std::uint32_t n, float b, std::uint32_t m) {
    const float means[] = {a, b};
    const std::uint32_t counts[] = {n, m};
    for (int half = 0; half < Film::kHalves; ++half) {
        const float sum = means[half] * static_cast<float>(counts[half]);
        film.beauty(x, y, half) = {sum, sum, sum, static_cast<float>(counts[half])};
        film.samples(x, y, half) = counts[half];
    }
}

TEST(ErrorEstimate, IsThatOfItsDefinition) {
    Film film(1, 1, {});
    put(film, 0, 0, 1, 4, 2, 12);
    // Mean 1.75, noise (1 - 2)² 4·12/16² = 0.1875.
    EXPECT_NEAR(estimate_error(film).relmse, 0.1875 / (1.75 * 1.75 - 0.09375 + 0.01), 1e-12);
    const double s = 10;
    EXPECT_NEAR(estimate_error(film, s).relmse, 18.75 / (306.25 - 9.375 + 0.01), 1e-12);
}

TEST(ErrorEstimate, OfEqualHalvesIsNothing) {
    Film film(2, 1, {});
    put(film, 0, 0, 3, 8, 3, 8), put(film, 1, 0, 0, 8, 0, 8);
    const ErrorEstimate estimate = estimate_error(film);
    EXPECT_TRUE(estimate.known);
    EXPECT_EQ(estimate.relmse, 0);
}

TEST(ErrorEstimate, OfOneHalfIsUnknown) {
    Film film(2, 1, {});
    put(film, 0, 0, 1, 1, 0, 0);
    EXPECT_FALSE(estimate_error(film).known);
    EXPECT_EQ(estimate_error(film).unknown_pixels, 2u);
}

TEST(ErrorEstimate, WhatOverflowsIsUnknownAndNotSmall) {
    Film film(2, 1, {});
    put(film, 0, 0, 1, 4, 1, 4), put(film, 1, 0, kInfinity, 4, 1, 4);
    EXPECT_EQ(estimate_error(film).unknown_pixels, 1u);
    EXPECT_TRUE(std::isinf(standard_errors(film)[1]));
}

/// A film of independent pixels of value 0.5: exponential radiance, as of a light that few paths find.
Film noisy_film(unsigned seed, int samples) {
    Film film(64, 64, {});
    std::mt19937 random(seed);
    std::exponential_distribution<float> radiance(2.0f);
    for (int half = 0; half < Film::kHalves; ++half)
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                Film::Beauty& sum = film.beauty(x, y, half);
                for (int i = 0; i < samples; ++i) {
                    const float value = radiance(random);
                    sum.r += value, sum.g += value, sum.b += value;
                }
                film.samples(x, y, half) = static_cast<std::uint32_t>(samples);
            }
    return film;
}

double true_relmse(const Film& film) {
    constexpr double kTruth = 0.5;
    double sum = 0;
    const Image image = film.develop();
    for (std::size_t i = 0; i < image.pixels.size(); i += 4)
        sum += (image.pixels[i] - kTruth) * (image.pixels[i] - kTruth) / (kTruth * kTruth + 0.01);
    return sum / (64.0 * 64);
}

// 4096 pixels: the relative spread of a mean of squares of near-normal errors is sqrt(2 / 4096) = 2.2 % a frame. The
// value in the denominator is noisy: at 2 x 16 samples its square is off by 1/32 of itself twice over, a bias of a few
// per cent.
TEST(ErrorEstimate, IsCalibratedOnKnownNoise) {
    for (const int samples : {16, 64}) {
        double estimated = 0, truth = 0;
        for (unsigned seed = 0; seed < 16; ++seed) {
            const Film film = noisy_film(seed, samples);
            estimated += estimate_error(film).relmse, truth += true_relmse(film);
        }
        EXPECT_NEAR(estimated / truth, 1, 0.06) << samples;
    }
}

TEST(ErrorEstimate, NineteenOfTwentyIntervalsHoldTheTruthOfTheFrame) {
    int inside = 0;
    constexpr int kFrames = 200;
    for (unsigned seed = 0; seed < kFrames; ++seed) {
        const Film film = noisy_film(1000 + seed, 64);
        const ErrorEstimate e = estimate_error(film);
        inside += e.relmse_low <= true_relmse(film) && true_relmse(film) <= e.relmse_high;
    }
    // Binomial, 200 of 0.95: deviation 3.1; four of them below, and one more per cent for the denominator. Not all: an
    // interval that is too wide says nothing.
    EXPECT_GE(inside, 176);
    EXPECT_LT(inside, kFrames);
}

/// A dark film with a few pixels that one half found a bright sample in: rare events, whose own value says little.
TEST(ErrorEstimate, HighEndTakesTheNeighboursForTheTruth) {
    Film film(21, 21, {});
    for (int y = 0; y < 21; ++y)
        for (int x = 0; x < 21; ++x) put(film, x, y, 0.5f, 32, 0.5f, 32);
    put(film, 10, 10, 8.5f, 32, 0.5f, 32);
    const ErrorEstimate e = estimate_error(film);
    // (8.5 - 0.5)² / 4 = 16 over 4.5² - 8 and over 0.5², with the floor, in one of 441 pixels.
    EXPECT_NEAR(e.relmse, 16 / (20.25 - 8 + 0.01) / 441, 1e-6);
    EXPECT_GT(e.relmse_high, 16 / 0.26 / 441);
    EXPECT_LE(e.relmse_low, e.relmse);
}

/// What one half says at the least is there: the darker half bounds what the neighbours may say.
TEST(ErrorEstimate, HighEndTakesNoLessThanTheDarkerHalf) {
    Film film(21, 21, {});
    for (int y = 0; y < 21; ++y)
        for (int x = 0; x < 21; ++x) put(film, x, y, 0.01f, 32, 0.01f, 32);
    put(film, 10, 10, 1.0f, 32, 0.1f, 32);
    const double error = 0.2025 / (0.1 * 0.1 + 0.01), mean = error / 441;  // 0.9² / 4; neighbours alone: over 0.01² + 0.01
    const double spread = std::sqrt(error * error / 441 - mean * mean) / 21;
    EXPECT_NEAR(estimate_error(film).relmse_high, mean + 1.96 * std::sqrt(2.0) * spread, 1e-5 * mean);
}

/// What is bright in both halves is bright, whatever lies around.
TEST(ErrorEstimate, HighEndDoesNotTakeEdgesForNoise) {
    Film film(21, 21, {});
    for (int y = 0; y < 21; ++y)
        for (int x = 0; x < 21; ++x) put(film, x, y, x == 10 ? 4.0f : 0.01f, 32, x == 10 ? 6.0f : 0.01f, 32);
    // 1 over 4² at the least; the 21 pixels of the line among 441, and what their spread adds.
    EXPECT_LT(estimate_error(film).relmse_high, 2 * (1.0 / 16) / 21);
}

TEST(StandardErrors, AreThoseOfTheLuminanceOverTheWindow) {
    Film film(9, 9, {});
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 9; ++x) put(film, x, y, 1, 2, 1, 2);
    put(film, 4, 4, 1, 2, 3, 2);  // noise 1
    const std::vector<float> errors = standard_errors(film);
    EXPECT_NEAR(errors[4 * 9 + 4], std::sqrt(1.0 / 49), 1e-6);
    EXPECT_NEAR(errors[4 * 9 + 1], std::sqrt(1.0 / 35), 1e-6);  // five columns of seven rows
    EXPECT_EQ(errors[4 * 9 + 0], 0);
    EXPECT_EQ(errors[0], 0);
}

TEST(WindowSums, ClipAtTheBorders) {
    const WindowSums sums = window_sums(std::vector<double>(12, 1.0), 4, 3, 1);
    EXPECT_EQ(sums.counts, (std::vector<int>{4, 6, 6, 4, 6, 9, 9, 6, 4, 6, 6, 4}));
    for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(sums.sums[i], sums.counts[i]);
}

}  // namespace
}  // namespace kadr
