// What a shutter's curve and a sensor that is read line by line do to things that move.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "device/rendered_frame.h"

namespace kadr::test {
namespace {

constexpr double kFrame_s = 1.0 / 24;

/// A bar that moves to the right through the origin at `speed` metres a second; its node is the scene's first.
GlowingStage moving_bar(double speed, double half_width, double half_height) {
    GlowingStage stage;
    const int bar = stage.add_node("Bar");
    stage.node(bar).scale = {half_width, half_height, 1};
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{-10, {-10 * speed, 0, 0}}, {10, {10 * speed, 0, 0}}});
    return stage;
}

/// Where the light of a row lies, in pixels from the image's middle.
double centre_of_row(const Image& image, int y) {
    double sum = 0, moment = 0;
    for (int x = 0; x < image.width; ++x) sum += image.at(x, y, 0), moment += image.at(x, y, 0) * (x + 0.5 - 0.5 * image.width);
    return moment / sum;
}

TEST(ShutterCurve, ATriangleShowsInTheBlur) {
    // A thin bar crosses the frame: a column's light is the curve's efficiency when the bar is there.
    for (const auto shape : {ShutterCurve::Shape::box, ShutterCurve::Shape::triangle}) {
        GlowingStage stage = moving_bar(2 * 24, 0.02, 1);
        stage.shot.shutter.curve.shape = shape;
        const Image image = render_frame(stage, 1024);
        const double px = stage.pixels_a_metre(), path_px = 2 * px;
        for (const int x : {36, 44, 48, 52, 60}) {
            const double fraction = (x + 0.5 - 32) / path_px;
            const double density = shape == ShutterCurve::Shape::box ? 1 : 2 * (1 - std::abs(2 * fraction - 1));
            double light = 0;
            for (int y = 20; y < 44; ++y) light += image.at(x, y, 0) / 24;
            // The bar covers 0.04 m of its way of 2 m. The samples of a pixel miss that by 0.004 (its edges in
            // 1024 samples of two dimensions), 24 pixels by 0.0008.
            EXPECT_NEAR(light, 0.02 * density, 0.0025) << "column " << x;
        }
    }
}

TEST(RollingShutter, ABarLeansByItsSpeedTimesTheDuration) {
    // Lines open in an instant, the last one 1/48 s after the first: 2 m a frame are 1 m from top to bottom.
    for (const auto& [direction, sign] : {std::pair{RollingShutter::Direction::down, 1.0}, {RollingShutter::Direction::up, -1.0}}) {
        GlowingStage stage = moving_bar(2 * 24, 0.2, 4);
        stage.shot.shutter = {0, 0, 0, 0, {}, {direction, kFrame_s / 2}};
        const Image image = render_frame(stage, 64);
        const int rows = image.height;
        for (const int y : {0, 13, 40, 63}) {
            const double line = sign > 0 ? (y + 0.5) / rows : 1 - (y + 0.5) / rows;
            EXPECT_NEAR(centre_of_row(image, y), line * 1.0 * stage.pixels_a_metre(), 0.1) << "row " << y;
        }
    }
}

TEST(RollingShutter, EveryLineHasTheWholeExposure) {
    // Open for half a frame, rolling over another half. Blur is as long as without rolling, and begins later the farther
    // down the line.
    GlowingStage stage = moving_bar(1.5 * 24, 0.25, 4);
    stage.shot.shutter = {0, 0.5, 0, 0, {}, {RollingShutter::Direction::down, kFrame_s / 2}};
    const Image image = render_frame(stage, 1024);
    for (const int y : {3, 32, 60}) {
        double light = 0;
        for (int x = 0; x < image.width; ++x) light += image.at(x, y, 0);
        EXPECT_NEAR(light, 0.5 * stage.pixels_a_metre(), 0.05);  // the bar's width: nothing is lost or counted twice
        EXPECT_NEAR(centre_of_row(image, y), 0.75 * (0.5 + (y + 0.5) / 64) * stage.pixels_a_metre(), 0.1) << "row " << y;
    }
}

TEST(RollingShutter, PartsOfASplitShutterCountForWhatTheirLinesSee) {
    // A step key half-way through the window: the upper lines see more of the first place. An opaque pixel stays opaque,
    // and at every line the two images' shares are those of the line's own time.
    GlowingStage stage;
    stage.size(32, 64, 2);
    stage.add_node("Square");
    stage.node(0).scale = {0.5, 8, 1};
    // Open for 0.5 frames, the last line opens 0.5 frames later; the step is at 0.4 frames.
    stage.shot.shutter = {0, 0.5, 0, 0, {}, {RollingShutter::Direction::down, kFrame_s / 2}};
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {-1, 0, 0}}, {0.4 * kFrame_s, {1, 0, 0}}}, Interpolation::step);
    ASSERT_EQ(stage.snapshots().size(), 2u);
    const Image image = render_frame(stage, 100);
    for (int y = 0; y < 64; ++y) {
        const double open = 0.5 * (y + 0.5) / 64, before = std::clamp((0.4 - open) / 0.5, 0.0, 1.0);
        for (const int channel : {0, 3}) {
            EXPECT_NEAR(image.at(8, y, channel), before, 1e-5) << "row " << y;
            EXPECT_NEAR(image.at(24, y, channel), 1 - before, 1e-5) << "row " << y;
        }
    }
    GlowingStage still = stage;
    still.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {-1, 0, 0}}, {0.4 * kFrame_s, {-1, 0.5, 0}}}, Interpolation::step);
    ASSERT_EQ(still.snapshots().size(), 2u);
    const Image opaque = render_frame(still, 100);
    for (int y = 0; y < 64; ++y) EXPECT_EQ(opaque.at(8, y, 3), 1.0f) << "row " << y;
}

TEST(StepKeys, LeaveTwoCrispImagesWithTheirShares) {
    // A third of the time here, two thirds there; 64 samples do not divide by three, their weights do.
    GlowingStage stage;
    stage.add_node("Square");
    stage.node(0).scale = glm::dvec3(0.5);
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {-1, 0, 0}}, {kFrame_s / 3, {1, 0, 0}}}, Interpolation::step);
    const Image image = render_frame(stage, 64);
    EXPECT_NEAR(image.at(16, 32, 3), 1.0 / 3, 1e-6);
    EXPECT_NEAR(image.at(48, 32, 3), 2.0 / 3, 1e-6);
    for (int x = 0; x < 64; ++x) {
        // Edges lie on pixel borders: 8 to 24 and 40 to 56. No pixel lies between the two images.
        const bool left = x >= 8 && x < 24, right = x >= 40 && x < 56;
        EXPECT_NEAR(image.at(x, 32, 3), left ? 1.0 / 3 : right ? 2.0 / 3 : 0.0, 1e-6) << "column " << x;
    }
}

}  // namespace
}  // namespace kadr::test
