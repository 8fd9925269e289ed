#include "render/render_job.h"

#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "base/error.h"
#include "output/frame_writer.h"
#include "output/image_io.h"
#include "render/fake_device.h"
#include "render/frame_identity.h"
#include "render/frame_memory.h"
#include "render/loaded_shot.h"
#include "render/tiny_shot.h"

namespace kadr {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kPng = "  frames: out/{name}.{frame:04}.png\n";
constexpr const char* kExr = "  frames: out/{name}.{frame:04}.exr\n";

class RenderJobTest : public testing::Test {
protected:
    void SetUp() override {
        fake_device() = {};
        interrupt_requested() = false;
        use(kPng);
        events_.frame_done = [this](const FrameReport& report) { reports_.push_back(report); };
        events_.warning = [this](const Diagnostic& warning) { warnings_.push_back(warning.found); };
    }
    void TearDown() override { interrupt_requested() = false; }
    void use(const std::string& output) { options_.shot = write_tiny_shot(folder_.path(), output); }
    RenderSummary run() {
        reports_.clear();
        fake_device().renders = 0;
        return render_shot(options_, events_);
    }
    fs::path file(const std::string& name) const { return folder_.path() / "out" / name; }
    std::vector<int> done() const {
        std::vector<int> frames;
        for (const FrameReport& report : reports_) frames.push_back(report.frame);
        return frames;
    }
    /// Names in the output folder that are not frames.
    std::vector<std::string> leftovers() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_.path() / "out"))
            if (entry.path().filename().string().rfind(".kadr", 0) == 0) names.push_back(entry.path().filename());
        return names;
    }

    TemporaryFolder folder_;
    RenderOptions options_;
    RenderEvents events_;
    std::vector<FrameReport> reports_;
    std::vector<std::string> warnings_;
};

TEST_F(RenderJobTest, RendersEveryFrameInOrder) {
    const RenderSummary summary = run();
    EXPECT_EQ(summary.frames, 4);
    EXPECT_EQ(summary.reused, 0);
    EXPECT_EQ(summary.device_why, "a test asked for it");
    EXPECT_EQ(summary.pixel_samples, 4u * 12 * 8 * 4);
    EXPECT_THAT(done(), ElementsAre(0, 1, 2, 3));
    for (const char* name : {"tiny.0000.png", "tiny.0001.png", "tiny.0002.png", "tiny.0003.png"})
        EXPECT_TRUE(fs::exists(file(name))) << name;
    EXPECT_TRUE(leftovers().empty());
}

TEST_F(RenderJobTest, SaysInTheFileWhatItIs) {
    run();
    Metadata metadata = image_io().read_metadata(file("tiny.0003.png"));
    EXPECT_EQ(metadata["shot"], "tiny");
    EXPECT_EQ(metadata["frame"], "3");
    EXPECT_EQ(metadata["time"], "0.125");
    EXPECT_EQ(metadata["samples"], "4");
    EXPECT_EQ(metadata["device"], "fake") << "neither threads nor lanes";
    EXPECT_EQ(metadata["settings"].size(), 32u);
}

TEST_F(RenderJobTest, TheErrorOfAFrameIsReadFromItsFile) {
    fake_device().noise = 0.1f;
    const RenderSummary summary = run();
    double sum = 0;
    for (const char* name : {"tiny.0000.png", "tiny.0001.png", "tiny.0002.png", "tiny.0003.png"}) sum += stored_relmse(file(name));
    ASSERT_TRUE(summary.relmse && *summary.relmse > 0);
    EXPECT_NEAR(sum / 4, *summary.relmse, 1e-3 * *summary.relmse);  // files hold four digits
    fake_device().noise = 0;
    options_.overwrite = true;
    run();
    EXPECT_EQ(stored_relmse(file("tiny.0000.png")), 0);
}

TEST_F(RenderJobTest, ReusesWhatIsComplete) {
    run();
    const RenderSummary again = run();
    EXPECT_EQ(again.reused, 4);
    EXPECT_EQ(fake_device().renders, 0);
    EXPECT_THAT(done(), ElementsAre(0, 1, 2, 3));
    EXPECT_TRUE(reports_[0].reused);
}

TEST_F(RenderJobTest, RendersAnewWhatIsMissingOrDamaged) {
    run();
    fs::remove(file("tiny.0001.png"));
    fs::resize_file(file("tiny.0002.png"), fs::file_size(file("tiny.0002.png")) / 2);
    EXPECT_EQ(run().reused, 2);
    EXPECT_EQ(fake_device().renders, 2);
}

TEST_F(RenderJobTest, RendersAnewWhenSettingsChange) {
    run();
    options_.overrides.samples = 8;
    EXPECT_EQ(run().reused, 0);
    options_.overrides.set = {{"view.exposure", "1"}};
    EXPECT_EQ(run().reused, 0) << "a display-referred file depends on the view";
}

TEST_F(RenderJobTest, LinearFilesDoNotDependOnTheView) {
    use(kExr);
    run();
    options_.overrides.set = {{"view.exposure", "1"}};
    EXPECT_EQ(run().reused, 4);
}

TEST_F(RenderJobTest, NeitherTheRangeNorCommentsNorThreadsChangeAFrame) {
    run();
    options_.overrides.frames = "1-2";
    options_.device.threads = 7;
    std::ofstream(options_.shot, std::ios::app) << "# a comment\n";
    EXPECT_EQ(run().reused, 2);
    EXPECT_THAT(done(), ElementsAre(1, 2));
}

TEST_F(RenderJobTest, AssetsChangeAFrame) {
    run();
    std::ofstream(folder_.path() / "triangle.gltf", std::ios::app) << "\n";
    EXPECT_EQ(run().reused, 0);
}

TEST_F(RenderJobTest, OverwriteRendersAll) {
    run();
    options_.overwrite = true;
    EXPECT_EQ(run().reused, 0);
}

TEST_F(RenderJobTest, InterruptKeepsCompleteFrames) {
    fake_device().before_render = [](int render) {
        if (render == 2) interrupt_requested() = true;
    };
    EXPECT_THROW(run(), Interrupted);
    EXPECT_THAT(done(), ElementsAre(0, 1));
    EXPECT_TRUE(fs::exists(file("tiny.0001.png")));
    EXPECT_FALSE(fs::exists(file("tiny.0002.png")));
    EXPECT_TRUE(leftovers().empty());
    interrupt_requested() = false;
    fake_device().before_render = {};
    EXPECT_EQ(run().reused, 2);
}

TEST_F(RenderJobTest, AFailingDeviceEndsTheRunAndKeepsCompleteFrames) {
    fake_device().before_render = [](int render) {
        if (render == 1) throw RenderError("the device fell over");
    };
    EXPECT_THROW(run(), RenderError);
    EXPECT_THAT(done(), ElementsAre(0));
}

TEST_F(RenderJobTest, TheNextFrameIsStagedWhileOneRenders) {
    // The schedule is a thread: give it time to have the next frame.
    fake_device().before_render = [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(50)); };
    run();
    EXPECT_EQ(fake_device().set_frames, 4);
    EXPECT_EQ(fake_device().staged, 3);
}

/// Several devices render the shot.
class Farm : public RenderJobTest {
protected:
    void SetUp() override {
        RenderJobTest::SetUp();
        fake_device().devices = 2;
    }
    std::vector<float> pixels(int frame) const { return image_io().read(file(fmt::format("tiny.{:04}.png", frame))).pixels; }
};

TEST_F(Farm, FramesAreDealtOutAndDeliveredInOrder) {
    options_.overrides.frames = "0-11";
    std::mutex mutex;
    std::map<int, std::vector<int>> frames;
    fake_device().on_frame = [&](int device, int frame) {
        {
            const std::lock_guard lock(mutex);
            frames[device].push_back(frame);
        }
        // The first one is slow: those after it are done before it.
        std::this_thread::sleep_for(std::chrono::milliseconds(frame == 0 ? 100 : 10));
    };
    const RenderSummary summary = run();
    EXPECT_EQ(summary.device, "fake (no lanes, 1 threads) and other (no lanes, 1 threads)");
    EXPECT_THAT(done(), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
    EXPECT_EQ(summary.pixel_samples, 12u * 12 * 8 * 4);
    EXPECT_EQ(fake_device().renders, 12);
    EXPECT_EQ(frames.size(), 2u);
    std::set<std::string> names;
    for (const FrameReport& report : reports_) names.insert(report.device_name);
    EXPECT_THAT(names, ElementsAre("fake (no lanes, 1 threads)", "other (no lanes, 1 threads)"));
    std::vector<std::vector<float>> by_two;
    for (int frame = 0; frame < 12; ++frame) by_two.push_back(pixels(frame));
    // The same frames by one device.
    fake_device().devices = 1;
    options_.overwrite = true;
    run();
    for (int frame = 0; frame < 12; ++frame) EXPECT_EQ(pixels(frame), by_two[static_cast<std::size_t>(frame)]) << frame;
}

TEST_F(Farm, AFrameSaysWhichDeviceRenderedIt) {
    std::mutex mutex;
    std::map<int, int> device_of;
    fake_device().on_frame = [&](int device, int frame) {
        const std::lock_guard lock(mutex);
        device_of[frame] = device;
    };
    run();
    for (int frame = 0; frame < 4; ++frame)
        EXPECT_EQ(image_io().read_metadata(file(fmt::format("tiny.{:04}.png", frame)))["device"], device_of[frame] == 0 ? "fake" : "other");
}

TEST_F(Farm, OneThatFailsEndsTheRunByNameAndCompleteFramesStay) {
    options_.overrides.frames = "0-11";
    fake_device().on_frame = [&](int, int frame) {
        // Frame 3 fails at once; those before it, and those that the other device has begun, take their time.
        if (frame == 3) throw RenderError("the device fell over");
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    };
    try {
        run();
        FAIL();
    } catch (const RenderError& error) {
        EXPECT_THAT(error.what(), testing::MatchesRegex("(fake|other) \\(no lanes, 1 threads\\): the device fell over"));
    }
    const std::vector<int> frames = done();
    ASSERT_GE(frames.size(), 2u);  // a frame before it may have been taken by no device yet
    for (const int frame : frames) {
        EXPECT_NE(frame, 3);
        EXPECT_TRUE(fs::exists(file(fmt::format("tiny.{:04}.png", frame)))) << frame;
    }
    EXPECT_TRUE(leftovers().empty());
    fake_device().on_frame = {};
    EXPECT_EQ(run().reused, static_cast<int>(frames.size()));
}

TEST_F(Farm, AnInterruptEndsAllAndKeepsCompleteFrames) {
    options_.overrides.frames = "0-11";
    fake_device().on_frame = [&](int, int frame) {
        if (frame == 6) interrupt_requested() = true;
    };
    EXPECT_THROW(run(), Interrupted);
    EXPECT_TRUE(leftovers().empty());
    const std::vector<int> frames = done();
    EXPECT_LT(frames.size(), 12u);
    interrupt_requested() = false;
    fake_device().on_frame = {};
    EXPECT_EQ(run().reused, static_cast<int>(frames.size()));
}

TEST_F(Farm, AutomaticExposureIsMeteredOnce) {
    options_.overrides.set = {{"view.exposure", "auto"}};
    run();
    const std::vector<float> by_two = pixels(3);
    // Four frames, and the small one that is metered.
    EXPECT_EQ(fake_device().renders, 5);
    fake_device().devices = 1;
    options_.overwrite = true;
    run();
    EXPECT_EQ(pixels(3), by_two);
}

TEST_F(RenderJobTest, AnUnwritableFolderIsKnownBeforeTheFirstRay) {
    use("  frames: /dev/null/{name}.{frame:04}.png\n");
    try {
        run();
        FAIL() << "nothing was thrown";
    } catch (const RenderError& error) {
        EXPECT_STREQ(error.what(), "cannot write to the folder /dev/null: /dev/null is not a folder");
    }
    EXPECT_EQ(fake_device().renders, 0);
}

TEST_F(RenderJobTest, TheDeviceIsToldHowStructuresAreBuilt) {
    run();
    EXPECT_EQ(fake_device().build, (BuildSettings{BuildQuality::medium, BuildSettings::Robust::no}));
    options_.overrides.set = {{"render.build", "high"}, {"render.robust", "true"}};
    run();
    EXPECT_EQ(fake_device().build, (BuildSettings{BuildQuality::high, BuildSettings::Robust::required}));
}

TEST(LoadedShot, TexturesAreNoLargerThanTheShotAllows) {
    const auto largest = [](std::vector<std::pair<std::string, std::string>> set) {
        ShotOverrides overrides;
        overrides.set = std::move(set);
        const LoadedShot loaded(parse_shot(fs::path(KADR_SOURCE_DIR) / "shots/turntable.yaml", overrides));
        int side = 0;
        for (const TextureData& texture : loaded.scene().textures) {
            side = std::max({side, texture.width, texture.height});
            EXPECT_EQ(texture.texels.size() % (static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height) * 4), 0u);
        }
        return side;
    };
    EXPECT_GT(largest({}), 16);
    EXPECT_EQ(largest({{"render.texture_limit", "16 px"}}), 16);
}

TEST_F(RenderJobTest, MetersTheShotsFirstFrameWhateverIsRendered) {
    options_.overrides.set = {{"view.exposure", "auto"}};
    run();
    const Image whole = image_io().read(file("tiny.0003.png"));
    options_.overwrite = true;
    options_.overrides.frames = "3";
    run();
    EXPECT_EQ(image_io().read(file("tiny.0003.png")).pixels, whole.pixels);
}

/// A shot of three frames in which the triangle, and from frame 1 on the camera too, are shaken at odd times.
std::string shaken_shot(const std::string& render) {
    return "kadr: 1\nname: shaken\ntiming: { fps: 1, frames: 0-2 }\nimage: { size: [12, 8] }\n"
           "scenes:\n  - id: triangle\n    gltf: triangle.gltf\n"
           "    transform: { translate: { keys: { 0 s: [0, 0, 0], 0.2371 s: [1, 0, 0], 0.6113 s: [-1, 0, 0], 1 s: [0, 0, 0] }, after: repeat } }\n"
           "camera: { position: { keys: { 1 s: [0, 0, 4], 1.1371 s: [3, 0, 4], 1.3113 s: [-3, 0, 4], 2 s: [0, 0, 4] } }, look_at: [0, 0, 0] }\n"
           "environment: { color: [1, 1, 1] }\nshutter: { angle: 360 deg }\n"
           "output: { frames: \"out/{frame}.png\" }\nrender: { motion_tolerance: 0.001 px, " + render + " }\n";
}

TEST_F(RenderJobTest, WarnsOnceOfEveryThingThatStrays) {
    const auto warnings_with = [&](const std::string& render) {
        write_text(folder_.path() / "shaken.yaml", shaken_shot(render));
        options_.shot = folder_.path() / "shaken.yaml";
        options_.overwrite = true;
        std::vector<Diagnostic> warnings;
        events_.warning = [&](const Diagnostic& warning) { warnings.push_back(warning); };
        const RenderSummary summary = run();
        EXPECT_EQ(summary.warnings.size(), warnings.size());
        return warnings;
    };
    const std::vector<Diagnostic> warnings = warnings_with("samples: 1");
    ASSERT_EQ(warnings.size(), 2u);
    for (const FrameReport& report : reports_) EXPECT_FALSE(report.motion.met());
    EXPECT_EQ(warnings[0].text(), fmt::format("warning: frame 0: node 'triangle/Triangle' strays {:.3g} px from its true path, more than render.motion_tolerance, 0.001 px\n"
                                              "  129 motion frames in each of 1 part of the shutter are not enough for it; close the shutter earlier, raise the tolerance, "
                                              "or render.samples: no part gets less than one",
                                              reports_[0].motion.largest_px()));
    EXPECT_THAT(warnings[1].found, HasSubstr("frame 1: the camera strays"));
    const std::vector<Diagnostic> split = warnings_with("samples: 2");
    ASSERT_FALSE(split.empty());
    EXPECT_THAT(split[0].expected, HasSubstr("in each of 2 parts of the shutter"));
    const std::vector<Diagnostic> fixed = warnings_with("samples: 2, motion_frames: 3");
    ASSERT_FALSE(fixed.empty());
    EXPECT_EQ(fixed[0].expected, "render.motion_frames is 3; take more, or `motion_frames: auto` for as many as the tolerance asks for");
}

// Setting a part builds structures: a steered frame begins each round with the part that is set.
TEST_F(RenderJobTest, RoundsGoForthAndBackThroughThePartsOfTheShutter) {
    write_text(folder_.path() / "shaken.yaml", shaken_shot("samples: { max_error: 1e-6, at_least: 8, at_most: 64 }"));
    options_.shot = folder_.path() / "shaken.yaml";
    options_.overrides.frames = "0";
    fake_device().noise = 1;
    run();
    const int parts = static_cast<int>(reports_.at(0).motion.parts);
    ASSERT_GT(parts, 1);
    constexpr int kRounds = 7;  // up to 8, 12, 16, 24, 32, 48 and 64 samples
    EXPECT_EQ(fake_device().set_frames, 1 + kRounds * (parts - 1));
    // Each part goes on in either half where it stopped, whatever came between.
    std::map<int, int> next;
    for (const Pass& pass : fake_device().passes) {
        EXPECT_EQ(pass.first_sample, next[pass.half]);
        next[pass.half] += pass.sample_count;
    }
    EXPECT_EQ(next[0], next[1]);
}

std::string bytes_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

class Videos : public RenderJobTest, public testing::WithParamInterface<const char*> {};

TEST_P(Videos, AResumedVideoEqualsAnUninterruptedOne) {
    use(GetParam());
    options_.overrides.video = (folder_.path() / "out/tiny.mkv").string();
    options_.overrides.set = {{"output.video.codec", "ffv1"}};
    run();
    const std::string whole = bytes_of(file("tiny.mkv"));
    ASSERT_GT(whole.size(), 100u);
    const char* extension = std::string(GetParam()).find("exr") != std::string::npos ? ".exr" : ".png";
    fs::remove(file(std::string("tiny.0002") + extension));
    fs::remove(file("tiny.mkv"));
    EXPECT_EQ(run().reused, 3);
    EXPECT_EQ(bytes_of(file("tiny.mkv")), whole);
}

INSTANTIATE_TEST_SUITE_P(Formats, Videos, testing::Values(kPng, kExr));

TEST_F(RenderJobTest, ADefaultVideoIsForShotsWithoutOne) {
    options_.default_video = (folder_.path() / "out/{name}.mkv").string();
    EXPECT_EQ(run().video, file("tiny.mkv"));
    EXPECT_TRUE(fs::exists(file("tiny.mkv")));
}

TEST_F(RenderJobTest, PreviewIsSmallAndNeverPassesForAFrame) {
    PreviewOptions preview;
    preview.render = options_;
    preview.frame = 2;
    preview.output = file("tiny.0002.png");
    const FrameReport report = render_preview(preview, events_);
    EXPECT_EQ(report.frame, 2);
    EXPECT_EQ(stored_settings_hash(file("tiny.0002.png")), "");
    EXPECT_EQ(run().reused, 0);
}

TEST_F(RenderJobTest, CheckFindsProblemsOfSeveralKindsAtOnceAndWritesNothing) {
    options_.overrides.output = "/dev/null/{name}.{frame}.png";
    options_.overrides.video = "/dev/null/tiny.mp4";
    options_.overrides.width = 13;
    options_.overrides.height = 9;
    try {
        check_shot(options_.shot, options_.overrides);
        FAIL() << "nothing was thrown";
    } catch (const InputError& error) {
        std::string all;
        for (const Diagnostic& problem : error.diagnostics()) all += problem.text() + "\n";
        EXPECT_THAT(all, HasSubstr("cannot write to the folder /dev/null"));
        EXPECT_THAT(all, HasSubstr("13"));
    }
    EXPECT_FALSE(fs::exists(folder_.path() / "out"));
}

TEST_F(RenderJobTest, PicturesBeyondTheMachineAreRefusedBeforeTheyAreBegun) {
    constexpr double kLargest_bytes = 65536.0 * 65536 * 72;  // of two halves, their counts, and two images
    if (machine_memory_bytes() == 0 || static_cast<double>(machine_memory_bytes()) > kLargest_bytes) GTEST_SKIP() << "this machine could render the largest picture";
    options_.overrides.width = options_.overrides.height = 65536;
    const auto refusal = [](const auto& task) {
        try {
            task();
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("nothing was thrown");
    };
    const std::string expected = "tiny.yaml: error: image.size is [65536, 65536]: a frame takes about 309.4 GB of memory, and this machine has ";
    EXPECT_THAT(refusal([&] { check_shot(options_.shot, options_.overrides); }), HasSubstr(expected));
    EXPECT_THAT(refusal([&] { render_shot(options_, events_); }), HasSubstr(expected));
    options_.overrides.set = {{"output.aovs", "[ depth ]"}};
    EXPECT_THAT(refusal([&] { check_shot(options_.shot, options_.overrides); }), AllOf(HasSubstr("378.2 GB"), HasSubstr("expected a smaller picture, or fewer output.aovs")));
}

}  // namespace
}  // namespace kadr
