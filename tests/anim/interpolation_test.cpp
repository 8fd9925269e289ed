// Limited tangents, spins, and glTF's cubic rotations.
#include <gmock/gmock.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "anim/track.h"

namespace kadr {
namespace {

constexpr double kPi = std::numbers::pi;

Track<double> smooth(std::vector<std::pair<double, double>> keys, bool overshoot) {
    Track<double> track;
    for (const auto& [time, value] : keys) track.keys.push_back({time, value, {}, {}, {}});
    track.interpolation = Interpolation::smooth;
    track.overshoot = overshoot;
    return track;
}

TEST(Overshoot, IsLimitedWhereAskedFor) {
    const std::vector<std::pair<double, double>> step_like{{0, 0}, {1, 0}, {2, 1}, {3, 1}};
    EXPECT_LT(evaluate(smooth(step_like, true), 0.5), -0.05);
    EXPECT_GT(evaluate(smooth(step_like, true), 2.5), 1.05);
    EXPECT_EQ(evaluate(smooth(step_like, false), 0.5), 0);
    EXPECT_EQ(evaluate(smooth(step_like, false), 2.5), 1);
}

TEST(Overshoot, GentleCurvesAreLeftAlone) {
    const std::vector<std::pair<double, double>> gentle{{0, 0}, {1, 1}, {2, 3}, {3, 4}};
    for (const double time : {0.3, 1.5, 2.9}) EXPECT_EQ(evaluate(smooth(gentle, true), time), evaluate(smooth(gentle, false), time));
}

TEST(Overshoot, TangentIsAtMostThreeTimesTheFlatterSecant) {
    // Secants 0.1 and 10 at 1 s: Catmull-Rom's 5.05 is cut to 0.3.
    const auto track = smooth({{0, 0}, {1, 0.1}, {2, 10.1}}, false);
    constexpr double h = 1e-7;
    EXPECT_NEAR((evaluate(track, 1 + h) - evaluate(track, 1)) / h, 0.3, 1e-4);  // h times a second derivative of order 60
}

RC_GTEST_PROP(InterpolationProperty, WithoutOvershootEverySegmentIsMonotone, ()) {
    Track<glm::dvec2> track;
    double time = 0;
    for (int i = 0; i < 5; ++i) {
        track.keys.push_back({time, {*rc::gen::inRange(-100, 100) / 4.0, *rc::gen::inRange(-100, 100) / 4.0}, {}, {}, {}});
        time += *rc::gen::inRange(1, 40) / 8.0;
    }
    track.interpolation = Interpolation::smooth;
    track.overshoot = false;
    for (std::size_t i = 0; i + 1 < track.keys.size(); ++i) {
        const Key<glm::dvec2>&a = track.keys[i], &b = track.keys[i + 1];
        glm::dvec2 before = a.value;
        for (int n = 1; n <= 50; ++n) {
            const glm::dvec2 here = evaluate(track, a.time_s + (b.time_s - a.time_s) * n / 50.0);
            for (int c = 0; c < 2; ++c) RC_ASSERT((here[c] - before[c]) * (b.value[c] - a.value[c]) >= -1e-10);  // values up to 25, rounded
            before = here;
        }
    }
}

// ---- Spins ----

glm::dquat about(const glm::dvec3& axis, double degrees) { return glm::angleAxis(glm::radians(degrees), axis); }
double angle_between(const glm::dquat& a, const glm::dquat& b) {
    const glm::dquat d = glm::conjugate(a) * b;
    return glm::degrees(2 * std::atan2(glm::length(glm::dvec3(d.x, d.y, d.z)), std::abs(d.w)));
}
constexpr glm::dvec3 kY(0, 1, 0);

/// Two keys a second apart, the first with a spin.
Track<glm::dquat> spinning(const glm::dquat& from, const glm::dquat& to, Spin spin, Interpolation interpolation = Interpolation::linear) {
    Track<glm::dquat> track;
    track.keys = {{0, from, {}, {}, {}, spin}, {1, to, {}, {}, {}, {}}};
    track.interpolation = interpolation;
    return track;
}

TEST(Spin, AddsWholeTurns) {
    const auto track = spinning(about(kY, 10), about(kY, 70), {2, {}});
    for (const double u : {0.1, 0.25, 0.5, 0.9}) EXPECT_NEAR(angle_between(evaluate(track, u), about(kY, 10 + u * 780)), 0, 1e-10);
    EXPECT_NEAR(turn_of(track, 0, 1), glm::radians(780.0), 1e-12);
    EXPECT_NEAR(turn_of(track, 0.25, 0.5), glm::radians(195.0), 1e-12);
}

TEST(Spin, BackwardsTakesTheLongerWay) {
    const auto track = spinning(about(kY, 10), about(kY, 70), {-1, {}});
    EXPECT_NEAR(angle_between(evaluate(track, 0.5), about(kY, 10 - 150)), 0, 1e-10);
    EXPECT_NEAR(turn_of(track, 0, 1), glm::radians(300.0), 1e-12);
}

TEST(Spin, AnAxisSaysWhichWayHalfATurnGoes) {
    for (const double sign : {1.0, -1.0}) {
        const auto track = spinning(about(kY, 30), about(kY, 210), {0, kY * sign});
        EXPECT_NEAR(angle_between(evaluate(track, 0.5), about(kY, 30 + sign * 90)), 0, 1e-10);
        EXPECT_NEAR(turn_of(track, 0, 1), kPi, 1e-12);
    }
}

TEST(Spin, AnAxisTurnsCounterclockwiseWhateverIsShorter) {
    const auto with = spinning(about(kY, 0), about(kY, 90), {1, kY}), against = spinning(about(kY, 0), about(kY, 90), {1, -kY});
    EXPECT_NEAR(angle_between(evaluate(with, 0.5), about(kY, 225)), 0, 1e-10);
    EXPECT_NEAR(angle_between(evaluate(against, 0.5), about(kY, -315)), 0, 1e-10);
    EXPECT_NEAR(turn_of(against, 0, 1), glm::radians(630.0), 1e-12);
}

TEST(Spin, BetweenEqualKeysTheAxisIsTheStatedOne) {
    const glm::dquat tilted = about({1, 0, 0}, 40);
    const auto track = spinning(tilted, tilted, {3, kY});
    EXPECT_TRUE(varies(track));
    EXPECT_NEAR(angle_between(evaluate(track, 0.25), about(kY, 270) * tilted), 0, 1e-10);  // in the frame that it maps to
}

TEST(Spin, SmoothFlowsThroughKeysThatSpinOnBothSides) {
    Track<glm::dquat> track;
    for (int i = 0; i < 4; ++i) track.keys.push_back({static_cast<double>(i), about(kY, 30 * i), {}, {}, {}, Spin{1, kY}});
    track.keys.back().spin.reset();
    track.interpolation = Interpolation::smooth;
    for (const double time : {0.25, 1.0, 1.6, 2.9}) EXPECT_NEAR(angle_between(evaluate(track, time), about(kY, 390 * time)), 0, 1e-9);  // even speed
    track.keys[2].spin.reset();  // the last segment does not spin: the turns before come to rest
    constexpr double h = 1e-4;
    EXPECT_NEAR(angle_between(evaluate(track, 2 - h), evaluate(track, 2)) / h, 30, 0.5);  // squad's own speed; h times a second derivative of 2e3
    EXPECT_GE(turn_of(track, 0, 3), glm::radians(2 * 390.0 + 30 - 1e-9));
}

TEST(Spin, ContinuesAtItsOwnSpeed) {
    auto track = spinning(about(kY, 0), about(kY, 90), {1, kY});
    track.after = Extrapolation::continued;
    EXPECT_NEAR(angle_between(evaluate(track, 1.2), about(kY, 540)), 0, 1e-10);
    track.interpolation = Interpolation::smooth;
    EXPECT_NEAR(angle_between(evaluate(track, 1.2), about(kY, 540)), 0, 1e-10);
}

RC_GTEST_PROP(SpinProperty, TurnIsNeverLessThanWhatIsSeen, ()) {
    const auto part = [] { return *rc::gen::inRange(-10, 11) / 10.0; };
    const auto rotation = [&] { return about(glm::normalize(glm::dvec3(part() + 0.03, part(), part() + 0.01)), 179 * part()); };
    Track<glm::dquat> track;
    for (int i = 0; i < 3; ++i) track.keys.push_back({static_cast<double>(i), rotation(), {}, {}, {}, Spin{*rc::gen::inRange(-2, 3), {}}});
    track.keys.back().spin.reset();
    track.interpolation = *rc::gen::element(Interpolation::linear, Interpolation::smooth);
    track.after = *rc::gen::element(Extrapolation::hold, Extrapolation::repeat, Extrapolation::pingpong, Extrapolation::continued);
    double from = *rc::gen::inRange(0, 300) / 100.0, to = from + *rc::gen::inRange(1, 200) / 100.0, seen = 0;
    const std::vector<double> jumps = discontinuities(track, from, to + 1e-9);  // at its end a jump is seen, too
    if (!jumps.empty()) to = jumps.front() - 1e-9;
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps; ++i) seen += angle_between(evaluate(track, std::lerp(from, to, i / 400.0)), evaluate(track, std::lerp(from, to, (i + 1) / 400.0)));
    // Squad's turn is that of sixteen chords a segment; between keys almost 180 degrees apart it whips around within one.
    RC_ASSERT(glm::degrees(turn_of(track, from, to)) >= (track.interpolation == Interpolation::linear ? 1 - 1e-6 : 0.85) * seen - 1e-6);
}

// ---- glTF's CUBICSPLINE of rotations ----

/// Keys a second apart; tangents [x, y, z, w] per second.
Track<glm::dquat> cubic(glm::dquat a, glm::dquat a_out, glm::dquat b_in, glm::dquat b) {
    Track<glm::dquat> track;
    track.keys = {{0, a, {}, {}, a_out, {}}, {1, b, {}, b_in, {}, {}}};
    track.interpolation = Interpolation::cubic;
    return track;
}

TEST(CubicRotation, IsGltfsSplineNormalised) {
    // Appendix C.5 at t = 1/2, td = 1: v0/2 + b0/8 + v1/2 - a1/8, by hand:
    // w: 0.5 + 0 + 0.3 - 0.05 = 0.75; z: 0 + 0.1 + 0.4 - 0.025 = 0.475; length 0.887764...
    const auto track = cubic({1, 0, 0, 0}, {0, 0, 0, 0.8}, {0.4, 0, 0, 0.2}, {0.6, 0, 0, 0.8});
    const glm::dquat q = evaluate(track, 0.5);
    EXPECT_NEAR(q.w, 0.75 / std::sqrt(0.75 * 0.75 + 0.475 * 0.475), 1e-15);
    EXPECT_NEAR(q.z, 0.475 / std::sqrt(0.75 * 0.75 + 0.475 * 0.475), 1e-15);
}

TEST(CubicRotation, ANegatedKeyIsTheSameRotationAndTakesTheShorterArc) {
    const auto track = cubic({1, 0, 0, 0}, {0, 0, 0, 0.8}, {0.4, 0, 0, 0.2}, {0.6, 0, 0, 0.8});
    const auto negated = cubic({1, 0, 0, 0}, {0, 0, 0, 0.8}, {-0.4, 0, 0, -0.2}, {-0.6, 0, 0, -0.8});
    for (const double u : {0.2, 0.5, 0.8}) EXPECT_LT(angle_between(evaluate(track, u), evaluate(negated, u)), 1e-10);
}

TEST(CubicRotation, ContinuesWithWhatTurnsInItsTangent) {
    auto track = cubic({1, 0, 0, 0}, {0, 0, 0, 0.8}, {0.4, 0, 0, 0.2}, {0.6, 0, 0, 0.8});
    track.before = Extrapolation::continued;
    EXPECT_NEAR(angle_between(evaluate(track, -0.5), about({0, 0, 1}, -glm::degrees(0.8))), 0, 1e-10);  // half the rate is the tangent's z
    constexpr double h = 1e-6;
    track.after = Extrapolation::continued;
    const double left = angle_between(evaluate(track, 1 - h), evaluate(track, 1)) / h, right = angle_between(evaluate(track, 1), evaluate(track, 1 + h)) / h;
    EXPECT_NEAR(left, right, 1e-3);  // h times a second derivative of order 100 degrees
}

}  // namespace
}  // namespace kadr
