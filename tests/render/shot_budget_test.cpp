#include "render/shot_budget.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/shot_pilot.h"

namespace kadr {
namespace {

/// A machine that renders frames of known difficulty: the relative mean square error of n samples is difficulty / n.
struct Machine {
    std::vector<double> difficulty;          ///< [frame]
    double setup_s = 0.05, sample_s = 0.01;  ///< a frame; one sample of all its pixels
    double pilot_error = 0.1;                ///< spread of what a pilot says of a frame
    double pilot_bias = 1;                   ///< of what all of them say
    std::size_t pilots = 1000;               ///< at most
    std::function<double(std::size_t frame)> slowness = [](std::size_t) { return 1.0; };
};

struct Outcome {
    std::vector<double> relmse;  ///< [frame]
    double seconds = 0;
    /// Of the relative errors of two neighbours, the largest.
    double largest_step() const {
        double largest = 1;
        for (std::size_t i = 1; i < relmse.size(); ++i)
            largest =
                std::max(largest, std::sqrt(std::max(relmse[i], relmse[i - 1]) / std::min(relmse[i], relmse[i - 1])));
        return largest;
    }
    double spread() const {
        const auto [least, most] = std::minmax_element(relmse.begin(), relmse.end());
        return std::sqrt(*most / *least);
    }
};

FrameForecast pilot(const Machine& machine, std::size_t frame, std::mt19937& random) {
    std::normal_distribution<double> error(1, machine.pilot_error);
    const double difficulty = machine.difficulty[frame] * machine.pilot_bias * std::max(0.3, error(random));
    return {machine.setup_s,
            machine.sample_s,
            4,
            65536,
            {{4, difficulty / 4}, {16, difficulty / 16}, {64, difficulty / 64}}};
}

/// Renders all frames with a budget as FrameRenderer does: to the target, and no longer than it may.
Outcome render(const Machine& machine, double budget_s, unsigned seed = 1) {
    std::mt19937 random(seed);
    double now = 0;
    ShotBudget budget(budget_s, [&] { return now; });
    std::vector<PlannedFrame> frames(machine.difficulty.size());
    for (std::size_t i = 0; i < frames.size(); ++i) frames[i].number = static_cast<int>(i);
    std::size_t left = machine.pilots;
    for (const std::size_t i : coarse_to_fine(frames.size()))
        if (left-- > 0)
            frames[i].forecast = pilot(machine, i, random);
        else
            break;
    budget.plan(frames);
    Outcome outcome;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const FrameTarget target = *budget.begin(static_cast<int>(i));
        const double slowness = machine.slowness(i),
                     affordable = (target.most_s - machine.setup_s * slowness) / (machine.sample_s * slowness);
        const double wanted =
            target.relmse > 0 ? std::max(4.0, std::round(machine.difficulty[i] / target.relmse)) : 1e9;
        const double samples = std::max(4.0, std::min(wanted, 2 * std::floor(affordable / 2)));
        outcome.relmse.push_back(machine.difficulty[i] / samples);
        now += slowness * (machine.setup_s + machine.sample_s * samples);
        budget.end(outcome.relmse.back());
    }
    outcome.seconds = now;
    return outcome;
}

constexpr double kPass = 1.4;  // seconds of the machine's largest round, some 140 samples
constexpr double kNeighbours = 1.05;

/// Like neighbours, and the deadline: within 5 % and a pass, and not much of the time left over.
void expect_held(const Machine& machine, double budget_s, double least_share = 0.9) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        const Outcome outcome = render(machine, budget_s, seed);
        EXPECT_LE(outcome.largest_step(), kNeighbours) << "seed " << seed;
        EXPECT_LE(outcome.seconds, 1.05 * budget_s + kPass) << "seed " << seed;
        EXPECT_GE(outcome.seconds, least_share * budget_s) << "seed " << seed;
    }
}

std::vector<double> curve(std::size_t count, const std::function<double(double at)>& difficulty) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(difficulty(static_cast<double>(i) / static_cast<double>(count - 1)));
    return values;
}

TEST(ShotBudget, WithoutALimitHasNoTarget) {
    EXPECT_FALSE(ShotBudget(std::nullopt, [] { return 0.0; }).begin(3));
}

TEST(ShotBudget, WithoutAPilotFramesGetEqualShares) {
    double now = 0;
    ShotBudget budget(10.0, [&] { return now; });
    budget.plan({{0, false, {}}, {1, true, {}}, {2, false, {}}});
    EXPECT_EQ(budget.begin(0)->most_s, 5);
    EXPECT_EQ(budget.begin(0)->relmse, 0);
    now = 4;
    budget.end(0.1);
    EXPECT_EQ(budget.begin(2)->most_s, 6);
}

TEST(ShotBudget, AFrameAloneHasAllTheTime) {
    ShotBudget budget(10.0, [] { return 1.0; });
    budget.plan({{5, false, {}}});
    EXPECT_EQ(budget.begin(5)->most_s, 9);
}

TEST(ShotBudget, NeverGivesLessThanNothing) {
    double now = 0;
    ShotBudget budget(1.0, [&] { return now; });
    budget.plan({{0, false, {}}, {1, false, {}}});
    now = 5;
    EXPECT_EQ(budget.begin(0)->most_s, 0);
}

// The target of two equal frames is the error that half of the time is enough for: 100 samples each.
TEST(ShotBudget, TheTargetIsWhatTheTimeIsEnoughFor) {
    const FrameForecast forecast{0.5, 0.01, 4, 65536, {{4, 0.25}, {64, 0.25 / 16}}};
    ShotBudget budget(3.0, [] { return 0.0; });
    budget.plan({{0, false, forecast}, {1, false, forecast}});
    EXPECT_NEAR(budget.begin(0)->relmse, 1.0 / 100, 1e-4);
}

/// Two devices, each of which begins a frame as soon as it is free.
TEST(ShotBudget, SeveralDevicesShareTheTime) {
    constexpr double kBudget_s = 30;
    constexpr std::size_t kFrames = 24;
    const FrameForecast forecast{0.05, 0.01, 4, 65536, {{4, 0.25}, {64, 0.25 / 16}}};
    double now = 0, free_at[2] = {0, 0}, reached[2] = {0, 0};
    ShotBudget budget(kBudget_s, [&] { return now; }, 2);
    std::vector<PlannedFrame> frames;
    for (std::size_t i = 0; i < kFrames; ++i) frames.push_back({static_cast<int>(i), false, forecast});
    budget.plan(frames);
    std::vector<double> relmse;
    for (std::size_t i = 0; i < kFrames; ++i) {
        const std::size_t device = free_at[0] <= free_at[1] ? 0 : 1;
        now = free_at[device];
        if (reached[device] > 0) budget.end(reached[device], device);
        const FrameTarget target = *budget.begin(static_cast<int>(i), device);
        EXPECT_LE(target.most_s, 1.05 * kBudget_s - now);  // no frame has both devices
        const double samples = std::min(std::round(1 / target.relmse), (target.most_s - 0.05) / 0.01);
        reached[device] = 1 / samples;
        relmse.push_back(reached[device]);
        free_at[device] = now + 0.05 + 0.01 * samples;
    }
    const auto [least, most] = std::minmax_element(relmse.begin(), relmse.end());
    EXPECT_LE(std::sqrt(*most / *least), kNeighbours);
    // Twelve frames on each device, so 2.5 s a frame: 245 samples.
    EXPECT_NEAR(1 / relmse.front(), 245, 0.05 * 245);
    EXPECT_NEAR(std::max(free_at[0], free_at[1]), kBudget_s, 0.05 * kBudget_s);
}

/// A pilot on a machine that did something else took ten times too long.
TEST(ShotBudget, TheFirstFrameFindsOutWhatItTakes) {
    const double setup_s = 0.05, sample_s = 0.01;
    const FrameForecast slow{10 * setup_s, 10 * sample_s, 4, 65536, {{4, 0.25}, {64, 0.25 / 16}}};
    double now = 0;
    ShotBudget budget(21.0, [&] { return now; });
    budget.plan({{0, false, slow}, {1, false, slow}, {2, false, slow}, {3, false, slow}});
    std::vector<double> samples;
    for (int frame = 0; frame < 4; ++frame) {
        FrameTarget target = *budget.begin(frame);
        EXPECT_EQ(target.revise != nullptr, frame == 0);
        const double begin = now;
        now += setup_s + 4 * sample_s;
        double taken = 4;
        // Rounds that double, as far as the target asks for more.
        while (true) {
            if (target.revise) {
                const FrameTarget revised = target.revise(now - begin, 1 / taken);
                target.relmse = revised.relmse, target.most_s = revised.most_s;
            }
            const double round = std::min({taken, std::round(1 / target.relmse) - taken, std::floor((target.most_s - (now - begin)) / sample_s)});
            if (round < 1) break;
            taken += round, now += round * sample_s;
        }
        samples.push_back(taken);
        budget.end(1 / taken);
    }
    // 21 s are 4 * (0.05 + 0.01 * 520) s.
    for (const double each : samples) EXPECT_NEAR(each, 520, 0.05 * 520);
    EXPECT_NEAR(now, 21, 0.05 * 21);
}

TEST(ShotBudget, FramesThatAreFreeLeaveTheirTimeToOthers) {
    const FrameForecast forecast{0, 0.01, 4, 65536, {{4, 0.25}, {64, 0.25 / 16}}};
    ShotBudget budget(2.0, [] { return 0.0; });
    budget.plan({{0, false, forecast}, {1, true, {}}, {2, false, forecast}});
    EXPECT_NEAR(budget.begin(0)->relmse, 1.0 / 100, 1e-4);
}

TEST(ShotBudget, TheFirstFrameIsLikeThoseOfAnEarlierRun) {
    const FrameForecast forecast{0, 0.01, 4, 65536, {{4, 0.25}, {64, 0.25 / 16}}};
    const PlannedFrame kept{0, true, {}, 0.02}, unknown{0, true, {}}, ours{1, false, forecast}, next{2, false, forecast}, last{3, true, {}, 0.03};
    const auto first_target = [&](std::vector<PlannedFrame> frames) {
        ShotBudget budget(2.0, [] { return 0.0; });
        budget.plan(std::move(frames));
        return *budget.begin(1);
    };
    // The time is enough for 0.01; an error changes by a fiftieth a frame.
    const double step = ShotBudget::kDrift * ShotBudget::kDrift;
    EXPECT_NEAR(first_target({kept, ours, next}).relmse, 0.02 / step, 1e-9);
    EXPECT_FALSE(first_target({kept, ours, next}).revise);
    EXPECT_NEAR(first_target({unknown, ours, next, last}).relmse, 0.03 / step, 1e-9);
    EXPECT_NEAR(first_target({kept, ours, next, last}).relmse, 0.02 / step, 1e-9);
    EXPECT_NEAR(first_target({unknown, ours, next}).relmse, 0.01, 1e-4);
    EXPECT_TRUE(first_target({unknown, ours, next}).revise);
}

TEST(ShotBudget, EqualFramesEndAlike) {
    expect_held({curve(48, [](double) { return 1.0; })}, 48);
}

TEST(ShotBudget, SixFramesEndAlike) {
    expect_held({curve(6, [](double at) { return 1 + 0.3 * at; })}, 6, 0.85);
}

TEST(ShotBudget, ARampOfDifficultyEndsAlike) {
    expect_held({curve(96, [](double at) { return 0.3 + 3 * at; })}, 120);
    expect_held({curve(96, [](double at) { return 3.3 - 3 * at; })}, 120);
}

TEST(ShotBudget, AStepByTenEndsAlike) {
    const std::vector<double> up = curve(96, [](double at) { return at < 0.5 ? 0.4 : 4.0; });
    const std::vector<double> down = curve(96, [](double at) { return at < 0.7 ? 4.0 : 0.4; });
    for (const std::size_t pilots : {1000, 17}) {
        Machine machine{up};
        machine.pilots = pilots;
        SCOPED_TRACE(pilots);
        expect_held(machine, 200);
        machine.difficulty = down;
        expect_held(machine, 200);
    }
}

TEST(ShotBudget, OneHardFrameEndsLikeTheOthersWhetherItWasForeseenOrNot) {
    for (const std::size_t at : {0, 11, 20, 40, 47}) {
        std::vector<double> difficulty(48, 0.5);
        difficulty[at] = 5;
        Machine machine{difficulty};
        SCOPED_TRACE(at);
        expect_held(machine, 48);
        // Frames that nobody looked at are taken to be like their neighbours: some of the time may be left over.
        machine.pilots = 5;
        if (at != 40) expect_held(machine, 48, 0.6);
    }
}

// Every frame takes half as long again as its pilot said, and twice as long from the middle on.
TEST(ShotBudget, ForecastsThatAreOffAreMadeUpFor) {
    Machine machine{curve(96, [](double) { return 1.0; })};
    machine.pilot_bias = 0.67;
    expect_held(machine, 96);
    machine.pilot_bias = 1.5;
    expect_held(machine, 96, 0.85);
    machine.pilot_bias = 1;
    machine.slowness = [](std::size_t frame) { return frame < 48 ? 1.0 : 2.0; };
    expect_held(machine, 96);
    machine.slowness = [](std::size_t frame) { return frame % 3 == 0 ? 1.3 : 0.9; };
    expect_held(machine, 96);
}

// Nobody saw it coming, and nothing is left to make up for it: the deadline is what counts then.
TEST(ShotBudget, TheDeadlineHoldsWhereLikeFramesDoNot) {
    std::vector<double> difficulty(24, 0.5);
    difficulty[22] = 20;
    Machine machine{difficulty};
    machine.pilots = 4;
    const Outcome outcome = render(machine, 24);
    EXPECT_LE(outcome.seconds, 1.05 * 24 + kPass);
    EXPECT_GT(outcome.largest_step(), kNeighbours);
}

TEST(ShotBudget, LooksAtTheEndsAndTheMiddleFirst) {
    EXPECT_THAT(coarse_to_fine(9), testing::ElementsAre(0, 8, 4, 2, 6, 1, 3, 5, 7));
    EXPECT_THAT(coarse_to_fine(2), testing::ElementsAre(0, 1));
    EXPECT_THAT(coarse_to_fine(1), testing::ElementsAre(0));
    EXPECT_THAT(coarse_to_fine(0), testing::IsEmpty());
    EXPECT_EQ(coarse_to_fine(100).size(), 100u);
}

TEST(FrameForecast, SamplesFollowThePowerOfTheCurve) {
    const FrameForecast independent{0, 1, 2, 1000, {{4, 0.25}, {16, 0.0625}}};
    EXPECT_NEAR(independent.samples_for(0.125), 8, 1e-9);
    EXPECT_NEAR(independent.samples_for(0.01), 100, 1e-9);
    EXPECT_NEAR(independent.samples_for(0.5), 2, 1e-9);                // no fewer
    EXPECT_NEAR(independent.samples_for(1e-9), 1000, 1e-9);            // no more
    const FrameForecast sobol{0, 1, 1, 1e9, {{4, 1}, {16, 1.0 / 8}}};  // n^-1.5
    EXPECT_NEAR(sobol.samples_for(1.0 / 64), 64, 1e-9);
    EXPECT_EQ((FrameForecast{1, 2, 3, 4, {}}.seconds_for(0.1)), 1 + 2 * 3);
}

}  // namespace
}  // namespace kadr
