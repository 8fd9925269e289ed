#include <gtest/gtest.h>

#include <cmath>

#include "kernels/camera/shutter.h"
#include "kernels/statistics.h"

namespace kadr::kernels {
namespace {

constexpr int kPoints = 1 << 14;

/// A shutter whose light rises and falls linearly.
Shutter triangle() {
    Shutter shutter;
    shutter.plain = false;
    for (int i = 0; i <= Shutter::kIntervals; ++i) {
        const double x = static_cast<double>(i) / Shutter::kIntervals;
        shutter.passed[i] = static_cast<float>(x < 0.5 ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x));
    }
    return shutter;
}

/// Mean over evenly spread random numbers of weight * value(time).
template <class Value>
double mean_of(const Shutter& shutter, float line, Value value) {
    double sum = 0;
    for (int i = 0; i < kPoints; ++i) {
        float time, weight;
        sample_shutter(shutter, line, (static_cast<float>(i) + 0.5f) / kPoints, time, weight);
        sum += weight * value(static_cast<double>(time));
    }
    return sum / kPoints;
}

TEST(Shutter, APlainOneTakesTheRandomNumberItself) {
    Shutter shutter;
    for (const float u : {0.0f, 0.1f, 0.33333334f, 0.99999994f}) {
        float time, weight;
        sample_shutter(shutter, 0.7f, u, time, weight);
        EXPECT_EQ(time, u);
        EXPECT_EQ(weight, 1.0f);
    }
}

TEST(Shutter, TimesFollowTheCurve) {
    const Shutter shutter = triangle();
    // Within one of 512 intervals light counts as even: moments are off by less than (1/512)^2.
    const double tolerance = 4e-6;
    EXPECT_NEAR(mean_of(shutter, 0, [](double) { return 1.0; }), 1, 1e-6);
    EXPECT_NEAR(mean_of(shutter, 0, [](double t) { return t; }), 0.5, tolerance);
    EXPECT_NEAR(mean_of(shutter, 0, [](double t) { return (t - 0.5) * (t - 0.5); }), 1.0 / 24, tolerance);
    // A quarter of the time at either end brings an eighth of the light.
    EXPECT_NEAR(mean_of(shutter, 0, [](double t) { return t < 0.25 ? 1.0 : 0.0; }), 0.125, 2.0 / kPoints);
}

TEST(Shutter, PartsOfASplitShutterAddUpForEveryLine) {
    // One line of a rolling shutter: opens at 0.6 * line, for 0.4; the window [0, 1] is cut at random times. Whatever
    // the cuts, the parts' samples together see what the line sees.
    Random random(17);
    for (int round = 0; round < 50; ++round) {
        const float line = random();
        const double open = 0.6 * line, length = 0.4, cut = 0.05 + 0.9 * random();
        double light = 0, centre = 0, spread = 0;
        for (const auto& [begin, end] : {std::pair{0.0, cut}, std::pair{cut, 1.0}}) {
            Shutter part = triangle();
            const double unit = end - begin;
            part.first_open = static_cast<float>(-begin / unit);
            part.delay = static_cast<float>(0.6 / unit);
            part.length = static_cast<float>(length / unit);
            const auto absolute = [&, b = begin](double t) { return b + t * unit - open; };
            light += mean_of(part, line, [](double) { return 1.0; });
            centre += mean_of(part, line, absolute);
            spread += mean_of(part, line, [&](double t) { return std::pow(absolute(t) - length / 2, 2); });
        }
        // Floats that are divided by a part of 1/20: 20 * 2^-24 a sample, with room for the table's steps.
        EXPECT_NEAR(light, 1, 1e-5) << "cut " << cut << ", line " << line;
        EXPECT_NEAR(centre, length / 2, 1e-5) << "cut " << cut << ", line " << line;
        EXPECT_NEAR(spread, length * length / 24, 1e-5) << "cut " << cut << ", line " << line;
    }
}

TEST(Shutter, LinesThatOpenInAnInstantBelongToOnePart) {
    Shutter part;
    part.plain = false;
    part.first_open = -0.5f, part.delay = 2.0f, part.length = 0.0f;
    float time, weight;
    sample_shutter(part, 0.5f, 0.3f, time, weight);
    EXPECT_EQ(time, 0.5f);
    EXPECT_EQ(weight, 1.0f);
    for (const float line : {0.1f, 0.8f}) {
        sample_shutter(part, line, 0.3f, time, weight);
        EXPECT_EQ(weight, 0.0f) << line;
    }
}

TEST(Shutter, LinesRunInTheDirectionOfTheSensor) {
    using enum RollingDirection;
    const auto line = [](RollingDirection direction, int x, int y) { return line_of_pixel<float>(direction, x, y, 8, 4); };
    EXPECT_EQ(line(down, 0, 0), 0.125f);
    EXPECT_EQ(line(down, 7, 3), 0.875f);
    EXPECT_EQ(line(up, 0, 0), 0.875f);
    EXPECT_EQ(line(right, 1, 3), 0.1875f);
    EXPECT_EQ(line(left, 1, 3), 0.8125f);
}

}  // namespace
}  // namespace kadr::kernels
