// Paths by arc length, orbits, what turns along a path, and shake.
#include <gmock/gmock.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "anim/position.h"
#include "anim/shake.h"
#include "anim/transform.h"

namespace kadr {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

std::vector<glm::dvec3> circle(int points, double radius) {
    std::vector<glm::dvec3> all;
    for (int i = 0; i < points; ++i) all.emplace_back(radius * std::cos(2 * kPi * i / points), 0, radius * std::sin(2 * kPi * i / points));
    return all;
}
Track<double> ramp(double from_s, double to_s, double total) {
    Track<double> track;
    track.keys = {{from_s, 0, {}, {}, {}}, {to_s, total, {}, {}, {}}};
    return track;
}
PositionTrack along(std::vector<glm::dvec3> points, bool closed, Track<double> at) {
    PositionTrack track;
    track.path = PathMotion{Path(std::move(points), closed), std::move(at), true, {0, 1, 0}, {"shot.yaml", 4, 2}};
    return track;
}

TEST(Path, AStraightLineIsEvenHoweverItsPointsLie) {
    const glm::dvec3 a(1, -2, 3), b(11, 4, 0);
    std::vector<glm::dvec3> points;
    for (const double u : {0.0, 0.001, 0.1, 0.11, 0.5, 0.93, 1.0}) points.push_back(glm::mix(a, b, u));
    const Path path(points, false);
    EXPECT_NEAR(path.length(), glm::distance(a, b), 1e-10 * glm::distance(a, b));
    for (const double f : {0.0, 0.0005, 0.05, 0.105, 0.3, 0.77, 1.0}) {
        EXPECT_LT(glm::distance(path.position(f), glm::mix(a, b, f)), 1e-9 * glm::distance(a, b)) << f;
        EXPECT_LT(glm::distance(path.tangent(f), glm::normalize(b - a)), 1e-9) << f;
    }
    EXPECT_EQ(path.position(-3), a);  // an open path ends at its ends
    EXPECT_LT(glm::distance(path.position(2), b), 1e-14 * 20);
}

TEST(Path, ManyPointsOnACircleAreTheCircle) {
    // The spline leaves the circle by about h^4 / 200 between points 2 pi / 256 apart: 2e-9 of the radius.
    const Path path(circle(256, 2), true);
    EXPECT_NEAR(path.length(), 4 * kPi, 1e-6 * 4 * kPi);
    for (const double f : {0.0, 0.01, 0.123, 0.5, 0.876, 0.999}) {
        const glm::dvec3 wanted(2 * std::cos(2 * kPi * f), 0, 2 * std::sin(2 * kPi * f));
        EXPECT_LT(glm::distance(path.position(f), wanted), 1e-6 * path.length()) << f;
        EXPECT_LT(glm::distance(path.position(f - 3), path.position(f)), 1e-12) << f;
        EXPECT_LT(glm::distance(path.tangent(f), glm::dvec3(-std::sin(2 * kPi * f), 0, std::cos(2 * kPi * f))), 1e-4) << f;
    }
}

TEST(Path, AnUnevenCircleIsEvenToo) {
    // Points crowd on one side; 400 of them so that the widest gap, 2 pi / 400 * 1.9, is still a good circle.
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 400; ++i) {
        const double angle = 2 * kPi * i / 400 + 0.9 * std::sin(2 * kPi * i / 400);
        points.emplace_back(std::cos(angle), std::sin(angle), 0);
    }
    const Path path(points, true);
    EXPECT_NEAR(path.length(), 2 * kPi, 1e-6 * 2 * kPi);
    for (const double f : {0.1, 0.25, 0.4, 0.6, 0.9})
        EXPECT_LT(glm::distance(path.position(f), glm::dvec3(std::cos(2 * kPi * f), std::sin(2 * kPi * f), 0)), 1e-6 * path.length()) << f;
}

TEST(Path, PassesItsPoints) {
    const std::vector<glm::dvec3> points{{0, 0, 0}, {1, 2, 0}, {5, 2, 1}, {5, 2, 9}};
    const Path path(points, false);
    for (const glm::dvec3& point : points) {
        double nearest = 1e9;
        for (int i = 0; i <= 20000; ++i) nearest = std::min(nearest, glm::distance(path.position(i / 20000.0), point));
        EXPECT_LT(nearest, path.length() / 20000);
    }
}

TEST(Path, HasNoDirectionWhereItTurnsBack) {
    const Path path({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, false);
    EXPECT_NEAR(path.length(), 2, 1e-9);
    EXPECT_EQ(path.tangent(0.5), glm::dvec3(0));
    EXPECT_LT(glm::distance(path.tangent(0.25), glm::dvec3(1, 0, 0)), 1e-12);
    EXPECT_LT(glm::distance(path.position(0.75), glm::dvec3(0.5, 0, 0)), 1e-9);
}

/// The spline between b and c by repeated interpolation over centripetal knots, which has nothing in common with tangents.
/// Source: Barry & Goldman 1988, "A recursive evaluation algorithm for a class of Catmull-Rom splines".
glm::dvec3 pyramid(const std::array<glm::dvec3, 4>& p, double u) {
    double knot[4] = {0, 0, 0, 0};
    for (int i = 1; i < 4; ++i) knot[i] = knot[i - 1] + std::sqrt(glm::distance(p[i - 1], p[i]));
    const double t = std::lerp(knot[1], knot[2], u);
    const auto between = [&](const glm::dvec3& a, const glm::dvec3& b, int from, int to) { return glm::mix(a, b, (t - knot[from]) / (knot[to] - knot[from])); };
    const glm::dvec3 a0 = between(p[0], p[1], 0, 1), a1 = between(p[1], p[2], 1, 2), a2 = between(p[2], p[3], 2, 3);
    return between(between(a0, a1, 0, 2), between(a1, a2, 1, 3), 1, 2);
}

/// Compares a path with the curve of its segments, a hundred places in each: chords give their lengths.
void expect_pyramids(const Path& path, const std::vector<std::array<glm::dvec3, 4>>& segments) {
    constexpr int kChords = 20000, kEvery = 200;
    std::vector<std::pair<double, glm::dvec3>> places;
    double length = 0;
    for (const auto& segment : segments)
        for (int i = 0; i < kChords; ++i) {
            const glm::dvec3 here = pyramid(segment, i / static_cast<double>(kChords)), next = pyramid(segment, (i + 1.0) / kChords);
            if (i % kEvery == 0) places.emplace_back(length, here);
            length += glm::distance(here, next);
        }
    // Chords are short by (length * curvature)^2 / 24: 1 mm at radii above 1 cm, in few places.
    EXPECT_NEAR(path.length(), length, 1e-6 * length);
    for (const auto& [before, wanted] : places) EXPECT_LT(glm::distance(path.position(before / length), wanted), 3e-6 * length);
}

TEST(Path, IsTheCentripetalSplineOfThePyramid) {
    const std::vector<glm::dvec3> points{{0, 0, 0}, {1, 2, 0}, {5, 2, 1}, {5, 2.5, 1}, {2, -4, 6}};
    const std::size_t n = points.size();
    std::vector<std::array<glm::dvec3, 4>> ring, open;
    for (std::size_t i = 0; i < n; ++i) ring.push_back({points[(i + n - 1) % n], points[i], points[(i + 1) % n], points[(i + 2) % n]});
    expect_pyramids(Path(points, true), ring);
    open.assign(ring.begin(), ring.end() - 1);
    open.front()[0] = 2.0 * points[0] - points[1];  // an open path leaves its ends straight: as if its neighbour were reflected
    open.back()[3] = 2.0 * points[n - 1] - points[n - 2];
    expect_pyramids(Path(points, false), open);
}

RC_GTEST_PROP(PathProperty, EqualStepsAreEqualDistances, ()) {
    std::vector<glm::dvec3> points;
    // Around a circle, each point off it, so that no corner is sharp: a chord across one says nothing about the curve.
    const int count = *rc::gen::inRange(5, 10);
    const auto off = [] { return *rc::gen::inRange(-100, 100) / 200.0; };
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * kPi * (i + 0.4 * off()) / count, radius = 3 + off();
        points.emplace_back(radius * std::cos(angle), off(), radius * std::sin(angle));
    }
    const Path path(points, *rc::gen::arbitrary<bool>());
    constexpr int kSteps = 10000;
    double sum = 0;
    glm::dvec3 before = path.position(0);
    for (int i = 1; i <= kSteps; ++i) {
        const glm::dvec3 here = path.position(i == kSteps && path.closed() ? 0 : i / static_cast<double>(kSteps));
        sum += glm::distance(before, here);
        before = here;
        // Chords are short of the curve by (length * curvature)^2 / 24: steps of 2 mm, radii above 0.4 m.
        if (i % (kSteps / 4) == 0) RC_ASSERT(std::abs(sum - path.length() * i / kSteps) < 1e-6 * path.length());
    }
}

TEST(Position, TravelsItsPathWithEvenSpeed) {
    const PositionTrack track = along({{0, 0, 0}, {1, 0, 0}, {10, 0, 0}}, false, ramp(1, 3, 1));
    EXPECT_LT(glm::distance(evaluate(track, 0), glm::dvec3(0)), 1e-12);
    EXPECT_LT(glm::distance(evaluate(track, 1.5), glm::dvec3(2.5, 0, 0)), 1e-8);
    EXPECT_LT(glm::distance(evaluate(track, 5), glm::dvec3(10, 0, 0)), 1e-12);
    EXPECT_TRUE(varies(track));
    EXPECT_FALSE(track.is_constant());
    EXPECT_THAT(key_times(track, 0, 1.1), ElementsAre(1));
    EXPECT_THAT(key_times(track, 1.2, 1.8), ElementsAre(testing::DoubleEq(1.5)));  // 0.3 of 2 segments, two parts each: 2 parts
    EXPECT_THAT(key_times(track, 4, 5), IsEmpty());
}

TEST(Position, OrbitsCounterclockwiseSeenFromAbove) {
    PositionTrack track;
    track.orbit = OrbitMotion{glm::dvec3(1, 2, 3), 2.0, 0.5, ramp(0, 4, 1), 0};
    EXPECT_LT(glm::distance(evaluate(track, 0), glm::dvec3(1, 2.5, 5)), 1e-14);
    EXPECT_LT(glm::distance(evaluate(track, 1), glm::dvec3(3, 2.5, 3)), 1e-14);
    EXPECT_LT(glm::distance(evaluate(track, 2), glm::dvec3(1, 2.5, 1)), 1e-14);
    track.orbit->start_rad = kPi / 2;
    EXPECT_LT(glm::distance(evaluate(track, 0), glm::dvec3(3, 2.5, 3)), 1e-14);
    EXPECT_EQ(key_times(track, 0.5, 1.5).size(), 3u);  // a quarter turn, sixteen parts a turn
}

TEST(Position, WhirlingDoesNotHideBetweenSamples) {
    PositionTrack track;
    track.orbit = OrbitMotion{glm::dvec3(0), 1.0, 0.0, ramp(0, 1, 100), 0};
    EXPECT_EQ(key_times(track, 0, 0.04).size(), 63u);  // four turns
}

TEST(Position, AnOrbitHasTheKeysAndJumpsOfAllItsTracks) {
    const auto keyed = [](double time_s, auto a, auto b) {
        Track<decltype(a)> track;
        track.keys = {{0, a, {}, {}, {}}, {time_s, b, {}, {}, {}}, {9, a, {}, {}, {}}};
        return track;
    };
    PositionTrack track;
    track.orbit = OrbitMotion{keyed(1, glm::dvec3(0), glm::dvec3(1)), keyed(2, 1.0, 2.0), keyed(3, 0.0, 1.0), keyed(4, 0.0, 0.0), 0};
    EXPECT_THAT(key_times(track, 0.5, 5), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(discontinuities(track, 0.5, 5), IsEmpty());
    track.orbit->turns.keys[1].value = 1;  // a step to the same value is none
    track.orbit->around.interpolation = Interpolation::step;
    track.orbit->radius_m.interpolation = track.orbit->height_m.interpolation = track.orbit->turns.interpolation = Interpolation::step;
    EXPECT_THAT(discontinuities(track, 0.5, 5), ElementsAre(1, 2, 3, 4));
    for (const int moving : {0, 1, 2, 3}) {
        PositionTrack one;
        one.orbit = OrbitMotion{};
        if (moving == 0) one.orbit->around = track.orbit->around;
        if (moving == 1) one.orbit->radius_m = track.orbit->radius_m;
        if (moving == 2) one.orbit->height_m = track.orbit->height_m;
        if (moving == 3) one.orbit->turns = track.orbit->turns;
        EXPECT_TRUE(varies(one)) << moving;
    }
}

TEST(Position, TurnsIntoItsPath) {
    TransformTrack transform;
    transform.translate = along(circle(256, 2), true, ramp(0, 1, 1));
    const glm::dmat4 m = evaluate(transform, 0.25);
    EXPECT_LT(glm::distance(glm::dvec3(m[2]), glm::dvec3(-1, 0, 0)), 1e-4);  // +z leads, from +z towards -x
    EXPECT_LT(glm::distance(glm::dvec3(m[1]), glm::dvec3(0, 1, 0)), 1e-14);
    EXPECT_NEAR(glm::determinant(glm::dmat3(m)), 1, 1e-12);
    EXPECT_NEAR(turn_of(transform, 0, 1), 2 * kPi, 1e-2);
    transform.rotate.orientation = Track<glm::dquat>(glm::angleAxis(kPi / 2, glm::dvec3(0, 1, 0)));  // first about its own axes
    EXPECT_LT(glm::distance(glm::dvec3(evaluate(transform, 0.25)[0]), glm::dvec3(1, 0, 0)), 1e-4);
}

TEST(Position, TurnsAlongAfterItsOwnTurn) {
    TransformTrack transform;
    transform.translate = along({{0, 0, 0}, {-5, 0, 0}}, false, ramp(0, 1, 1));
    transform.rotate.orientation = Track<glm::dquat>(glm::angleAxis(kPi / 2, glm::dvec3(1, 0, 0)));
    // Its own turn lays +z down to -y, which a turn about y leaves there; the other way round -z would be up, and so on.
    const glm::dmat4 m = evaluate(transform, 0.5);
    EXPECT_LT(glm::distance(glm::dvec3(m[2]), glm::dvec3(0, -1, 0)), 1e-14);
    EXPECT_LT(glm::distance(glm::dvec3(m[1]), glm::dvec3(-1, 0, 0)), 1e-14);  // +y to +z, which leads along the path
    EXPECT_LT(glm::distance(glm::dvec3(m[0]), glm::dvec3(0, 0, 1)), 1e-14);
}

TEST(Position, SaysWhereNothingIsUp) {
    const PositionTrack track = along({{0, 0, 0}, {0, 5, 0}}, false, ramp(0, 1, 1));
    try {
        rotation_along(*track.path, 0.5);
        ADD_FAILURE() << "expected an error";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "shot.yaml:4:2: error: the path runs along its up direction at 0.5 s\n"
                                   "  expected another up: [x, y, z] beside orient: along");
    }
    const PositionTrack back = along({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, false, ramp(0, 1, 1));
    try {
        rotation_along(*back.path, 0.5);
        ADD_FAILURE() << "expected an error";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "shot.yaml:4:2: error: the path turns back on itself at 0.5 s and has no direction there\n"
                                   "  expected a point beside it that makes the turn a curve, or no orient: along");
    }
}

// ---- Shake ----

TEST(Shake, IsAPureFunctionOfItsSeed) {
    EXPECT_EQ(band_limited_noise(1.25, 4, 7, 0), band_limited_noise(1.25, 4, 7, 0));
    EXPECT_NE(band_limited_noise(1.25, 4, 7, 0), band_limited_noise(1.25, 4, 8, 0));
    EXPECT_NE(band_limited_noise(1.25, 4, 7, 0), band_limited_noise(1.25, 4, 7, 1));
}

TEST(Shake, StaysWithinItsAmplitudeAndUsesIt) {
    glm::dvec3 most(0), square(0);
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
        const glm::dvec3 here = band_limited_noise(i * 0.013, 5, 3, 0);
        most = glm::max(most, glm::abs(here));
        square += here * here;
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(most[axis], 1);
        EXPECT_GT(most[axis], 0.6);
        // Root of half the sum of squared weights 1/k over the sum of weights, k = 1 ... 12: 0.285.
        EXPECT_NEAR(std::sqrt(square[axis] / kSamples), 0.285, 0.01);
    }
}

/// Power at a frequency through a Blackman-Harris window, whose side lobes are 92 dB down beyond four bins.
double power_at(const std::vector<double>& samples, double cycles) {
    std::complex<double> sum = 0;
    const double n = static_cast<double>(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double x = 2 * kPi * static_cast<double>(i) / n;
        const double window = 0.35875 - 0.48829 * std::cos(x) + 0.14128 * std::cos(2 * x) - 0.01168 * std::cos(3 * x);
        sum += samples[i] * window * std::polar(1.0, -x * cycles);
    }
    return std::norm(sum);
}

TEST(Shake, HasNothingAboveItsFrequency) {
    constexpr double kFrequency = 6, kRate = 8 * kFrequency;
    constexpr int kSamples = 4096;
    for (const std::uint64_t seed : {0u, 1u, 99u}) {
        std::vector<double> samples;
        for (int i = 0; i < kSamples; ++i) samples.push_back(band_limited_noise(i / kRate, kFrequency, seed, 0).x);
        constexpr int kLimit = kSamples / 8;  // the bin of kFrequency
        double inside = 0, above = 0;
        std::vector<double> bands(4, 0.0);
        for (int bin = 1; bin < kLimit; ++bin) {
            const double power = power_at(samples, bin);
            inside += power;
            bands[static_cast<std::size_t>(4 * bin / kLimit)] += power;
        }
        for (int bin = kLimit + 4; bin < kSamples / 2; ++bin) above += power_at(samples, bin);
        EXPECT_LT(above, 1e-7 * inside);
        for (const double band : bands) EXPECT_GT(band, 1e-3 * inside);
    }
}

TEST(Shake, NoAxisAndNoChannelFollowsAnother) {
    constexpr int kSamples = 20000, kSignals = 6;
    double products[kSignals][kSignals] = {};
    Shake shake;
    shake.amplitude_m = shake.angle_rad = glm::dvec3(1);
    shake.frequency_hz = 5, shake.seed = 3;
    for (int i = 0; i < kSamples; ++i) {
        const ShakeOffset at = evaluate(shake, i * 0.113);
        const double here[kSignals] = {at.offset_m.x, at.offset_m.y, at.offset_m.z, at.turn_rad.x, at.turn_rad.y, at.turn_rad.z};
        for (int a = 0; a < kSignals; ++a)
            for (int b = 0; b < kSignals; ++b) products[a][b] += here[a] * here[b];
    }
    // Sinusoids of other frequencies: their products average out by 1 / (2 pi * difference * 2260 s), 0.01 for a difference of 7 mHz.
    for (int a = 0; a < kSignals; ++a)
        for (int b = 0; b < a; ++b) EXPECT_LT(std::abs(products[a][b]) / std::sqrt(products[a][a] * products[b][b]), 0.03) << a << ' ' << b;
}

TEST(Shake, HasTheKeysAndJumpsOfBothItsTracks) {
    const auto keyed = [](double time_s) {
        Track<glm::dvec3> track;
        track.keys = {{0, glm::dvec3(0), {}, {}, {}}, {time_s, glm::dvec3(1), {}, {}, {}}, {9, glm::dvec3(0), {}, {}, {}}};
        return track;
    };
    Shake shake;
    shake.amplitude_m = keyed(1), shake.angle_rad = keyed(2);
    shake.frequency_hz = 0.01;  // one part: no times of its own
    EXPECT_THAT(key_times(shake, 0.5, 5), ElementsAre(1, 2));
    EXPECT_THAT(discontinuities(shake, 0.5, 5), IsEmpty());
    shake.amplitude_m.interpolation = shake.angle_rad.interpolation = Interpolation::step;
    EXPECT_THAT(discontinuities(shake, 0.5, 5), ElementsAre(1, 2));
}

TEST(Shake, FollowsItsAmplitudesAndAsksForEnoughSamples) {
    Shake shake;
    shake.amplitude_m = glm::dvec3(0.1, 0, 0);
    shake.angle_rad.keys = {{0, glm::dvec3(0), {}, {}, {}}, {1, glm::dvec3(0.02), {}, {}, {}}};
    shake.frequency_hz = 10;
    EXPECT_EQ(evaluate(shake, 0).turn_rad, glm::dvec3(0));
    EXPECT_NE(evaluate(shake, 1).turn_rad, glm::dvec3(0));
    EXPECT_EQ(evaluate(shake, 0.3).offset_m, glm::dvec3(0.1, 0, 0) * band_limited_noise(0.3, 10, 0, 0));
    EXPECT_THAT(key_times(shake, 0.25, 0.3), ElementsAre(0.275));  // half a cycle: two parts
}

}  // namespace
}  // namespace kadr
