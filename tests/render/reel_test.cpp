// Reels from the file to the video, with the fake device: what is rendered, kept, mixed and refused.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "output/child_process.h"
#include "output/image_io.h"
#include "render/fake_device.h"
#include "render/reel_conform.h"
#include "render/reel_job.h"
#include "render/reel_plan.h"
#include "render/smoke.h"
#include "render/tiny_shot.h"

namespace kadr {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

#define SKIP_WITHOUT_FFMPEG() \
    if (!find_program("ffmpeg") || !find_program("ffprobe")) GTEST_SKIP() << "ffmpeg and ffprobe are not on the PATH"

/// A shot like tiny.yaml under another name: frames 0 to 3 at 24 fps, 12 x 8, which the fake device fills with gradients.
void write_shot(const fs::path& folder, const std::string& name, const std::string& timing, const std::string& size,
                const std::string& more = "") {
    write_text(folder / "triangle.gltf", triangle_gltf());
    write_text(folder / (name + ".yaml"),
               "kadr: 1\nname: " + name + "\ntiming: " + timing + "\nimage: { size: " + size + " }\n" +
                   "scenes:\n  - { id: triangle, gltf: triangle.gltf }\n"
                   "camera: { position: { keys: { 0 s: [0, 0, 4], 1 s: [1, 0, 4] } }, look_at: [0, 0, 0] }\n"
                   "environment: { color: [1, 1, 1], strength: 1 }\n"
                   "render: { samples: 4 }\noutput:\n  frames: out/{name}.{frame:04}.png\n" + more);
}

class ReelTest : public testing::Test {
protected:
    void SetUp() override {
        fake_device() = {};
        interrupt_requested() = false;
        previous_ = fs::current_path();
        fs::current_path(folder_.path());
        write_shot(folder_.path(), "a", "{ fps: 24, frames: 0-3 }", "[12, 8]");
        write_shot(folder_.path(), "b", "{ fps: 24, frames: 0-3 }", "[12, 8]");
        options_.shot = "reel.yaml";
        events_.frame_done = [this](const FrameReport& report) {
            reports_.push_back(report);
            if (on_done_) on_done_();
        };
        events_.shot_started = [this](const ShotStart& shot) { started_.push_back(shot.name); };
    }
    void TearDown() override {
        interrupt_requested() = false;
        fs::current_path(previous_);
    }
    void reel(const std::string& text) { write_text(folder_.path() / "reel.yaml", "kadr-reel: 1\n" + text); }
    ReelPlan plan(const ShotOverrides& overrides = {}) { return plan_reel("reel.yaml", overrides); }
    RenderSummary run() {
        reports_.clear();
        started_.clear();
        fake_device().renders = 0;
        return render_reel(options_, events_);
    }
    std::string refused(const ShotOverrides& overrides = {}) {
        try {
            check_reel("reel.yaml", overrides);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }
    std::vector<std::string> files(const fs::path& folder) const {
        std::vector<std::string> names;
        if (fs::exists(folder_.path() / folder))
            for (const auto& entry : fs::directory_iterator(folder_.path() / folder)) names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    }
    std::string bytes(const fs::path& file) const {
        std::ifstream stream(folder_.path() / file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    Image image(const fs::path& file) const { return image_io().read(folder_.path() / file); }

    TemporaryFolder folder_;
    fs::path previous_;
    RenderOptions options_;
    RenderEvents events_;
    std::vector<FrameReport> reports_;
    std::vector<std::string> started_;
    std::function<void()> on_done_;
};

constexpr const char* kNoVideo = "output: { video: none, frames: \"reel/{frame:02}.png\" }\n";

// --- The plan --------------------------------------------------------------------------------------------------------

TEST_F(ReelTest, CutsInWholeFrames) {
    reel("shots:\n  - { shot: a.yaml, in: 1 f, crossfade: 2 f }\n  - { shot: b.yaml, out: 0.13 s, hold: 1 f, fade_out: 1 f }\n");
    const ReelPlan made = plan();
    EXPECT_EQ(made.edit.cuts()[0].first, 1);
    EXPECT_EQ(made.edit.cuts()[0].count, 3);
    EXPECT_EQ(made.edit.cuts()[1].count, 3) << "0.13 s is 3.12 frames";
    EXPECT_EQ(made.edit.frame_count(), 3 + 4 - 2);
    EXPECT_THAT(made.sources[0].prepared.shot.timing.frames, ElementsAre(1, 2, 3));
    EXPECT_THAT(made.sources[1].prepared.shot.timing.frames, ElementsAre(0, 1, 2));
    EXPECT_TRUE(made.sources[0].own);
}

TEST_F(ReelTest, AShotOfAnotherRateIsRenderedAtTheReelsAndKeepsItsTimes) {
    write_shot(folder_.path(), "fast", "{ fps: 30, frames: 0-59 }", "[12, 8]");
    reel("fps: 24000/1001\nshots: [ { shot: fast.yaml, in: 15 f, out: 45 f } ]\n");
    const ReelPlan made = plan();
    const Shot& shot = made.sources[0].prepared.shot;
    EXPECT_FALSE(made.sources[0].own);
    EXPECT_EQ(shot.timing.fps, (Rational{24000, 1001}));
    // 0.5 s and 1.5 s at 23.976 fps: frames 11.988 and 35.96.
    EXPECT_EQ(made.edit.cuts()[0].first, 12);
    EXPECT_EQ(made.edit.cuts()[0].count, 24);
    const FrameTime time = Sequence(shot.timing, shot.shutter).frame(12);
    EXPECT_EQ(time.time, (Rational{1001, 2000})) << "exactly 12 * 1001 / 24000";
    EXPECT_EQ(shot.output.frames, std::vector<std::string>{(fs::current_path() / "output/reel/fast/fast.{frame:04}.png").string()});
}

TEST_F(ReelTest, HalfTheSpeedRendersTheFramesBetween) {
    reel("shots: [ { shot: a.yaml, speed: 0.5 } ]\n");
    const ReelPlan made = plan();
    EXPECT_EQ(made.sources[0].prepared.shot.timing.fps, (Rational{48, 1}));
    EXPECT_EQ(made.edit.frame_count(), 8);
}

TEST_F(ReelTest, AShotThatNumbersFromOneKeepsItsNumbers) {
    write_shot(folder_.path(), "one", "{ fps: 24, first: 1, frames: 1-4 }", "[12, 8]");
    reel("shots: [ { shot: one.yaml, in: 1 f } ]\n");
    EXPECT_EQ(plan().edit.cuts()[0].first, 2);
    EXPECT_TRUE(plan().sources[0].own);
}

TEST(FittedSize, KeepsTheShape) {
    const ImageSpec wide{1920, 1080, 1};
    EXPECT_EQ(fitted_size({640, 360, 1}, wide), wide);
    EXPECT_EQ(fitted_size({480, 320, 1}, wide), (ImageSpec{1620, 1080, 1}));
    EXPECT_EQ(fitted_size({1000, 250, 1}, wide), (ImageSpec{1920, 480, 1}));
    EXPECT_EQ(fitted_size({720, 576, 16.0 / 15}, wide), (ImageSpec{1440, 1080, 1})) << "4:3 as it is seen";
    EXPECT_EQ(fitted_size({1000, 1, 1}, {100, 100, 1}), (ImageSpec{100, 1, 1}));
}

TEST_F(ReelTest, CutsOfOneShotShareItsFramesUnlessTheirSettingsDiffer) {
    reel("shots:\n  - { shot: a.yaml, out: 2 f }\n  - { shot: a.yaml, in: 1 f }\n"
         "  - { shot: a.yaml, set: { render.samples: 9 } }\n  - { shot: a.yaml, set: { view.exposure: 1 } }\n");
    const ReelPlan made = plan();
    EXPECT_THAT(made.source_of, ElementsAre(0, 0, 1, 2));
    EXPECT_THAT(made.sources[0].prepared.shot.timing.frames, ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(made.sources[1].prepared.shot.output.frames.front(), testing::EndsWith("output/reel/a/a.{frame:04}.png"));
    EXPECT_THAT(made.sources[2].prepared.shot.output.frames.front(), testing::EndsWith("output/reel/a-2/a-2.{frame:04}.png"));
}

TEST_F(ReelTest, TheEditIsPrinted) {
    reel("shots:\n  - { shot: a.yaml, fade_in: 1 f, crossfade: 2 f }\n  - { shot: b.yaml, speed: 2, hold: 1 s }\n");
    EXPECT_EQ(edit_text(plan()),
              "reel reel: 28 frames, 1.167 s at 24 fps, 12x8\n"
              "       0    0.000 s  a                frames 0-3; fade in 1, cross-fade 2\n"
              "       2    0.083 s  b                frames 0-1; hold 24; rendered for the reel at 12 fps, 12x8\n");
}

struct Case {
    const char* shots;
    const char* message;
};

TEST_F(ReelTest, SaysWhatDoesNotFit) {
    const Case cases[] = {
        {"[ { shot: a.yaml, out: 1 s } ]", R"(reel.yaml:2:31: error: shots.0.out is 1 s, but the shot ends at 0.166667 s
    shots: [ { shot: a.yaml, out: 1 s } ]
                                  ^
  expected a time from 0 s to 0.166667 s (frames 0 to 3 at 24 fps))"},
        {"[ { shot: a.yaml, in: -1 f } ]", R"(reel.yaml:2:30: error: shots.0.in is -1 f, before the shot begins at 0 s
    shots: [ { shot: a.yaml, in: -1 f } ]
                                 ^
  expected a time from 0 s to 0.166667 s (frames 0 to 3 at 24 fps))"},
        {"[ { shot: a.yaml, in: 4 f } ]", R"(reel.yaml:2:30: error: shots.0.in is 4 f, but the shot ends at 0.166667 s
    shots: [ { shot: a.yaml, in: 4 f } ]
                                 ^
  expected a time from 0 s to 0.166667 s (frames 0 to 3 at 24 fps))"},
        {"[ { shot: a.yaml, in: 1 f, out: 1.2 f } ]",
         R"(reel.yaml:2:40: error: nothing is left of shots.0 between its in and its out point
    shots: [ { shot: a.yaml, in: 1 f, out: 1.2 f } ]
                                           ^
  expected at least one frame at 24 fps)"},
        {"[ { shot: a.yaml, crossfade: 5 f }, b.yaml ]",
         R"(reel.yaml:2:37: error: shots.0.crossfade is 5 f (5 frames), but shots.0 lasts 4 frames
    shots: [ { shot: a.yaml, crossfade: 5 f }, b.yaml ]
                                        ^
  expected at most 4 frames; a longer hold makes a shot last longer
reel.yaml:2:37: error: shots.0.crossfade is 5 f (5 frames), but shots.1 lasts 4 frames
    shots: [ { shot: a.yaml, crossfade: 5 f }, b.yaml ]
                                        ^
  expected at most 4 frames; a longer hold makes a shot last longer)"},
        {"[ { shot: a.yaml, fade_in: 3 f, crossfade: 2 f }, b.yaml ]",
         R"(reel.yaml:2:51: error: shots.0.crossfade (2 frames) begins before shots.0.fade_in (3 frames) has ended: shots.0 lasts 4 frames
    shots: [ { shot: a.yaml, fade_in: 3 f, crossfade: 2 f }, b.yaml ]
                                                      ^
  shorten one of the two, or let the shot last longer)"},
    };
    for (const Case& each : cases) {
        reel(std::string("shots: ") + each.shots + "\n" + kNoVideo);
        EXPECT_EQ(refused(), each.message) << each.shots;
    }
}

TEST_F(ReelTest, ProblemsOfSeveralShotsAndOfTheVideoComeTogether) {
    SKIP_WITHOUT_FFMPEG();
    write_text(folder_.path() / "worse.yaml", "kadr: 1\nscenes: [ triangle.gltf ]\ncamera: { look_at: triangle/Nose }\n");
    write_text(folder_.path() / "worst.yaml", "kadr: 1\nscenes: [ triangle.gltf ]\ncamera: { look_at: triangle/Ear }\n");
    reel("size: [13, 9]\nshots: [ worse.yaml, worst.yaml ]\noutput: { video: out/a.mp4 }\n");
    const std::string errors = refused();
    EXPECT_THAT(errors, HasSubstr("reel.yaml:4:18: error: size is 13 x 9, but 4:2:0 video (yuv420p) needs an even width and height\n"
                                  "    output: { video: out/a.mp4 }\n                     ^\n  use size: [14, 10], or output.video.pixel_format: yuv444p"));
    EXPECT_THAT(errors, HasSubstr("worse.yaml:3:"));
    EXPECT_THAT(errors, HasSubstr("worst.yaml:3:"));
    EXPECT_FALSE(fs::exists(folder_.path() / "out")) << "check writes nothing";
}

TEST_F(ReelTest, FramesBeyondTheReelAreRefused) {
    reel(std::string("shots: [ a.yaml, b.yaml ]\n") + kNoVideo);
    ShotOverrides overrides;
    overrides.frames = "2-8";
    EXPECT_EQ(refused(overrides), "error: --frames is 2-8\n  expected frames of the reel, which has 0 to 7");
}

TEST_F(ReelTest, PreviewSaysWhichShotToPreview) {
    reel("shots: [ { shot: a.yaml, crossfade: 2 f }, b.yaml ]\n");
    PreviewOptions preview;
    preview.render.shot = "reel.yaml";
    preview.frame = 2;
    try {
        refuse_reel_preview(preview);
        FAIL();
    } catch (const InputError& error) {
        const std::string folder = fs::current_path().string();
        EXPECT_EQ(std::string(error.what()), "error: 'reel.yaml' is a reel, and preview takes a shot\n  frame 2 of the reel shows `kadr preview " +
                                                 folder + "/a.yaml --frame 2` and `kadr preview " + folder +
                                                 "/b.yaml --frame 0`; `kadr render reel.yaml --frames 2 --video none` renders it");
    }
}

// --- Rendering -------------------------------------------------------------------------------------------------------

TEST_F(ReelTest, RendersItsShotsOnceAndThenOnlyMixes) {
    reel(std::string("shots: [ { shot: a.yaml, crossfade: 2 f }, b.yaml ]\n") + kNoVideo);
    const RenderSummary first = run();
    EXPECT_EQ(fake_device().renders, 8);
    EXPECT_EQ(first.shots, 2);
    EXPECT_EQ(first.frames, 8);
    EXPECT_EQ(first.reel_frames, 6);
    EXPECT_EQ(first.reel_s, 0.25);
    EXPECT_THAT(started_, ElementsAre("a", "b", "reel"));
    EXPECT_EQ(reports_.front().shot, "a");
    EXPECT_EQ(files("reel").size(), 6u);
    const RenderSummary again = run();
    EXPECT_EQ(fake_device().renders, 0);
    EXPECT_EQ(again.reused, 8);
    for (const FrameReport& report : reports_) EXPECT_TRUE(report.reused) << report.shot << " " << report.frame;
}

TEST_F(ReelTest, SharesFramesWithTheShotItself) {
    reel(std::string("shots: [ a.yaml, b.yaml ]\n") + kNoVideo);
    RenderOptions shot;
    shot.shot = "a.yaml";
    render_shot(shot, {});
    EXPECT_EQ(run().reused, 4);
    EXPECT_EQ(fake_device().renders, 4) << "b alone";
    fake_device().renders = 0;
    EXPECT_EQ(render_shot(shot, {}).reused, 4) << "and the other way round";
}

TEST_F(ReelTest, AChangedShotIsRenderedAnewAlone) {
    reel(std::string("shots: [ { shot: a.yaml, crossfade: 2 f }, b.yaml ]\n") + kNoVideo);
    run();
    std::ofstream("b.yaml", std::ios::app) << "view: { exposure: 1 }\n";
    EXPECT_EQ(run().reused, 4);
    EXPECT_EQ(fake_device().renders, 4);
    int kept = 0;
    for (const FrameReport& report : reports_) kept += report.shot == "reel" && report.reused;
    EXPECT_EQ(kept, 2) << "the reel's frames of a alone";
}

TEST_F(ReelTest, MixesTheMiddleOfACrossFade) {
    reel("blend: display\nshots: [ { shot: a.yaml, crossfade: 1 f }, { shot: b.yaml, in: 2 f } ]\n"
         "output: { video: none, frames: \"reel/{frame:02}.png\", png_bits: 16 }\n");
    run();
    const Image from = image("out/a.0003.png"), to = image("out/b.0002.png"), mix = image("reel/03.png");
    ASSERT_EQ(mix.pixels.size(), 12u * 8 * 3);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 12; ++x)
            for (int c = 0; c < 3; ++c)
                // Half a step of the 16 bits it is stored with.
                ASSERT_NEAR(mix.at(x, y, c), 0.5f * (from.at(x, y, c) + to.at(x, y, c)), 0.5 / 65535 + 1e-6) << x << " " << y;
    EXPECT_NE(from.pixels, to.pixels);
}

TEST_F(ReelTest, PutsBarsBesideAShotOfAnotherShape) {
    write_shot(folder_.path(), "square", "{ fps: 24, frames: 0-0 }", "[30, 30]");
    reel("bars: [0, 1, 0]\nsize: [12, 8]\nfps: 24\nshots: [ square.yaml ]\noutput: { video: none, frames: \"reel/{frame:02}.png\", shots: \"s/{shot}.{frame}.png\" }\n");
    run();
    EXPECT_EQ(image("s/square.0.png").width, 8);
    const Image picture = image("reel/00.png");
    EXPECT_EQ(picture.width, 12);
    for (const int x : {0, 1, 10, 11}) EXPECT_EQ(picture.at(x, 4, 1), 1) << x;
    EXPECT_EQ(picture.at(2, 4, 0), image("s/square.0.png").at(0, 4, 0));
}

TEST_F(ReelTest, LinearFramesGoThroughTheView) {
    write_shot(folder_.path(), "c", "{ fps: 24, frames: 0-1 }", "[12, 8]", "view: { exposure: auto }\n");
    const std::string png = bytes("c.yaml");
    reel(std::string("shots: [ c.yaml ]\n") + kNoVideo);
    run();
    const Image expected = image("reel/01.png");
    std::string text = png;
    text.replace(text.find(".png"), 4, ".exr");
    write_text("c.yaml", text);
    run();
    EXPECT_EQ(image("reel/01.png").pixels, expected.pixels);
    EXPECT_EQ(run().reused, 2) << "an exposure that is metered again is the same";
}

TEST_F(ReelTest, RendersWhatAPartNeeds) {
    reel(std::string("shots: [ a.yaml, { shot: b.yaml, hold: 4 f } ]\n") + kNoVideo);
    options_.overrides.frames = "9-10";
    const RenderSummary summary = run();
    EXPECT_EQ(fake_device().renders, 1) << "the last frame of b";
    EXPECT_EQ(summary.reel_frames, 2);
    EXPECT_THAT(files("reel"), ElementsAre("09.png", "10.png"));
}

TEST_F(ReelTest, AnInterruptKeepsCompleteFramesAndTheNextRunGoesOn) {
    SKIP_WITHOUT_FFMPEG();
    reel("shots: [ { shot: a.yaml, crossfade: 2 f }, b.yaml ]\noutput: { video: { file: out/reel.mkv, codec: ffv1 } }\n");
    run();
    const std::string whole = bytes("out/reel.mkv"), frame = bytes("out/b.0003.png");
    ASSERT_GT(whole.size(), 100u);
    fs::remove_all("out");
    fake_device().before_render = [](int render) {
        if (render == 6) interrupt_requested() = true;
    };
    EXPECT_THROW(run(), Interrupted);
    EXPECT_EQ(files("out").size(), 6u) << "no video, nothing half-written";
    fake_device().before_render = {};
    interrupt_requested() = false;
    EXPECT_EQ(run().reused, 6);
    EXPECT_EQ(image("out/b.0003.png").width, 12);
    EXPECT_EQ(bytes("out/reel.mkv"), whole);
}

TEST_F(ReelTest, AnInterruptWhileMixingLeavesNoVideo) {
    SKIP_WITHOUT_FFMPEG();
    reel("shots: [ a.yaml, b.yaml ]\noutput: { video: out/reel.mp4, frames: \"reel/{frame:02}.png\" }\n");
    on_done_ = [this] {
        if (reports_.back().shot == "reel" && reports_.back().frame == 2) interrupt_requested() = true;
    };
    EXPECT_THROW(run(), Interrupted);
    EXPECT_THAT(files("reel"), ElementsAre("00.png", "01.png", "02.png"));
    EXPECT_EQ(files("out").size(), 8u);
}

TEST_F(ReelTest, AFailingFfmpegLeavesTheImagesAndItsWords) {
    fs::create_directory("bin");
    write_text("bin/ffmpeg", "#!/bin/sh\ncase \"$*\" in\n*-encoders*) echo \" ------\"; echo \" V....D libx264  H.264\";;\n"
                             "*-h\\ encoder*) echo \"    Supported pixel formats: yuv420p\";;\n*) echo 'on fire' >&2; cat > /dev/null; exit 3;;\nesac\n");
    fs::permissions("bin/ffmpeg", fs::perms::owner_all);
    const std::string path = std::getenv("PATH");
    setenv("PATH", (fs::current_path().string() + "/bin:/usr/bin:/bin").c_str(), 1);
    setenv("KADR_CACHE", (fs::current_path() / "cache").c_str(), 1);
    reel("shots: [ a.yaml ]\noutput: { video: out/reel.mp4 }\n");
    try {
        run();
        ADD_FAILURE() << "nothing was thrown";
    } catch (const RenderError& error) {
        EXPECT_STREQ(error.what(), ("cannot write the video '" + (fs::current_path() / "out/reel.mp4").string() +
                                    "': ffmpeg failed (exit status 3); the images are kept\n  ffmpeg's last lines:\n    on fire").c_str());
    }
    setenv("PATH", path.c_str(), 1);
    unsetenv("KADR_CACHE");
    EXPECT_EQ(files("out").size(), 4u);
}

TEST_F(ReelTest, AFolderThatCannotBeWrittenToIsKnownBeforeTheFirstRay) {
    reel("shots: [ a.yaml ]\noutput: { video: none, frames: \"/dev/null/{frame}.png\" }\n");
    EXPECT_THROW(run(), RenderError);
    EXPECT_EQ(fake_device().renders, 0);
    EXPECT_THAT(refused(), HasSubstr("reel.yaml: error: cannot write to the folder /dev/null"));
}

TEST_F(ReelTest, SmokeChecksAReelAndRendersNothing) {
    reel(std::string("shots: [ a.yaml ]\n") + kNoVideo);
    SmokeOptions smoke_options;
    smoke_options.shots = {"reel.yaml"};
    const std::vector<SmokeCase> cases = smoke(smoke_options, [](const SmokeCase&) {});
    ASSERT_EQ(cases.size(), 1u);
    EXPECT_NE(cases[0].skipped, "");
    EXPECT_TRUE(cases[0].failures.empty());
    EXPECT_EQ(fake_device().renders, 0);
    EXPECT_THAT(junit_xml(cases), HasSubstr("<skipped message=\"a reel"));
    reel("shots: [ c.yaml ]\n");
    EXPECT_TRUE(smoke(smoke_options, [](const SmokeCase&) {})[0].bad_input);
}

}  // namespace
}  // namespace kadr
