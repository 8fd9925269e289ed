#include "render/shot_pilot.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/environment_image.h"
#include "render/fake_device.h"
#include "render/loaded_shot.h"
#include "render/pilot_mask.h"
#include "render/tiny_shot.h"
#include "shot/shot_parser.h"

namespace kadr {
namespace {

/// The tiny shot, four frames that grow lighter, at another size; a clock that a pass of the fake device moves on.
class ShotPilotTest : public testing::Test {
protected:
    void SetUp() override {
        fake_device() = {};
        fake_device().noise = 0.001f;
        fake_device().before_render = [this](int) { now_ += 0.01; };
    }
    LoadedShot load(const std::string& size, const std::string& strength = "") {
        ShotOverrides overrides;
        overrides.set.emplace_back("image.size", size);
        overrides.set.emplace_back("render.samples", "4096");
        if (!strength.empty()) overrides.set.emplace_back("environment.strength", strength);
        return LoadedShot(parse_shot(write_tiny_shot(folder_.path(), "  frames: a.{frame:04}.png\n"), overrides));
    }
    std::vector<PlannedFrame> plan(
        const LoadedShot& loaded, double budget_s,
        const std::function<std::optional<double>(const FrameTime&)>& there = [](const FrameTime&) { return std::optional<double>(); }) {
        FrameRenderer renderer(*device_, [this] { return now_; });
        return pilot_frames(
            {loaded.bound(), loaded.bound().timing().frames, there, {}, budget_s, [this] { return now_; }}, renderer,
            statistics_);
    }
    static std::vector<bool> of(const std::vector<PlannedFrame>& frames, bool (*what)(const PlannedFrame&)) {
        std::vector<bool> all;
        for (const PlannedFrame& frame : frames) all.push_back(what(frame));
        return all;
    }
    static bool is_free(const PlannedFrame& frame) { return frame.free; }
    static bool is_known(const PlannedFrame& frame) { return frame.forecast.has_value(); }

    TemporaryFolder folder_;
    double now_ = 0;
    DeviceStatistics statistics_;
    std::unique_ptr<Device> device_ = make_device({}).device;
};

TEST_F(ShotPilotTest, LooksAtAFewPixelsOfEveryFrame) {
    const std::vector<PlannedFrame> frames = plan(load("[96, 64]"), 1000);
    EXPECT_THAT(of(frames, is_known), testing::Each(true));
    EXPECT_THAT(of(frames, is_free), testing::Each(false));
    // But for the first round of one frame, which tells how far that is from a whole one: two halves.
    EXPECT_EQ(std::count_if(fake_device().passes.begin(), fake_device().passes.end(), [](const Pass& pass) { return !pass.active; }), 2);
}

/// The first frame of a budget asks for its target after each of its rounds, and ends at the one that it is told last.
TEST_F(ShotPilotTest, AFrameWhoseTargetIsRevisedFollowsIt) {
    const LoadedShot loaded = load("[32, 32]");
    FrameRenderer renderer(*device_, [this] { return now_; });
    load_device(*device_, loaded);
    std::vector<double> reached;
    FrameTarget target{1e9, 1e9, {}};  // as it stands, one round is enough
    target.revise = [&](double, double relmse) {
        reached.push_back(relmse);
        return FrameTarget{reached.front() / 16, 1e9, {}};
    };
    FrameRequest request;
    request.target = target;
    const RenderedFrame frame = renderer.render(loaded.bound(), loaded.bound().sequence().frame(0), request);
    EXPECT_GE(reached.size(), 2u);
    EXPECT_GE(frame.sampling.mean, 2.0 * SampleSteering::kTimingRound);
    request.target->revise = {};
    EXPECT_EQ(renderer.render(loaded.bound(), loaded.bound().sequence().frame(0), request).sampling.mean, SampleSteering::kTimingRound);
}

TEST_F(ShotPilotTest, TheMaskMissesNoRowAndNoColumn) {
    for (const auto& [width, height] : {std::pair(96, 64), std::pair(320, 180), std::pair(1000, 3), std::pair(3, 1000),
                                        std::pair(1, 1), std::pair(40, 20)}) {
        const PilotMask mask = pilot_mask(width, height);
        std::vector<int> rows(static_cast<std::size_t>(height)), columns(static_cast<std::size_t>(width));
        int count = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (mask.active[static_cast<std::size_t>(y * width + x)] != 0)
                    ++rows[static_cast<std::size_t>(y)], ++columns[static_cast<std::size_t>(x)], ++count;
        EXPECT_EQ(count, mask.count);
        EXPECT_GE(count, std::min(width * height, 1024) * 0.9) << width << " x " << height;
        EXPECT_LE(count, std::max(1.1 * width * height / 32, 2200.0)) << width << " x " << height;
        if (width > 32 && height > 32) {
            EXPECT_THAT(rows, testing::Each(testing::Ge(1)));
            EXPECT_THAT(columns, testing::Each(testing::Ge(1)));
        }
    }
}

TEST_F(ShotPilotTest, ForecastsWhatTheFrameTakes) {
    const LoadedShot loaded = load("[40, 20]");  // 800 pixels: all of them
    const std::vector<PlannedFrame> frames = plan(loaded, 1000);
    ASSERT_TRUE(frames[0].forecast);
    // 4, 8, 16, ... up to 4096 samples; each round takes 0.01 s of the fake's time, the last one for 2048 samples.
    ASSERT_EQ(frames[0].forecast->curve.size(), 11u);
    EXPECT_EQ(frames[0].forecast->curve.front().samples, 4);
    EXPECT_EQ(frames[0].forecast->curve.back().samples, 4096);
    EXPECT_NEAR(frames[0].forecast->sample_s, 0.01 / 2048, 1e-12);
    EXPECT_GT(frames[3].forecast->curve.front().relmse,
              frames[0].forecast->curve.front().relmse);  // the fake's noise grows with the frame
    EXPECT_GT(statistics_.pixel_samples, 0u);
}

TEST_F(ShotPilotTest, StopsWhenItsShareIsSpent) {
    const std::vector<PlannedFrame> frames = plan(load("[40, 20]"), 0.2);  // 0.008 s, and rounds of 0.01 s
    EXPECT_EQ(frames[0].forecast->curve.back().samples, 16);
    EXPECT_FALSE(frames[1].forecast || frames[2].forecast || frames[3].forecast);
    EXPECT_NEAR(now_, 0.04, 1e-9);
}

TEST_F(ShotPilotTest, FramesThatAreThereOrComeAgainAreFree) {
    const LoadedShot still = load("[40, 20]", "1");
    EXPECT_THAT(of(plan(still, 1000), is_free), testing::ElementsAre(false, true, true, true));
    const LoadedShot changing = load("[40, 20]");
    const std::vector<PlannedFrame> frames =
        plan(changing, 1000, [](const FrameTime& time) { return time.number == 1 ? std::optional(0.02) : std::nullopt; });
    EXPECT_THAT(of(frames, is_free), testing::ElementsAre(false, true, false, false));
    EXPECT_THAT(of(frames, is_known), testing::ElementsAre(true, false, true, true));
}

TEST_F(ShotPilotTest, AFrameAloneNeedsNone) {
    const std::vector<PlannedFrame> frames = plan(load("[40, 20]", "1"), 1000);
    EXPECT_THAT(of(frames, is_known), testing::Each(false));
    EXPECT_EQ(now_, 0);
}

}  // namespace
}  // namespace kadr
