// Frames that repeat: rendered once, written every time, and said so.
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "output/image_io.h"
#include "render/fake_device.h"
#include "render/frame_cache.h"
#include "render/render_job.h"
#include "render/tiny_shot.h"

namespace kadr {
namespace {

using testing::ElementsAre;

/// A shot of six frames around one environment, the only thing that may change.
class StaticFrames : public testing::Test {
protected:
    void SetUp() override {
        fake_device() = {};
        events_.frame_done = [this](const FrameReport& report) { same_.push_back(report.same_as.value_or(-1)); };
    }
    RenderSummary run(const std::string& strength, const std::string& more = "") {
        write_text(folder_.path() / "triangle.gltf", triangle_gltf());
        write_text(folder_.path() / "still.yaml",
                   "kadr: 1\ntiming: { fps: 24, frames: 0-5 }\nimage: { size: [12, 8] }\nscenes: [ triangle.gltf ]\n"
                   "camera: { position: [0, 0, 4] }\noutput: { frames: \"out/{frame}.exr\" }\n"
                   "environment: { color: [1, 1, 1], strength: " + strength + " }\n" + more + "\n");
        options_.shot = folder_.path() / "still.yaml";
        same_.clear();
        fake_device().renders = 0;
        return render_shot(options_, events_);
    }
    Metadata metadata(int frame) const { return image_io().read_metadata(file(frame)); }
    std::filesystem::path file(int frame) const { return folder_.path() / "out" / (std::to_string(frame) + ".exr"); }

    TemporaryFolder folder_;
    RenderOptions options_;
    RenderEvents events_;
    std::vector<int> same_;
};

TEST_F(StaticFrames, AShotThatHoldsIsRenderedOnce) {
    const RenderSummary summary = run("1");
    EXPECT_EQ(fake_device().renders, 1);
    EXPECT_EQ(summary.frames, 6);
    EXPECT_EQ(summary.same, 5);
    EXPECT_EQ(summary.reused, 0);
    EXPECT_THAT(same_, ElementsAre(-1, 0, 0, 0, 0, 0));
    EXPECT_EQ(image_io().read(file(0)).pixels, image_io().read(file(5)).pixels);
    EXPECT_EQ(metadata(5).at("frame"), "5");
    EXPECT_EQ(metadata(5).at("same_as"), "0");
    EXPECT_EQ(metadata(0).count("same_as"), 0u);
    EXPECT_NE(metadata(0).at("settings"), metadata(5).at("settings"));
    // Files on disk come first: a second run renders nothing, and has nothing to compare with.
    EXPECT_EQ(run("1").reused, 6);
    EXPECT_EQ(fake_device().renders, 0);
}

TEST_F(StaticFrames, ALoopIsRenderedOnceRound) {
    run("{ keys: { 0 f: 1, 1 f: 2, 2 f: 1, 3 f: 2, 4 f: 3 }, interpolate: step }");
    EXPECT_EQ(fake_device().renders, 3);
    EXPECT_THAT(same_, ElementsAre(-1, -1, 0, 1, -1, 4));
}

TEST_F(StaticFrames, OnSeveralDevicesNothingIsRenderedTwice) {
    fake_device().devices = 3;
    // The one that the others repeat is still on its way.
    fake_device().on_frame = [](int, int) { std::this_thread::sleep_for(std::chrono::milliseconds(30)); };
    run("1");
    EXPECT_EQ(fake_device().renders, 1);
    EXPECT_THAT(same_, ElementsAre(-1, 0, 0, 0, 0, 0));
    std::filesystem::remove_all(folder_.path() / "out");
    run("{ keys: { 0 f: 1, 1 f: 2, 2 f: 1, 3 f: 2, 4 f: 3 }, interpolate: step }");
    EXPECT_EQ(fake_device().renders, 3);
    EXPECT_THAT(same_, ElementsAre(-1, -1, 0, 1, -1, 4));
}

TEST_F(StaticFrames, TheWholeWindowCountsNotItsOpening) {
    // Nothing has changed when the shutter of frame 2 opens, but something does before it closes.
    run("{ keys: { 0 f: 1, 2.3 f: 2 }, interpolate: step }", "shutter: { angle: 180 deg }");
    EXPECT_THAT(same_, ElementsAre(-1, 0, -1, -1, 3, 3));
}

TEST_F(StaticFrames, AnAnimatedSeedLooksDifferentEveryTime) {
    run("1", "render: { seed: { value: 3, animated: true } }");
    EXPECT_EQ(fake_device().renders, 6);
    EXPECT_THAT(same_, ElementsAre(-1, -1, -1, -1, -1, -1));
}

TEST_F(StaticFrames, CountTheirWorkOnce) {
    std::vector<FrameReport> reports;
    events_.frame_done = [&](const FrameReport& report) { reports.push_back(report); };
    fake_device().noise = 0.01f;
    const RenderSummary summary = run("{ keys: { 0 f: 1, 1 f: 2, 2 f: 1 }, interpolate: step }", "render: { samples: 4 }");
    ASSERT_EQ(reports.size(), 6u);
    EXPECT_EQ(summary.pixel_samples, 2u * 12 * 8 * 4);
    EXPECT_EQ(summary.same, 4);
    EXPECT_EQ(summary.stopped_by.begin()->second, 2);
    ASSERT_TRUE(summary.relmse);
    EXPECT_DOUBLE_EQ(*summary.relmse, 0.5 * (reports[0].sampling.error.relmse + reports[1].sampling.error.relmse));
    EXPECT_NE(reports[0].sampling.error.relmse, reports[1].sampling.error.relmse);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(reports[i].frame, static_cast<int>(i));
        EXPECT_EQ(reports[i].samples, 12u * 8 * 4) << i;                            // what the image has
        EXPECT_EQ(reports[i].device.pixel_samples, i < 2 ? 12u * 8 * 4 : 0u) << i;  // what was done for it
        EXPECT_EQ(reports[i].sampling.error.relmse, reports[i == 1 ? 1 : 0].sampling.error.relmse) << i;
        EXPECT_FALSE(reports[i].reused) << i;
    }
    EXPECT_EQ(image_io().read(file(1)).pixels == image_io().read(file(2)).pixels, false);
}

TEST_F(StaticFrames, AreSeenWithTheExposureOfTheirOwnTime) {
    options_.overrides.output = (folder_.path() / "out/{frame}.png").string();
    run("1", "view: { transform: none, exposure: { keys: { 0 f: 0, 2 f: 2 } } }");
    EXPECT_EQ(fake_device().renders, 1);
    EXPECT_THAT(same_, ElementsAre(-1, 0, 0, 0, 0, 0));
    const auto read = [&](int frame) { return image_io().read(folder_.path() / "out" / (std::to_string(frame) + ".png")); };
    const Image plain = read(0);
    constexpr float kStep = 1.0f / 255;  // half of one of the PNG, times the factor, and half of one
    for (const int frame : {1, 2, 5}) {
        const float factor = frame == 1 ? 2 : 4;
        const Image seen = read(frame);
        for (const int x : {0, 5, 11})
            EXPECT_NEAR(seen.at(x, 4, 0), std::min(1.0f, factor * plain.at(x, 4, 0)), 0.5f * (factor + 1) * kStep) << frame << ' ' << x;
        EXPECT_EQ(image_io().read_metadata(folder_.path() / "out" / (std::to_string(frame) + ".png")).at("exposure_stops"), frame == 1 ? "1" : "2");
    }
}

TEST_F(StaticFrames, AreSampledAnewWhereAnotherExposureShowsMoreOfTheirNoise) {
    run("1", "view: { exposure: { keys: { 0 f: 0, 2 f: 2, 3 f: 2, 4 f: 0 } } }\nrender: { samples: { max_error: 0.01 } }");
    EXPECT_THAT(same_, ElementsAre(-1, -1, -1, 2, 0, 0));
}

TEST(FrameCache, HoldsTheNewestFramesThatFit) {
    const auto frame = [](std::size_t floats) {
        RenderedFrame result;
        result.image.pixels.resize(floats);
        return std::make_shared<const RenderedFrame>(std::move(result));
    };
    FrameCache cache(4 * 100);
    const Hash a{1, 0}, b{2, 0}, c{3, 0};
    cache.keep(a, 1, frame(40));
    cache.keep(b, 2, frame(40));
    EXPECT_EQ(cache.find(a)->number, 1);  // now the more recent one
    cache.keep(c, 3, frame(40));
    EXPECT_TRUE(cache.find(a));
    EXPECT_FALSE(cache.find(b));
    EXPECT_TRUE(cache.find(c));
    cache.keep(b, 4, frame(1000));  // too large to fit, but the newest
    EXPECT_EQ(cache.find(b)->number, 4);
    EXPECT_FALSE(cache.find(a));
}

}  // namespace
}  // namespace kadr
