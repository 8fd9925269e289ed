#include "anim/shutter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anim/timing.h"

namespace kadr {
namespace {

using Shape = ShutterCurve::Shape;

double efficiency(const ShutterCurve& curve, double x) {
    switch (curve.shape) {
        case Shape::box: return 1;
        case Shape::triangle: return 1 - std::abs(2 * x - 1);
        case Shape::smooth: return 0.5 - 0.5 * std::cos(2 * M_PI * x);
        case Shape::keys: break;
    }
    // The keys of the test below.
    if (x < 0.1) return 0.2;
    if (x < 0.3) return 0.2 + 4 * (x - 0.1);
    return x < 0.8 ? 1 - (x - 0.3) : 0.5;
}

TEST(ShutterCurve, LightPassedIsTheIntegral) {
    const ShutterCurve keyed{Shape::keys, {{0.1, 0.2}, {0.3, 1}, {0.8, 0.5}}};
    for (const ShutterCurve& curve : {ShutterCurve{}, ShutterCurve{Shape::triangle, {}}, ShutterCurve{Shape::smooth, {}}, keyed}) {
        constexpr int kSteps = 20000;
        double sum = 0;
        for (int i = 0; i < kSteps; ++i) {
            // Midpoints: off by the second derivative over 24 n^2, and by less than 1/n^2 at a kink.
            EXPECT_NEAR(light_passed(curve, static_cast<double>(i) / kSteps), sum, 1e-8) << "shape " << static_cast<int>(curve.shape);
            sum += efficiency(curve, (i + 0.5) / kSteps) / kSteps;
        }
        EXPECT_EQ(light_passed(curve, 2), light_passed(curve, 1));
        EXPECT_EQ(light_passed(curve, -1), 0);
    }
}

TEST(ShutterCurve, PhysicalExposureComparesWithAWholeOpenFrame) {
    Shutter shutter;  // 180 degrees
    EXPECT_EQ(exposure_factor(shutter, {24, 1}), 1);
    shutter.physical = true;
    EXPECT_EQ(exposure_factor(shutter, {24, 1}), 0.5);
    shutter.curve.shape = Shape::triangle;
    EXPECT_EQ(exposure_factor(shutter, {24, 1}), 0.25);
    Shutter timed{0, 0, 0, 1.0 / 100, {}, {}, true};
    EXPECT_DOUBLE_EQ(exposure_factor(timed, {25, 1}), 0.25);
    EXPECT_DOUBLE_EQ(exposure_factor(timed, {50, 1}), 0.5);
}

TEST(Sequence, AWindowHoldsTheLastLineOfARollingShutter) {
    Shutter shutter;
    shutter.rolling = {RollingShutter::Direction::down, 0.01};
    const FrameTime frame = Sequence({{25, 1}, {0}, 0}, shutter).frame(25);
    EXPECT_EQ(frame.open_s, 1.0);
    EXPECT_DOUBLE_EQ(frame.close_s, 1.0 + 0.02 + 0.01);
    EXPECT_DOUBLE_EQ(open_length_s(shutter, {25, 1}), 0.02);
}

TEST(Sequence, ATimedShutterIsTheSameAtEveryFrameRate) {
    const Shutter shutter{0, 0, -1.0 / 96, 1.0 / 96, {}, {}, false};
    // 1001 s is a frame of all four rates.
    const FrameTime reference = Sequence({{24, 1}, {0}, 0}, shutter).frame(24 * 1001);
    for (const auto& [fps, number] : {std::pair{Rational{25, 1}, 25 * 1001}, {Rational{30000, 1001}, 30000}, {Rational{120, 1}, 120 * 1001}}) {
        const FrameTime frame = Sequence({fps, {0}, 0}, shutter).frame(number);
        EXPECT_EQ(frame.time, reference.time);
        EXPECT_EQ(frame.open_s, reference.open_s);
        EXPECT_EQ(frame.close_s, reference.close_s);
    }
}

}  // namespace
}  // namespace kadr
