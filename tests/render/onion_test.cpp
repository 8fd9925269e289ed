#include "render/onion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "output/image_io.h"
#include "render/fake_device.h"
#include "render/render_job.h"
#include "render/tiny_shot.h"

namespace kadr {
namespace {

using testing::ElementsAre;

/// A row of grey pixels, one of them white.
Image row(int width, int white) {
    Image image{width, 1, {"R", "G", "B"}, std::vector<float>(3u * width, 0.25f)};
    for (int c = 0; c < 3; ++c) image.pixels[3u * white + c] = 1;
    return image;
}

std::vector<float> rgb(const Image& image, int x) { return {image.at(x, 0, 0), image.at(x, 0, 1), image.at(x, 0, 2)}; }

TEST(OnionTest, GroundIsExactAndGhostsCarryTheirTime) {
    const Image onion = overlay_frames({row(5, 0), row(5, 1), row(5, 2)}, true);
    EXPECT_EQ(rgb(onion, 3), std::vector<float>(3, 0.25f)) << "what never changes is untouched";
    EXPECT_EQ(rgb(onion, 4), std::vector<float>(3, 0.25f));
    // White under the tint t at the opacity o over the ground g: g + o (1 + 0.55 (t - 1) - g).
    const DisplayColor warm = ghost_color(0), cool = ghost_color(1);
    const auto ghost = [](float tint, float opacity) { return 0.25f + opacity * (1 + 0.55f * (tint - 1) - 0.25f); };
    EXPECT_NEAR(onion.at(0, 0, 0), ghost(warm.r, 0.5f), 1e-6);
    EXPECT_NEAR(onion.at(0, 0, 2), ghost(warm.b, 0.5f), 1e-6);
    EXPECT_NEAR(onion.at(2, 0, 0), ghost(cool.r, 0.9f), 1e-6);
    EXPECT_NEAR(onion.at(2, 0, 2), ghost(cool.b, 0.9f), 1e-6);
    EXPECT_GT(onion.at(0, 0, 0), onion.at(0, 0, 2)) << "early is warm";
    EXPECT_GT(onion.at(2, 0, 2), onion.at(2, 0, 0)) << "late is cool";
}

TEST(OnionTest, LaterLiesOverEarlier) {
    const std::vector<Image> frames{row(3, 0), row(3, 1), row(3, 1), row(3, 2), row(3, 0)};
    const Image onion = overlay_frames(frames, true);
    EXPECT_GT(onion.at(0, 0, 2), onion.at(0, 0, 0)) << "the last frame's cool ghost covers the first one's";
}

TEST(OnionTest, NoiseIsNoMotion) {
    Image noisy = row(3, 0);
    noisy.pixels[3 * 2] += 0.02f;
    const Image onion = overlay_frames({row(3, 0), row(3, 0), noisy}, true);
    EXPECT_EQ(rgb(onion, 2), std::vector<float>(3, 0.25f));
}

TEST(OnionTest, AMovingCameraGivesTheMean) {
    const Image onion = overlay_frames({row(4, 0), row(4, 1), row(4, 1), row(4, 2)}, false);
    EXPECT_FLOAT_EQ(onion.at(0, 0, 0), (1 + 3 * 0.25f) / 4);
    EXPECT_FLOAT_EQ(onion.at(1, 0, 1), (2 + 2 * 0.25f) / 4);
    EXPECT_FLOAT_EQ(onion.at(3, 0, 2), 0.25f);
}

TEST(OnionTest, OneFrameIsItself) { EXPECT_EQ(overlay_frames({row(3, 1)}, true).pixels, row(3, 1).pixels); }

class OnionPreviewTest : public testing::Test {
protected:
    void SetUp() override {
        fake_device() = {};
        interrupt_requested() = false;
        options_.kind = PreviewKind::onion;
        options_.render.shot = write_tiny_shot(folder_.path(), "  frames: out/{name}.{frame:04}.png\n");
        options_.output = folder_.path() / "onion.png";
    }
    FrameReport run() { return render_preview(options_, {}); }

    TemporaryFolder folder_;
    PreviewOptions options_;
};

TEST_F(OnionPreviewTest, OverlaysTheShot) {
    const FrameReport report = run();
    EXPECT_EQ(report.preview, "onion");
    EXPECT_THAT(report.frames, ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(report.note, "");
    Metadata metadata = image_io().read_metadata(options_.output);
    EXPECT_EQ(metadata["preview"], "onion");
    EXPECT_EQ(metadata.count("settings"), 0u);
}

TEST_F(OnionPreviewTest, SaysSoWhenTheCameraMoves) {
    options_.render.overrides.set = {{"camera.position", "{ keys: { 0 f: [0, 0, 4], 3 f: [1, 0, 4] } }"}};
    EXPECT_EQ(run().note, "the camera moves: this is the plain mean of the frames; see --path for its way");
}

TEST_F(OnionPreviewTest, KeepsTheNoiseOfOneSeed) {
    options_.render.overrides.set = {{"render.seed", "{ value: 3, animated: true }"}};
    run();
    EXPECT_EQ(image_io().read_metadata(options_.output)["seed"], "3");
}

TEST_F(OnionPreviewTest, RefusesMoreGhostsThanAnyoneCanTellApart) {
    options_.frames.emplace();
    for (int i = 0; i < 33; ++i) options_.frames->push_back(i);
    try {
        run();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.diagnostics().front().found, "--frames gives 33 frames to --onion");
        EXPECT_EQ(error.diagnostics().front().expected, "expected at most 32: take every nth, as in --frames 0-40x5");
    }
}

}  // namespace
}  // namespace kadr
