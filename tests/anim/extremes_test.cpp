// The least and greatest values of tracks, against closed forms and against dense samples of any track.
#include "anim/track_extremes.h"

#include <gmock/gmock.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "anim/roots.h"

namespace kadr {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;

// Of values of order 1 to 10 after a handful of operations each.
constexpr double kRounding = 1e-12;

Key<double> key(double time_s, double value, std::optional<Ease> ease = {}, double in = 0, double out = 0) { return {time_s, value, ease, in, out}; }
Track<double> track_of(std::vector<Key<double>> keys, Interpolation interpolation, Extrapolation before = Extrapolation::hold, Extrapolation after = Extrapolation::hold) {
    Track<double> track;
    track.keys = std::move(keys);
    track.interpolation = interpolation;
    track.before = before, track.after = after;
    return track;
}

TEST(QuadraticRoots, AreAllOfThem) {
    EXPECT_THAT(quadratic_roots(1, -3, 2), ElementsAre(1, 2));
    EXPECT_THAT(quadratic_roots(-2, 0, 8), ElementsAre(-2, 2));
    EXPECT_THAT(quadratic_roots(0, 2, -3), ElementsAre(1.5));
    EXPECT_THAT(quadratic_roots(4, 0, 0), ElementsAre(0));
    EXPECT_THAT(quadratic_roots(1, 0, 1), IsEmpty());
    EXPECT_THAT(quadratic_roots(0, 0, 1), IsEmpty());
    // The small one is not lost beside the large one.
    EXPECT_THAT(quadratic_roots(1, -1e9, 1), ElementsAre(DoubleNear(1e-9, 1e-24), DoubleNear(1e9, 1e-6)));
}

TEST(Easing, TurnsWhereItsControlPointsLeadItBack) {
    const Ease swing{0.5, 2, 0.5, -1};  // y = 10 s^3 - 15 s^2 + 6 s, x = 1.5 s - 1.5 s^2 + s^3
    const auto x = [](double s) { return 1.5 * s - 1.5 * s * s + s * s * s; };
    const double early = 0.5 - std::sqrt(0.05), late = 0.5 + std::sqrt(0.05);  // of 30 s^2 - 30 s + 6
    EXPECT_THAT(turning_points(swing), ElementsAre(DoubleNear(x(early), kRounding), DoubleNear(x(late), kRounding)));
    EXPECT_THAT(crossings(swing, 0.5), ElementsAre(DoubleNear(x(0.5 - std::sqrt(0.15)), kRounding), DoubleNear(0.5, kRounding), DoubleNear(x(0.5 + std::sqrt(0.15)), kRounding)));
    EXPECT_THAT(turning_points({0.42, 0, 0.58, 1}), IsEmpty());
    EXPECT_THAT(crossings({0.42, 0, 0.58, 1}, 2), IsEmpty());
}

TEST(TrackExtremes, SmoothSwingsBeyondItsKeysByItsSlopes) {
    const Track<double> track = track_of({key(0, 0), key(1, 1), key(2, 1), key(3, 0)}, Interpolation::smooth);
    const Extremes extremes = extremes_of(track, 0, 3);
    EXPECT_NEAR(extremes.greatest.value, 1.125, kRounding);  // 1 + u (1 - u) / 2 between the two keys at 1
    EXPECT_NEAR(extremes.greatest.time_s, 1.5, kRounding);
    EXPECT_EQ(extremes.least.value, 0);
    EXPECT_TRUE(may_leave_keys(track));
    Track<double> tame = track;
    tame.overshoot = false;
    EXPECT_FALSE(may_leave_keys(tame));
    EXPECT_EQ(extremes_of(tame, 0, 3).greatest.value, 1);
}

TEST(TrackExtremes, OnlyTheIntervalCounts) {
    const Track<double> track = track_of({key(0, 0), key(1, 1), key(2, 1), key(3, 0)}, Interpolation::smooth);
    EXPECT_NEAR(extremes_of(track, 1.25, 1.375).greatest.value, evaluate(track, 1.375), kRounding);
    EXPECT_NEAR(extremes_of(track, 1.25, 1.375).least.value, evaluate(track, 1.25), kRounding);
    EXPECT_NEAR(extremes_of(track, 1.25, 1.625).greatest.value, 1.125, kRounding);
    EXPECT_EQ(extremes_of(track, -2, -1).greatest.value, 0);
}

TEST(TrackExtremes, CubicTangentsSwingBothWays) {
    const Track<double> track = track_of({key(0, 0, {}, 0, 2), key(2, 0, {}, 2, 0)}, Interpolation::cubic);  // 4 u (2u - 1) (u - 1)
    const Extremes extremes = extremes_of(track, 0, 2);
    EXPECT_NEAR(extremes.greatest.value, 4 * std::sqrt(3.0) / 18, kRounding);
    EXPECT_NEAR(extremes.least.value, -4 * std::sqrt(3.0) / 18, kRounding);
    EXPECT_NEAR(extremes.greatest.time_s, 1 - std::sqrt(3.0) / 3, kRounding);
    EXPECT_NEAR(extremes.least.time_s, 1 + std::sqrt(3.0) / 3, kRounding);
    EXPECT_EQ(excursion_at(track, 0.4), Excursion::cubic);
}

TEST(TrackExtremes, AnEaseSwingsBeyondBothKeys) {
    const Track<double> track = track_of({key(0, 10, Ease{0.5, 4, 0.5, -3}), key(1, 20)}, Interpolation::linear);
    const double swing = 3 * std::sqrt(4.5 / 66);  // y = 1/2 + 22 d^3 - 9/2 d at d = s - 1/2, turning at d^2 = 4.5 / 66
    EXPECT_NEAR(extremes_of(track, 0, 1).greatest.value, 15 + 10 * swing, kRounding);
    EXPECT_NEAR(extremes_of(track, 0, 1).least.value, 15 - 10 * swing, kRounding);
    EXPECT_EQ(excursion_at(track, 0.2), Excursion::ease);
}

TEST(TrackExtremes, AnEaseLeadsASmoothSegmentToItsTurn) {
    // The segment's curve 1 + u (1 - u) / 2, run up to y = 1.125 and back by an ease that reaches beyond its half.
    Track<double> track = track_of({key(0, 0), key(1, 1, Ease{0.1, 0.9, 0.2, 0.9}), key(2, 1), key(3, 0)}, Interpolation::smooth);
    EXPECT_NEAR(extremes_of(track, 1, 2).greatest.value, 1.125, kRounding);
    EXPECT_LT(extremes_of(track, 1, 2).greatest.time_s, 1.2);
}

TEST(TrackExtremes, AContinuedTrackGoesOnToTheIntervalsEnds) {
    const Track<double> track = track_of({key(1, 4), key(2, 3)}, Interpolation::linear, Extrapolation::continued, Extrapolation::continued);
    const Extremes extremes = extremes_of(track, -1, 6);
    EXPECT_NEAR(extremes.greatest.value, 6, kRounding);
    EXPECT_EQ(extremes.greatest.time_s, -1);
    EXPECT_NEAR(extremes.least.value, -1, kRounding);
    EXPECT_EQ(extremes.least.time_s, 6);
    EXPECT_EQ(excursion_at(track, 6), Excursion::continued);
    EXPECT_EQ(excursion_at(track, -1), Excursion::continued);
}

TEST(TrackExtremes, RepeatedPassesHaveTheKeyedOnesExtremesAtTheirOwnTimes) {
    const std::vector<Key<double>> keys{key(0, 0), key(1, 1), key(2, 1), key(3, 0)};
    const Extremes again = extremes_of(track_of(keys, Interpolation::smooth, Extrapolation::hold, Extrapolation::repeat), 10, 11);
    EXPECT_NEAR(again.greatest.value, 1.125, kRounding);
    EXPECT_NEAR(again.greatest.time_s, 10.5, kRounding);
    const Extremes back = extremes_of(track_of({key(0, 0, {}, 0, 2), key(2, 0, {}, 2, 0)}, Interpolation::cubic, Extrapolation::hold, Extrapolation::pingpong), 2, 4);
    EXPECT_NEAR(back.least.time_s, 3 - std::sqrt(3.0) / 3, kRounding);
    EXPECT_NEAR(extremes_of(track_of(keys, Interpolation::smooth, Extrapolation::hold, Extrapolation::repeat), 2.9, 1e6).greatest.value, 1.125, kRounding);
}

TEST(TrackExtremes, ALoopReachesItsLastKeyWhateverItsSecondsAreRoundedTo) {
    constexpr double kFirst = -3, kLast = 1.1;
    ASSERT_LT(kFirst + (kLast - kFirst), kLast);  // one double less
    const std::vector<Key<double>> keys{key(kFirst, 0), key(-1, 1), key(kLast, 5)};
    const Extremes next = extremes_of(track_of(keys, Interpolation::linear, Extrapolation::hold, Extrapolation::repeat), 3.5, 7);
    EXPECT_EQ(next.greatest.value, 5);
    EXPECT_NEAR(next.greatest.time_s, 5.2, kRounding);
}

TEST(TrackZeros, AreWhereItPassesThroughAndWhereItTurns) {
    EXPECT_THAT(zeros_of(track_of({key(0, 3), key(1, -1), key(2, 1)}, Interpolation::linear), 0, 2), ElementsAre(DoubleNear(0.75, kRounding), DoubleNear(1.5, kRounding)));
    EXPECT_THAT(zeros_of(track_of({key(0, 3), key(1, -1), key(2, 1)}, Interpolation::linear), 0, 0.5), IsEmpty());
    EXPECT_THAT(zeros_of(track_of({key(0, 3), key(1, -1)}, Interpolation::step), 0, 2), IsEmpty());
    EXPECT_THAT(zeros_of(track_of({key(0, 3), key(1, 1)}, Interpolation::linear), 0, 2), IsEmpty());
    EXPECT_THAT(zeros_of(Track<double>(0.0), 0, 2), IsEmpty());
    EXPECT_THAT(zeros_of(track_of({key(0, 0), key(1, 0)}, Interpolation::linear), 0, 2), IsEmpty());  // it stays there
    EXPECT_THAT(zeros_of(track_of({key(0, 1), key(1, 0), key(2, 3)}, Interpolation::linear), 0, 2), testing::Each(1));  // at a key
    EXPECT_FALSE(zeros_of(track_of({key(0, 1), key(1, 0), key(2, 3)}, Interpolation::linear), 0, 1).empty());
    // (0.7 - u)^2 touches zero, but for rounding.
    EXPECT_THAT(zeros_of(track_of({key(0, 0.49, {}, 0, -1.4), key(1, 0.09, {}, 0.6, 0)}, Interpolation::cubic), 0, 1), testing::Contains(DoubleNear(0.7, kRounding)));
    // An ease leads below zero and back.
    EXPECT_EQ(zeros_of(track_of({key(0, 1, Ease{0.5, 4, 0.5, -3}), key(1, 0.1)}, Interpolation::linear), 0, 1).size(), 2u);
}

TEST(TrackZeros, BeyondTheKeysToo) {
    const auto falling = track_of({key(0, 3), key(1, 2)}, Interpolation::linear, Extrapolation::continued, Extrapolation::continued);
    EXPECT_THAT(zeros_of(falling, 0, 4), ElementsAre(DoubleNear(3, kRounding)));
    EXPECT_THAT(zeros_of(falling, 0, 2.9), IsEmpty());
    EXPECT_THAT(zeros_of(track_of({key(1, 2), key(2, 3)}, Interpolation::linear, Extrapolation::continued), -4, 4), ElementsAre(DoubleNear(-1, kRounding)));
    const auto loop = track_of({key(0, 3), key(1, -1)}, Interpolation::linear, Extrapolation::pingpong, Extrapolation::repeat);
    EXPECT_THAT(zeros_of(loop, -1, 2), ElementsAre(DoubleNear(-0.75, kRounding), DoubleNear(0.75, kRounding), DoubleNear(1.75, kRounding)));
    EXPECT_THAT(zeros_of(loop, 0.8, 1.7), IsEmpty());  // it jumps from -1 to 3
}

TEST(GreatestDifference, IsFoundBetweenKeys) {
    const auto flat = track_of({key(0, 1), key(4, 1)}, Interpolation::linear);
    const auto peak = track_of({key(0, 0), key(1.3, 2), key(4, 0)}, Interpolation::linear);
    EXPECT_EQ(greatest_difference(peak, flat, 0, 4).value, 1);
    EXPECT_EQ(greatest_difference(peak, flat, 0, 4).time_s, 1.3);
    EXPECT_NEAR(greatest_difference(flat, peak, 1, 3).value, 1 - 2 / 2.7, kRounding);
    EXPECT_EQ(greatest_difference(peak, Track<double>(3.0), 2, 2).value, evaluate(peak, 2) - 3);
    const auto valley = track_of({key(0, 2), key(1.3, 0), key(4, 2)}, Interpolation::linear);
    EXPECT_EQ(greatest_difference(flat, valley, 0, 4).value, 1);
    EXPECT_EQ(greatest_difference(flat, valley, 0, 4).time_s, 1.3);
    // The smooth segment's 1 + u (1 - u) / 2 against 1.1 + 0.11 u: greatest at u = 0.39, which is none of sixteen steps.
    const auto smooth = track_of({key(0, 0), key(1, 1), key(2, 1), key(3, 0)}, Interpolation::smooth), rising = track_of({key(1, 1.1), key(2, 1.21)}, Interpolation::linear);
    const Extreme greatest = greatest_difference(smooth, rising, 1, 2);
    EXPECT_NEAR(greatest.value, 0.5 * 0.39 * 0.61 - 0.1 - 0.11 * 0.39, kRounding);
    EXPECT_NEAR(greatest.time_s, 1.39, 1e-6);  // flat there: half the digits
}

TEST(TrackExtremes, OnlySomeTracksCanLeaveTheirKeys) {
    const std::vector<Key<double>> keys{key(0, 0), key(1, 1)}, swinging{key(0, 0, Ease{0.3, -0.5, 0.7, 1}), key(1, 1)};
    EXPECT_FALSE(may_leave_keys(Track<double>(3.0)));
    EXPECT_FALSE(may_leave_keys(track_of(keys, Interpolation::linear, Extrapolation::repeat, Extrapolation::pingpong)));
    EXPECT_FALSE(may_leave_keys(track_of({key(0, 0, Ease{0.3, 0, 0.7, 1}), key(1, 1)}, Interpolation::linear)));
    EXPECT_FALSE(may_leave_keys(track_of(swinging, Interpolation::step, Extrapolation::continued, Extrapolation::continued)));
    EXPECT_TRUE(may_leave_keys(track_of(swinging, Interpolation::linear)));
    EXPECT_TRUE(may_leave_keys(track_of(keys, Interpolation::linear, Extrapolation::continued)));
    EXPECT_TRUE(may_leave_keys(track_of(keys, Interpolation::linear, Extrapolation::hold, Extrapolation::continued)));
    EXPECT_TRUE(may_leave_keys(track_of(keys, Interpolation::cubic)));
}

TEST(TrackExtremes, AComponentIsTheTrackOfItsNumbers) {
    Track<glm::dvec2> pairs;
    pairs.interpolation = Interpolation::cubic;
    pairs.after = Extrapolation::continued;
    pairs.keys = {{0, {1, 2}, Ease{0.1, 0.2, 0.3, 0.4}, {3, 4}, {5, 6}}, {1, {7, 8}, {}, {9, 10}, {11, 12}}};
    const Track<double> second = component_of(pairs, 1);
    for (const double time : {-1.0, 0.25, 0.5, 1.0, 3.0}) EXPECT_EQ(evaluate(second, time), evaluate(pairs, time).y) << time;
}

// ---- Any track ----

double number(double low, double high) { return low + (high - low) * (*rc::gen::inRange(0, 1000001)) * 1e-6; }

Track<double> any_track() {
    Track<double> track;
    const int count = *rc::gen::inRange(2, 6);
    double time = number(-2, 2);
    for (int i = 0; i < count; ++i) {
        Key<double> made = key(time, number(-5, 5), {}, number(-20, 20), number(-20, 20));
        if (*rc::gen::inRange(0, 2)) made.ease = Ease{number(0, 1), number(-2, 3), number(0, 1), number(-2, 3)};
        track.keys.push_back(made);
        time += number(0.1, 2);
    }
    track.interpolation = *rc::gen::element(Interpolation::linear, Interpolation::smooth, Interpolation::cubic);
    const auto end = [] { return *rc::gen::element(Extrapolation::hold, Extrapolation::repeat, Extrapolation::pingpong, Extrapolation::continued); };
    track.before = end(), track.after = end();
    track.overshoot = *rc::gen::inRange(0, 2) != 0;
    return track;
}

RC_GTEST_PROP(TrackExtremesProperty, NoSampleLiesBeyondThemAndTheyAreReached, ()) {
    const Track<double> track = any_track();
    const double begin = number(-8, 8), end = begin + number(0, 10);
    const Extremes extremes = extremes_of(track, begin, end);
    // Eases are solved to 1e-15 in x, which their slopes of up to some thousands and the curves' magnify.
    constexpr double kNear = 1e-9;
    for (int i = 0; i <= 500; ++i) {
        const double value = evaluate(track, std::lerp(begin, end, i / 500.0));
        RC_ASSERT(value <= extremes.greatest.value + kNear);
        RC_ASSERT(value >= extremes.least.value - kNear);
    }
    for (const Extreme& extreme : {extremes.least, extremes.greatest}) {
        RC_ASSERT(extreme.time_s >= begin - kNear && extreme.time_s <= end + kNear);
        // Where a repeated span begins again the value before the jump is the extreme one.
        double nearest = std::abs(evaluate(track, extreme.time_s) - extreme.value);
        for (const double beside : {-1e-9, 1e-9}) nearest = std::min(nearest, std::abs(evaluate(track, extreme.time_s + beside) - extreme.value));
        RC_ASSERT(nearest < 1e-4);  // an ease may be steep there
    }
}

RC_GTEST_PROP(TrackZerosProperty, BetweenThemTheSignChangesInJumpsAlone, ()) {
    const Track<double> track = any_track();
    const double begin = number(-8, 8), end = begin + number(0, 1) * (track.keys.back().time_s - track.keys.front().time_s);
    const std::vector<double> zeros = zeros_of(track, begin, end), jumps = discontinuities(track, begin, end);
    RC_ASSERT(std::is_sorted(zeros.begin(), zeros.end()));
    constexpr double kNear = 1e-9;
    const auto any_within = [](const std::vector<double>& times, double from, double to) {
        return std::any_of(times.begin(), times.end(), [&](double time) { return time >= from - kNear && time <= to + kNear; });
    };
    for (int i = 0; i < 500; ++i) {
        const double from = std::lerp(begin, end, i / 500.0), to = std::lerp(begin, end, (i + 1) / 500.0);
        if (evaluate(track, from) * evaluate(track, to) < 0) RC_ASSERT(any_within(zeros, from, to) || any_within(jumps, from, to));
    }
    for (const double zero : zeros) {
        RC_ASSERT(zero >= begin - kNear && zero <= end + kNear);
        RC_ASSERT(std::abs(evaluate(track, zero)) < 1e-4);  // an ease may be steep there
    }
}

RC_GTEST_PROP(TrackExtremesProperty, ATrackThatCannotLeaveItsKeysDoesNot, ()) {
    const Track<double> track = any_track();
    RC_PRE(!may_leave_keys(track));
    double least = track.keys[0].value, greatest = least;
    for (const Key<double>& made : track.keys) least = std::min(least, made.value), greatest = std::max(greatest, made.value);
    for (int i = 0; i <= 500; ++i) {
        const double value = evaluate(track, -10 + 0.05 * i);
        RC_ASSERT(value >= least - kRounding && value <= greatest + kRounding);
    }
}

}  // namespace
}  // namespace kadr
