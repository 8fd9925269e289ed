#include "render/sample_steering.h"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kadr {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

RenderSpec fixed(int samples) {
    RenderSpec render;
    render.samples = samples;
    return render;
}

RenderSpec below(double max_error, int at_least, int at_most) {
    RenderSpec render = fixed(at_most);
    render.max_error = max_error;
    render.at_least = at_least;
    return render;
}

ViewSpec linear_view() {
    ViewSpec view;
    view.transform = ViewTransform::none;
    return view;
}

/// A renderer of independent samples: radiance of a pixel is drawn from a distribution of its own.
class Painter {
public:
    Painter(int size, unsigned seed) : film_(size, size, {}), random_(seed) {}

    template <class Radiance>
    void paint(int count, const std::uint8_t* active, const Radiance& radiance) {
        for (int half = 0; half < Film::kHalves; ++half)
            for (int y = 0; y < film_.height(); ++y)
                for (int x = 0; x < film_.width(); ++x) {
                    if (active && active[y * film_.width() + x] == 0) continue;
                    const int n = half == 0 ? (count + 1) / 2 : count / 2;
                    Film::Beauty& sum = film_.beauty(x, y, half);
                    for (int i = 0; i < n; ++i) {
                        const float value = radiance(x, y, random_);
                        sum.r += value, sum.g += value, sum.b += value, sum.alpha += 1;
                    }
                    film_.samples(x, y, half) += static_cast<std::uint32_t>(n);
                }
    }
    Film& film() { return film_; }

private:
    Film film_;
    std::mt19937 random_;
};

float noise_on_the_right(int x, int, std::mt19937& random) {
    std::uniform_real_distribution<float> uniform(0, 1);
    const float value = uniform(random);
    return x < 16 ? 0.5f : value;
}

TEST(SampleSteering, AFixedNumberIsOneRound) {
    Painter painter(4, 1);
    SampleSteering steering(fixed(7), kInfinity, linear_view(), 1, [] { return 0.0; });
    EXPECT_EQ(steering.next_round(painter.film()), 7);
    EXPECT_EQ(steering.active(), nullptr);
    EXPECT_EQ(steering.next_round(painter.film()), 0);
    EXPECT_EQ(steering.stopped_by(), SamplingStop::samples);
}

TEST(SampleSteering, StopsWhereItIsCalmAndGoesOnWhereItIsNot) {
    Painter painter(32, 2);
    SampleSteering steering(below(0.01, 32, 4096), kInfinity, linear_view(), 1, [] { return 0.0; });
    while (const int count = steering.next_round(painter.film()))
        painter.paint(count, steering.active(), noise_on_the_right);
    EXPECT_EQ(steering.stopped_by(), SamplingStop::max_error);
    EXPECT_EQ(painter.film().samples_of_both(2, 16), 32u);
    // Uniform in [0, 1]: deviation 0.289, so 833 samples for 0.01; rounds are 768, 1024 and 1536 then.
    EXPECT_GE(painter.film().samples_of_both(28, 16), 512u);
    EXPECT_LE(painter.film().samples_of_both(28, 16), 1536u);
    const SamplingReport report = report_sampling(painter.film(), steering.stopped_by(), linear_view(), 1);
    EXPECT_EQ(report.least, 32u);
    EXPECT_LT(report.display_error, 0.01);
}

TEST(SampleSteering, HalvesStayEqual) {
    Painter painter(8, 3);
    SampleSteering steering(below(1e-4, 32, 400), kInfinity, linear_view(), 1, [] { return 0.0; });
    std::vector<int> counts;
    const auto noise = [](int, int, std::mt19937& r) { return std::uniform_real_distribution<float>(0, 1)(r); };
    while (const int count = steering.next_round(painter.film())) {
        counts.push_back(count);
        painter.paint(count, steering.active(), noise);
    }
    EXPECT_THAT(counts, testing::ElementsAre(32, 16, 16, 32, 32, 64, 64, 128, 16));  // 32, 48, 64, 96, ... 384, 400
    EXPECT_EQ(steering.stopped_by(), SamplingStop::at_most);
    EXPECT_EQ(painter.film().samples(0, 0, 0), painter.film().samples(0, 0, 1));
}

TEST(SampleSteering, OddLeastsAreRoundedUp) {
    Painter painter(2, 8);
    SampleSteering steering(below(1e-4, 5, 64), kInfinity, linear_view(), 1, [] { return 0.0; });
    EXPECT_EQ(steering.next_round(painter.film()), 6);
}

TEST(SampleSteering, NanNeverPassesForGood) {
    Painter painter(8, 4);
    SampleSteering steering(below(0.5, 4, 64), kInfinity, linear_view(), 1, [] { return 0.0; });
    const auto broken = [](int, int, std::mt19937&) { return std::numeric_limits<float>::quiet_NaN(); };
    while (const int count = steering.next_round(painter.film())) painter.paint(count, steering.active(), broken);
    EXPECT_EQ(steering.stopped_by(), SamplingStop::at_most);
    EXPECT_FALSE(report_sampling(painter.film(), steering.stopped_by(), linear_view(), 1).error.known);
}

// Rare bright samples over a dim picture: the case in which stopping by one's own samples darkens a picture most. The
// truth is 0.2 + 0.004 * 20; 256 seeds of 24 x 24 pixels leave a spread of the mean of 0.1 %.
TEST(SampleSteering, IsNotBiasedByItsStopping) {
    const auto fireflies = [](int, int, std::mt19937& random) {
        return 0.2f + (std::uniform_real_distribution<float>(0, 1)(random) < 0.004f ? 20.0f : 0.0f);
    };
    constexpr double kTruth = 0.2 + 0.004 * 20;
    double sum = 0, samples = 0;
    constexpr int kSeeds = 256, kSize = 24;
    for (unsigned seed = 0; seed < kSeeds; ++seed) {
        Painter painter(kSize, 100 + seed);
        SampleSteering steering(below(0.06, 32, 512), kInfinity, linear_view(), 1, [] { return 0.0; });
        while (const int count = steering.next_round(painter.film()))
            painter.paint(count, steering.active(), fireflies);
        const Image image = painter.film().develop();
        for (std::size_t i = 0; i < image.pixels.size(); i += 4) sum += image.pixels[i];
        samples += report_sampling(painter.film(), steering.stopped_by(), linear_view(), 1).mean;
    }
    const double pixels = static_cast<double>(kSeeds) * kSize * kSize;
    EXPECT_NEAR(sum / pixels / kTruth, 1, 0.005);
    // The rule was at work: neither did all stop at the first chance nor went all to the end.
    EXPECT_GT(samples / kSeeds, 40);
    EXPECT_LT(samples / kSeeds, 480);
}

TEST(SampleSteering, KeepsATimeBudget) {
    Painter painter(8, 5);
    double now = 0.3;  // setting up took a while
    RenderSpec render = fixed(100000);
    SampleSteering steering(render, 2.0, linear_view(), 1, [&] { return now; });
    double last_round = 0;
    while (const int count = steering.next_round(painter.film())) {
        painter.paint(count, steering.active(), noise_on_the_right);
        last_round =
            0.001 * count * (1 + 0.04 * std::sin(steering.samples_so_far()));  // a machine that is never quite as fast
        now += last_round;
    }
    EXPECT_EQ(steering.stopped_by(), SamplingStop::time_budget);
    EXPECT_LE(now, 2.0 * 1.05);
    EXPECT_GE(now, 2.0 * 0.95);
}

TEST(SampleSteering, ABudgetTooSmallForAnythingStillMakesAPicture) {
    Painter painter(8, 6);
    double now = 5;
    SampleSteering steering(fixed(1024), 2.0, linear_view(), 1, [&] { return now; });
    EXPECT_EQ(steering.next_round(painter.film()), 4);
    painter.paint(4, nullptr, noise_on_the_right);
    now = 6;
    EXPECT_EQ(steering.next_round(painter.film()), 0);
    EXPECT_EQ(steering.stopped_by(), SamplingStop::time_budget);
}

TEST(SampleSteering, StopsByErrorBeforeTheTimeIsOver) {
    Painter painter(32, 7);
    double now = 0;
    RenderSpec render = below(0.05, 32, 4096);
    SampleSteering steering(render, 1000.0, linear_view(), 1, [&] { return now; });
    while (const int count = steering.next_round(painter.film())) {
        painter.paint(count, steering.active(), noise_on_the_right);
        now += 0.001 * count;
    }
    EXPECT_EQ(steering.stopped_by(), SamplingStop::max_error);
}

// The noise on the right is 1/12 / n of a value near a half: a relative mean square error of about 0.12 / n in half the picture.
TEST(SampleSteering, EndsAFrameWhereItIsNearestToATarget) {
    for (const double target : {0.02, 0.005, 0.0007}) {
        Painter painter(64, 9);
        SampleSteering steering(fixed(4096), 1000, linear_view(), 1, [] { return 0.0; });
        steering.set_target(target);
        int rounds = 0;
        for (; const int count = steering.next_round(painter.film()); ++rounds) painter.paint(count, steering.active(), noise_on_the_right);
        EXPECT_EQ(steering.stopped_by(), SamplingStop::time_budget);
        // One sample more or less, and twice the spread of what 3072 noisy pixels say: their noise has one degree of freedom each.
        const double step = 1.0 / steering.samples_so_far(), spread = std::sqrt(2.0 / 3072);
        EXPECT_NEAR(report_sampling(painter.film(), steering.stopped_by(), linear_view(), 1).error.relmse / target, 1, step + 2 * spread) << target;
        EXPECT_LE(rounds, 20) << target;
    }
}

TEST(SampleSteering, ATargetDoesNotOutliveTheTime) {
    Painter painter(32, 10);
    double now = 0;
    SampleSteering steering(fixed(4096), 0.5, linear_view(), 1, [&] { return now; });
    steering.set_target(1e-9);
    while (const int count = steering.next_round(painter.film())) painter.paint(count, steering.active(), noise_on_the_right), now += 0.001 * count;
    EXPECT_LE(now, 0.51);
    EXPECT_GE(now, 0.45);
}

TEST(SampleSteering, WhatLooksCalmGetsTheLeastThatAShotAsksFor) {
    Painter painter(8, 11);
    SampleSteering steering(fixed(4096), 1000, linear_view(), 1, [] { return 0.0; });
    steering.set_target(0.01);
    while (const int count = steering.next_round(painter.film())) painter.paint(count, steering.active(), [](int, int, std::mt19937&) { return 0.5f; });
    EXPECT_EQ(steering.samples_so_far(), 32);
}

}  // namespace
}  // namespace kadr
