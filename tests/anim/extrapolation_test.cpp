// What tracks do outside their keys, and where they jump then.
#include <gmock/gmock.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "anim/timing.h"
#include "anim/transform.h"
#include "base/error.h"

namespace kadr {
namespace {

using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;
constexpr auto kEveryInterpolation = {Interpolation::step, Interpolation::linear, Interpolation::smooth, Interpolation::cubic};

Track<double> numbers(std::vector<std::pair<double, double>> keys, Interpolation interpolation, Extrapolation before, Extrapolation after) {
    Track<double> track;
    for (const auto& [time, value] : keys) track.keys.push_back({time, value, {}, 0.5, -0.25});
    track.interpolation = interpolation;
    track.before = before;
    track.after = after;
    return track;
}
Track<double> saw(Extrapolation before, Extrapolation after, Interpolation interpolation = Interpolation::linear) {
    return numbers({{1, 10}, {2, 20}, {4, 30}}, interpolation, before, after);
}
Track<glm::dquat> turning(std::vector<std::pair<double, double>> degrees, Extrapolation before, Extrapolation after) {
    Track<glm::dquat> track;
    for (const auto& [time, angle] : degrees) track.keys.push_back({time, glm::angleAxis(glm::radians(angle), glm::dvec3(0, 0, 1)), {}, {}, {}});
    track.before = before;
    track.after = after;
    return track;
}
/// Degrees about z, -180 to 180.
double degrees_of(const glm::dquat& q) { return std::remainder(glm::degrees(2 * std::atan2(q.z, q.w)), 360.0); }

TEST(Extrapolation, RepeatStartsAgainAtTheLastKey) {
    const auto track = saw(Extrapolation::repeat, Extrapolation::repeat);
    EXPECT_EQ(evaluate(track, 1.5), 15);
    EXPECT_EQ(evaluate(track, 4), 10);  // where a value jumps the later one holds
    EXPECT_EQ(evaluate(track, 4.5), 15);
    EXPECT_EQ(evaluate(track, 1), 10);
    EXPECT_EQ(evaluate(track, 0), 25);
    EXPECT_EQ(evaluate(track, -1.5), 15);
    EXPECT_EQ(evaluate(track, 3e9 + 1.5), 15);
}

TEST(Extrapolation, PingpongRunsBackAndForth) {
    const auto track = saw(Extrapolation::pingpong, Extrapolation::pingpong);
    EXPECT_EQ(evaluate(track, 4), 30);
    EXPECT_EQ(evaluate(track, 5), 25);
    EXPECT_EQ(evaluate(track, 7), 10);
    EXPECT_EQ(evaluate(track, 8), 20);
    EXPECT_EQ(evaluate(track, 0), 20);
    EXPECT_EQ(evaluate(track, -1), 25);
}

TEST(Extrapolation, ContinuesWithTheSlopeOfTheEnd) {
    const auto track = saw(Extrapolation::continued, Extrapolation::continued);
    EXPECT_EQ(evaluate(track, 6), 40);
    EXPECT_EQ(evaluate(track, 0), 0);
    auto cubic = saw(Extrapolation::continued, Extrapolation::continued, Interpolation::cubic);
    EXPECT_EQ(evaluate(cubic, 6), 30 + 2 * 0.5);     // its in-tangent
    EXPECT_EQ(evaluate(cubic, 0), 10 - 1 * -0.25);   // the first key's out-tangent
    EXPECT_EQ(evaluate(saw(Extrapolation::continued, Extrapolation::continued, Interpolation::step), 9), 30);
}

TEST(Extrapolation, ContinuesAnEasedSegmentWithTheEasesSlope) {
    auto track = numbers({{0, 0}, {1, 1}}, Interpolation::linear, Extrapolation::continued, Extrapolation::continued);
    track.keys[0].ease = Ease{0.5, 0.25, 0.75, 0.5};  // slopes 1/2 and 2 by the control points
    EXPECT_DOUBLE_EQ(evaluate(track, -2), -1);
    EXPECT_DOUBLE_EQ(evaluate(track, 3), 1 + 2 * 2);
    track.keys[0].ease = Ease{0, 0.5, 1, 0.5};  // vertical at both ends
    EXPECT_EQ(evaluate(track, 3), 1);
    track.keys[0].ease = Ease{0, 0, 1, 1};  // the control points lie on the ends
    EXPECT_EQ(evaluate(track, 3), 3);
}

TEST(Extrapolation, EachEndHasTheEaseOfItsOwnSegment) {
    auto track = numbers({{0, 0}, {1, 1}, {2, 2}, {3, 3}}, Interpolation::linear, Extrapolation::continued, Extrapolation::continued);
    track.keys[0].ease = Ease{0.5, 0.25, 0.75, 0.25};  // slope 1/2 at its start, 3 at its end
    track.keys[1].ease = Ease{0.5, 0.05, 0.5, 0.1};    // that of neither
    track.keys[2].ease = Ease{0.25, 1, 0.5, 0.25};     // 4 and 3/2
    EXPECT_DOUBLE_EQ(evaluate(track, -2), -1);
    EXPECT_DOUBLE_EQ(evaluate(track, 5), 3 + 2 * 1.5);
    EXPECT_DOUBLE_EQ(travel_of(track, -3, -1), 1);
    EXPECT_DOUBLE_EQ(travel_of(track, 4, 6), 3);
}

TEST(Extrapolation, RotationsTurnOn) {
    const auto linear = turning({{0, 0}, {1, 40}, {2, 100}}, Extrapolation::continued, Extrapolation::continued);
    EXPECT_NEAR(degrees_of(evaluate(linear, 5)), 100 + 3 * 60 - 360, 1e-12);
    EXPECT_NEAR(degrees_of(evaluate(linear, -1)), -40, 1e-12);
    auto smooth = linear;
    smooth.interpolation = Interpolation::smooth;
    EXPECT_NEAR(degrees_of(evaluate(smooth, 3)), 160, 1e-12);
    const auto repeated = turning({{0, 0}, {1, 40}, {2, 100}}, Extrapolation::repeat, Extrapolation::pingpong);
    EXPECT_NEAR(degrees_of(evaluate(repeated, -0.5)), 70, 1e-12);
    EXPECT_NEAR(degrees_of(evaluate(repeated, 2.5)), 70, 1e-12);
}

TEST(Extrapolation, SeamsAreJumps) {
    const auto track = saw(Extrapolation::repeat, Extrapolation::repeat);
    EXPECT_THAT(discontinuities(track, -3, 8), ElementsAre(-2, 1, 4, 7));
    EXPECT_THAT(discontinuities(track, 1, 4), IsEmpty());
    EXPECT_THAT(discontinuities(saw(Extrapolation::hold, Extrapolation::repeat), -3, 8), ElementsAre(4, 7));
    EXPECT_THAT(discontinuities(saw(Extrapolation::repeat, Extrapolation::hold), -3, 8), ElementsAre(-2, 1));
    EXPECT_THAT(discontinuities(saw(Extrapolation::pingpong, Extrapolation::pingpong), -30, 80), IsEmpty());
    EXPECT_THAT(discontinuities(saw(Extrapolation::continued, Extrapolation::continued), -30, 80), IsEmpty());
    const auto closed = numbers({{0, 1}, {1, 5}, {2, 1}}, Interpolation::linear, Extrapolation::repeat, Extrapolation::repeat);
    EXPECT_THAT(discontinuities(closed, -30, 80), IsEmpty());
    const auto full_turn = turning({{0, 0}, {1, 120}, {2, 240}, {3, 360}}, Extrapolation::repeat, Extrapolation::repeat);
    EXPECT_THAT(discontinuities(full_turn, 0.5, 10), IsEmpty());  // q and -q are one rotation
}

TEST(Extrapolation, StepKeysJumpInEveryPass) {
    const auto repeated = saw(Extrapolation::hold, Extrapolation::repeat, Interpolation::step);
    // 10 to 2 s, 20 to 4 s; the last key ends the span and is never seen.
    EXPECT_THAT(discontinuities(repeated, 0, 9), ElementsAre(2, 4, 5, 7, 8));
    EXPECT_EQ(evaluate(repeated, 4), 10);
    EXPECT_EQ(evaluate(repeated, 5), 20);
    const auto back = saw(Extrapolation::pingpong, Extrapolation::pingpong, Interpolation::step);
    EXPECT_THAT(discontinuities(back, -1, 9), ElementsAre(0, 2, 6, 8));
    EXPECT_EQ(evaluate(back, 4), 20);
    EXPECT_EQ(evaluate(back, 6), 10);  // the later value holds on the way back, too
    EXPECT_EQ(evaluate(back, std::nextafter(6.0, 0.0)), 20);
    EXPECT_THAT(discontinuities(saw(Extrapolation::hold, Extrapolation::hold, Interpolation::step), 0, 9), ElementsAre(2, 4));
    const auto three = numbers({{0, 1}, {1, 2}, {2, 9}}, Interpolation::step, Extrapolation::repeat, Extrapolation::repeat);
    EXPECT_THAT(discontinuities(three, 0.5, 3.5), ElementsAre(1, 2, 3));
}

TEST(Extrapolation, KeysComeBackInEveryPass) {
    EXPECT_THAT(key_times(saw(Extrapolation::repeat, Extrapolation::repeat), -2.5, 5.5), ElementsAre(-2, -1, 1, 2, 4, 5));
    EXPECT_THAT(key_times(saw(Extrapolation::pingpong, Extrapolation::pingpong), -1, 8.5), ElementsAre(0, 1, 2, 4, 6, 7, 8));
    EXPECT_THAT(key_times(saw(Extrapolation::hold, Extrapolation::continued), -1, 8.5), ElementsAre(1, 2, 4));
}

TEST(Extrapolation, EachEndLoopsInItsOwnWay) {
    const auto back_first = saw(Extrapolation::pingpong, Extrapolation::repeat), back_last = saw(Extrapolation::repeat, Extrapolation::pingpong);
    EXPECT_EQ(evaluate(back_first, 0), 20);
    EXPECT_EQ(evaluate(back_first, 5), 20);
    EXPECT_EQ(evaluate(back_last, -1), 20);
    EXPECT_EQ(evaluate(back_last, 6), 20);
    EXPECT_THAT(key_times(back_first, -2.5, 7.5), ElementsAre(-2, 0, 1, 2, 4, 5, 7));
    EXPECT_THAT(key_times(back_last, -2.5, 7.5), ElementsAre(-2, -1, 1, 2, 4, 6, 7));
    EXPECT_THAT(discontinuities(back_first, -6, 8), ElementsAre(4, 7));
    EXPECT_THAT(discontinuities(back_last, -6, 8), ElementsAre(-5, -2, 1));
}

TEST(Extrapolation, NeverListsWithoutBound) {
    auto loop = numbers({{0, 0}, {0.0005, 1}, {0.001, 0}}, Interpolation::linear, Extrapolation::repeat, Extrapolation::repeat);
    EXPECT_EQ(key_times(loop, -1e9, 1e9).size(), kMostListedTimes);
    EXPECT_THAT(discontinuities(loop, -1e9, 1e9), IsEmpty());
    loop.interpolation = Interpolation::step;
    try {
        discontinuities(loop, 0, 1e9);
        ADD_FAILURE() << "expected an error";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "error: a track jumps more than 1024 times from 0 s to 1000000000 s\n"
                                   "  expected fewer step keys and repeats in that time");
    }
    EXPECT_EQ(discontinuities(loop, 5, 5.1).size(), 199u);  // every half millisecond, the ends excluded
    // A span so short that the passes of the interval cannot be counted in a double.
    const auto tiny = numbers({{0, 0}, {1e-12, 1}}, Interpolation::linear, Extrapolation::pingpong, Extrapolation::pingpong);
    EXPECT_LE(key_times(tiny, -1e9, 1e9).size(), kMostListedTimes);
    EXPECT_THAT(discontinuities(tiny, -1e9, 1e9), IsEmpty());
}

TEST(Turn, CountsEveryPassAndTheWayOn) {
    const double degree = kPi / 180;
    const auto back = turning({{0, 0}, {1, 90}}, Extrapolation::pingpong, Extrapolation::pingpong);
    EXPECT_NEAR(turn_of(back, 0, 2), 180 * degree, 1e-12);
    EXPECT_NEAR(turn_of(back, -0.5, 0.25), 67.5 * degree, 1e-12);
    EXPECT_GE(turn_of(back, 0, 1000), 1000 * 90 * degree - 1e-9);
    const auto on = turning({{0, 0}, {1, 90}}, Extrapolation::hold, Extrapolation::continued);
    EXPECT_NEAR(turn_of(on, -5, 10), 900 * degree, 1e-11);
    EXPECT_EQ(turn_of(turning({{0, 0}, {1, 90}}, Extrapolation::hold, Extrapolation::hold), 2, 10), 0);
    RotationTrack wheel;
    wheel.axis_angle = RotationTrack::AxisAngle{{0, 1, 0}, numbers({{0, 0}, {1, 1}}, Interpolation::linear, Extrapolation::hold, Extrapolation::continued)};
    EXPECT_NEAR(turn_of(wheel, 0, 50), 50, 1e-12);
    wheel.axis_angle->angle_rad.after = Extrapolation::repeat;
    EXPECT_GE(turn_of(wheel, 0, 1e6), 1e6 - 1);
}

// ---- Properties ----

Track<double> any_track(Extrapolation before, Extrapolation after) {
    Track<double> track;
    double time = *rc::gen::inRange(-8, 8) / 4.0;
    const int count = *rc::gen::inRange(2, 7);
    for (int i = 0; i < count; ++i) {
        track.keys.push_back({time, *rc::gen::inRange(-100, 100) / 4.0, {}, *rc::gen::inRange(-20, 20) / 4.0, *rc::gen::inRange(-20, 20) / 4.0});
        time += *rc::gen::inRange(1, 9) / 4.0;
    }
    track.interpolation = *rc::gen::elementOf(std::vector<Interpolation>(kEveryInterpolation));
    track.before = before;
    track.after = after;
    return track;
}
double any_time() { return *rc::gen::inRange(-4000, 4000) / 64.0; }

// What makes frames of a loop the same frame: times that differ by the rounding of N / fps and of the period alone.
TEST(Extrapolation, LoopsRepeatToTheLastBit) {
    for (const int fps : {24, 25, 30, 60})
        for (const int period : {7, 24, 50}) {
            const auto at = [&](int frame) { return static_cast<double>(frame) / fps; };
            for (const Interpolation interpolation : {Interpolation::step, Interpolation::linear, Interpolation::smooth}) {
                const auto track = numbers({{at(0), 0.3}, {at(2), 1.7}, {at(5), -0.4}, {at(period), 0.9}}, interpolation, Extrapolation::repeat, Extrapolation::repeat);
                for (int frame = 0; frame < period; ++frame)
                    for (const int pass : {1, 2, 3, 10, 101}) EXPECT_EQ(evaluate(track, at(frame)), evaluate(track, at(frame + pass * period))) << fps << ' ' << period << ' ' << frame << ' ' << pass;
            }
        }
}

RC_GTEST_PROP(ExtrapolationProperty, RepeatIsPeriodic, ()) {
    const auto track = any_track(Extrapolation::repeat, Extrapolation::repeat);
    const double period = track.keys.back().time_s - track.keys.front().time_s, time = any_time();
    // Times and periods are multiples of 1/64: the sums are exact.
    for (const double passes : {1.0, -1.0, 7.0, -20.0}) RC_ASSERT(evaluate(track, time + passes * period) == evaluate(track, time));
}

RC_GTEST_PROP(ExtrapolationProperty, PingpongIsSymmetric, ()) {
    auto track = any_track(Extrapolation::pingpong, Extrapolation::pingpong);
    if (track.interpolation == Interpolation::step) track.interpolation = Interpolation::linear;  // there the later value holds
    const double first = track.keys.front().time_s, last = track.keys.back().time_s, by = any_time();
    RC_ASSERT(evaluate(track, first + by) == evaluate(track, first - by));
    RC_ASSERT(evaluate(track, last + by) == evaluate(track, last - by));
}

RC_GTEST_PROP(ExtrapolationProperty, ContinueHasNoCorner, ()) {
    const auto track = any_track(Extrapolation::continued, Extrapolation::continued);
    RC_PRE(track.interpolation != Interpolation::step);
    constexpr double h = 1e-7;
    for (const double end : {track.keys.front().time_s, track.keys.back().time_s}) {
        const double left = (evaluate(track, end) - evaluate(track, end - h)) / h, right = (evaluate(track, end + h) - evaluate(track, end)) / h;
        // Values up to 100 over keys a quarter apart: second derivatives up to 1e4, times h; rounding 1e-14 / h.
        RC_ASSERT(std::abs(left - right) < 2e-2);
    }
}

RC_GTEST_PROP(ExtrapolationProperty, KeysAreMetExactly, ()) {
    const auto track = any_track(Extrapolation::continued, Extrapolation::pingpong);
    for (std::size_t i = 0; i + 1 < track.keys.size(); ++i) RC_ASSERT(evaluate(track, track.keys[i].time_s) == track.keys[i].value);
}

RC_GTEST_PROP(ExtrapolationProperty, BetweenJumpsTheValueIsContinuous, ()) {
    const auto mode = [] { return *rc::gen::element(Extrapolation::hold, Extrapolation::repeat, Extrapolation::pingpong, Extrapolation::continued); };
    const auto track = any_track(mode(), mode());
    const std::vector<double> jumps = discontinuities(track, -40, 40);
    RC_ASSERT(std::is_sorted(jumps.begin(), jumps.end()));
    // Every time where the value may jump is a multiple of 1/4.
    for (double time = -39.75; time < 40; time += 0.25) {
        constexpr double h = 1e-9;
        const double jump = std::abs(evaluate(track, time) - evaluate(track, time - h));
        const bool listed = std::binary_search(jumps.begin(), jumps.end(), time);
        RC_ASSERT((listed ? jump >= 0.25 - 1e-5 : jump < 1e-5));  // values are multiples of 1/4; slopes stay below 1e4
    }
}

RC_GTEST_PROP(ExtrapolationProperty, EveryFrameRateSeesTheSameValuesAtCommonTimes, ()) {
    const auto mode = [] { return *rc::gen::element(Extrapolation::hold, Extrapolation::repeat, Extrapolation::pingpong, Extrapolation::continued); };
    const auto track = any_track(mode(), mode());
    constexpr Rational kRates[] = {{24, 1}, {25, 1}, {30000, 1001}, {120, 1}};
    const int seconds = *rc::gen::inRange(-30, 30);
    for (const Rational& rate : kRates) {
        // 1001 s is the first time after 0 that all four meet; the three whole rates meet every second.
        const bool whole = rate.denominator == 1;
        const int frame = whole ? seconds * static_cast<int>(rate.numerator) : seconds * 30000;
        const FrameTime at = Sequence({rate, {0}, 0}, {0, 0}).frame(frame);
        const double time = whole ? seconds : seconds * 1001.0;
        RC_ASSERT(at.time == make_rational(whole ? seconds : seconds * 1001, 1));
        RC_ASSERT(evaluate(track, at.time_s()) == evaluate(track, time));
        RC_ASSERT(evaluate(track, at.open_s) == evaluate(track, time));
    }
}

// By rounding alone a third of the frames that fall on a seam showed the end of the pass before. The tolerance: a few ulps
// of 80 s, at up to 300 a second.
TEST(Repeat, FramesOnASeamBeginTheNextPass) {
    for (const double fps : {24.0, 25.0, 30.0, 24000 / 1001.0})
        for (int frames = 1; frames <= 48; ++frames) {
            Track<double> track;
            track.keys = {{3 / fps, 10, {}, {}, {}}, {(3 + frames) / fps, 20, {}, {}, {}}};
            track.before = track.after = Extrapolation::repeat;
            for (int pass = -20; pass <= 40; ++pass)
                EXPECT_NEAR(evaluate(track, (3 + frames * pass) / fps), 10, 1e-9) << frames << " frames, pass " << pass << " at " << fps;
            EXPECT_EQ(evaluate(track, std::nextafter(track.keys[1].time_s, 0)), 10);
        }
}

}  // namespace
}  // namespace kadr
