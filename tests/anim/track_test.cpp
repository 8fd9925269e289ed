#include "anim/transform.h"

#include <gmock/gmock.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

namespace kadr {
namespace {

using testing::ElementsAre;

constexpr double kPi = std::numbers::pi;
// Sums of a handful of products of numbers of order 1 to 10.
constexpr double kRounding = 1e-13;

Key<double> key(double time_s, double value) { return {time_s, value, {}, {}, {}}; }
Key<glm::dquat> turn(double time_s, double degrees, glm::dvec3 axis = {0, 0, 1}) {
    return {time_s, glm::angleAxis(glm::radians(degrees), axis), {}, {}, {}};
}
template <class T>
Track<T> track_of(std::vector<Key<T>> keys, Interpolation interpolation) {
    Track<T> track;
    track.keys = std::move(keys);
    track.interpolation = interpolation;
    return track;
}
double angle_between(const glm::dquat& a, const glm::dquat& b) {
    const glm::dquat d = glm::conjugate(a) * b;
    return glm::degrees(2 * std::atan2(glm::length(glm::dvec3(d.x, d.y, d.z)), std::abs(d.w)));
}

TEST(Track, HoldsItsEnds) {
    const auto track = track_of<double>({key(1, 10), key(2, 20)}, Interpolation::linear);
    EXPECT_EQ(evaluate(track, 0), 10);
    EXPECT_EQ(evaluate(track, 1.25), 12.5);
    EXPECT_EQ(evaluate(track, 3), 20);
    EXPECT_EQ(evaluate(Track<double>(7.0), 3), 7);
}

TEST(Track, StepJumpsAtTheKey) {
    const auto track = track_of<double>({key(0, 1), key(1, 1), key(2, 5), key(3, 6)}, Interpolation::step);
    EXPECT_EQ(evaluate(track, std::nextafter(2.0, 0.0)), 1);
    EXPECT_EQ(evaluate(track, 2), 5);
    EXPECT_THAT(discontinuities(track, 0, 3), ElementsAre(2));  // no jump at 1, and 3 is outside
    EXPECT_THAT(key_times(track, 0, 3), ElementsAre(1, 2));
}

TEST(Track, LinearHasNoDiscontinuity) {
    EXPECT_TRUE(discontinuities(track_of<double>({key(0, 1), key(1, 5)}, Interpolation::linear), -1, 2).empty());
}

TEST(Track, SmoothTangentsAreThoseOfTheFormat) {
    const auto track = track_of<double>({key(0, 0), key(1, 2), key(4, 5), key(5, 0)}, Interpolation::smooth);
    constexpr double h = 1e-6;
    const auto slope = [&](double time) { return (evaluate(track, time + h) - evaluate(track, time - h)) / (2 * h); };
    EXPECT_NEAR(slope(1), (5.0 - 0.0) / 4.0, 1e-5);  // a difference quotient: h times the jump of the second derivative
    EXPECT_NEAR(slope(4), (0.0 - 2.0) / 4.0, 1e-5);
    EXPECT_NEAR((evaluate(track, h) - 0) / h, 2.0, 1e-5);
    EXPECT_EQ(evaluate(track, 4), 5);
}

TEST(Track, CubicTakesTheTangentsOfTheFile) {
    Track<double> track = track_of<double>({key(0, 1), key(2, 3)}, Interpolation::cubic);
    track.keys[0].out_tangent = 4;
    track.keys[1].in_tangent = -1;
    // glTF 2.0 appendix C.5 at u = 1/2: v0/2 + td b0/8 + v1/2 - td a1/8
    EXPECT_NEAR(evaluate(track, 1), 0.5 + 2 * 4 / 8.0 + 1.5 - 2 * -1 / 8.0, kRounding);
}

TEST(Track, EasesAsCssDoes) {
    Track<double> track = track_of<double>({key(0, 0), key(1, 1)}, Interpolation::linear);
    track.keys[0].ease = Ease{0.42, 0, 0.58, 1};
    EXPECT_NEAR(evaluate(track, 0.5), 0.5, kRounding);
    EXPECT_NEAR(evaluate(track, 0.25) + evaluate(track, 0.75), 1, kRounding);
    EXPECT_NEAR(evaluate(track, 0.25), 0.129161931, 1e-8);  // the curve solved in 30 decimal digits, printed with 9
    track.keys[0].ease = Ease{1, 0, 0, 1};  // vertical in the middle: Newton alone fails there
    EXPECT_NEAR(evaluate(track, 0.5), 0.5, 1e-5);  // x is cubic flat at 1/2: the 15th digit of x is the 5th of u
    track.keys[0].ease = Ease{0.25, -2, 0.75, 3};
    EXPECT_LT(evaluate(track, 0.1), 0);
}

TEST(Rotation, SlerpTakesTheShorterArc) {
    auto track = track_of<glm::dquat>({turn(0, 170), turn(1, -170)}, Interpolation::linear);
    EXPECT_NEAR(angle_between(evaluate(track, 0.5), turn(0, 180).value), 0, 1e-12);
    track.keys[1].value = -track.keys[1].value;
    EXPECT_NEAR(angle_between(evaluate(track, 0.25), turn(0, 175).value), 0, 1e-12);
}

TEST(Rotation, SquadOfTwoKeysIsSlerp) {
    const auto track = track_of<glm::dquat>({turn(0, 0), turn(2, 120)}, Interpolation::smooth);
    EXPECT_NEAR(angle_between(evaluate(track, 0.5), turn(0, 30).value), 0, 1e-12);
}

TEST(Rotation, SquadAboutOneAxisIsSmoothAtUnevenKeys) {
    const auto track = track_of<glm::dquat>({turn(0, 0), turn(1, 20), turn(4, 100), turn(5, 110)}, Interpolation::smooth);
    EXPECT_NEAR(angle_between(evaluate(track, 1), turn(0, 20).value), 0, 1e-12);
    constexpr double h = 1e-4;
    const double before = angle_between(evaluate(track, 1 - h), evaluate(track, 1)) / h;
    const double after = angle_between(evaluate(track, 1), evaluate(track, 1 + h)) / h;
    EXPECT_NEAR(before, 100.0 / 4.0, 0.02);  // one-sided quotients: h/2 times a second derivative of order 100
    EXPECT_NEAR(after, 100.0 / 4.0, 0.02);
}

TEST(Rotation, AxisAngleTurnsManyTimes) {
    RotationTrack track;
    track.axis_angle = RotationTrack::AxisAngle{{0, 1, 0}, track_of<double>({key(0, 0), key(1, 20 * kPi)}, Interpolation::linear)};
    EXPECT_NEAR(angle_between(evaluate(track, 1.0 / 80), turn(0, 45, {0, 1, 0}).value), 0, 1e-11);
    EXPECT_NEAR(angle_between(evaluate(track, 0.5), glm::dquat(1, 0, 0, 0)), 0, 1e-11);
}

TEST(Rotation, DegreesTurnAboutXFirst) {
    const glm::dvec3 turned = rotation_from_degrees({90, 0, 90}) * glm::dvec3(0, 1, 0);  // y -> z by x, z stays by z
    EXPECT_NEAR(glm::distance(turned, glm::dvec3(0, 0, 1)), 0, kRounding);
}

TEST(Transform, IsTranslationTimesRotationTimesScale) {
    TransformTrack track;
    track.translate = Track<glm::dvec3>(glm::dvec3(1, 2, 3));
    track.rotate.orientation = Track<glm::dquat>(turn(0, 90).value);
    track.scale = Track<glm::dvec3>(glm::dvec3(2, 3, 4));
    EXPECT_TRUE(track.is_constant());
    const glm::dvec4 moved = evaluate(track, 5) * glm::dvec4(1, 1, 1, 1);
    EXPECT_NEAR(glm::distance(moved, glm::dvec4(1 - 3, 2 + 2, 3 + 4, 1)), 0, kRounding);
    track.rotate.axis_angle = RotationTrack::AxisAngle{{0, 0, 1}, track_of<double>({key(0, 0), key(1, 1)}, Interpolation::linear)};
    EXPECT_FALSE(track.is_constant());
}

RC_GTEST_PROP(TrackProperty, ALinearValueLiesBetweenItsKeys, ()) {
    const auto values = *rc::gen::container<std::vector<int>>(5, rc::gen::inRange(-1000, 1000));
    Track<double> track;
    for (std::size_t i = 0; i < values.size(); ++i) track.keys.push_back(key(0.5 * static_cast<double>(i), values[i]));
    if (track.keys.empty()) return;
    const double time = *rc::gen::inRange(0, 2000) / 1000.0;
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(time / 0.5), values.size() - 2);
    const double value = evaluate(track, time);
    const double slack = 1e-12;  // a * (1 - u) + b * u of values up to 1000
    RC_ASSERT(value >= std::min(values[i], values[i + 1]) - slack);
    RC_ASSERT(value <= std::max(values[i], values[i + 1]) + slack);
}

RC_GTEST_PROP(TrackProperty, RotationsAreUnitWhateverTheInterpolation, ()) {
    Track<glm::dquat> track;
    for (int i = 0; i < 4; ++i) {
        const auto c = [] { return *rc::gen::inRange(1, 100) - 50.5; };
        track.keys.push_back({static_cast<double>(i * i + i), glm::normalize(glm::dquat(c(), c(), c(), c())), {}, {}, {}});
        track.keys.back().in_tangent = track.keys.back().out_tangent = glm::dquat(0, 0, 0, 0);
    }
    track.interpolation = *rc::gen::element(Interpolation::step, Interpolation::linear, Interpolation::smooth, Interpolation::cubic);
    const glm::dquat q = evaluate(track, *rc::gen::inRange(0, 12000) / 1000.0);
    RC_ASSERT(std::abs(glm::length(q) - 1) < 1e-12);
}

RC_GTEST_PROP(TrackProperty, EveryInterpolationGoesThroughItsKeys, ()) {
    Track<glm::dvec3> track;
    for (int i = 0; i < 4; ++i) {
        const auto c = [] { return static_cast<double>(*rc::gen::inRange(-100, 100)); };
        track.keys.push_back({static_cast<double>(i * i + i), glm::dvec3(c(), c(), c()), {}, glm::dvec3(c()), glm::dvec3(c())});
    }
    track.interpolation = *rc::gen::element(Interpolation::step, Interpolation::linear, Interpolation::smooth, Interpolation::cubic);
    for (const auto& k : track.keys) RC_ASSERT(glm::distance(evaluate(track, k.time_s), k.value) < 1e-11);
}

}  // namespace
}  // namespace kadr
