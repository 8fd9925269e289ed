// What parts of a rolling shutter are worth: the mean, over all lines, of the light that a line receives within the part.
#include <gtest/gtest.h>

#include "frame/stage.h"

namespace kadr::test {
namespace {

using Direction = RollingShutter::Direction;

/// A light that is switched at a time, so that the shutter is split there. Each line is open for half a second, the last
/// one half a second after the first: the window is 0 s to 1 s. Four rows, two columns.
Stage rolling_stage(Direction direction, double jump_s) {
    Stage stage;
    stage.shot.image = {2, 4, 1};
    stage.shot.shutter = {0, 0.5};
    stage.shot.shutter.rolling = {direction, 0.5};
    stage.shot.lights.emplace_back().strength = track<double>({{0, 1}, {jump_s, 2}}, Interpolation::step);
    return stage;
}

std::vector<double> weights_of(const Stage& stage) {
    std::vector<double> weights;
    for (const SceneSnapshot& part : stage.snapshots()) weights.push_back(part.weight);
    return weights;
}

TEST(RollingShutter, PartsWeighWhatTheirLinesReceive) {
    // Rows open at 1/16, 3/16, 5/16 and 7/16 s. Until 1/4 s they receive 3/8 and 1/8 of their light, and nothing.
    for (const Direction direction : {Direction::down, Direction::up}) {
        const std::vector<double> weights = weights_of(rolling_stage(direction, 0.25));
        ASSERT_EQ(weights.size(), 2u);
        EXPECT_NEAR(weights[0], (3.0 / 8 + 1.0 / 8) / 4, 1e-12);
        EXPECT_NEAR(weights[1], 1 - (3.0 / 8 + 1.0 / 8) / 4, 1e-12);
    }
    // Columns open at 1/8 and 3/8 s: the first receives a quarter.
    for (const Direction direction : {Direction::right, Direction::left}) EXPECT_NEAR(weights_of(rolling_stage(direction, 0.25)).at(0), 1.0 / 8, 1e-12);
    // Without rolling a part weighs what it lasts.
    Stage plain = rolling_stage(Direction::down, 0.125);
    plain.shot.shutter.rolling = {};
    EXPECT_NEAR(weights_of(plain).at(0), 0.25, 1e-12);
}

TEST(RollingShutter, PartsWeighWhatTheCurveLetsThrough) {
    Stage stage = rolling_stage(Direction::down, 0.25);
    stage.shot.shutter.curve.shape = ShutterCurve::Shape::triangle;  // twice the square, up to its middle
    const std::vector<double> weights = weights_of(stage);
    ASSERT_EQ(weights.size(), 2u);
    EXPECT_NEAR(weights[0], 2 * (9.0 / 64 + 1.0 / 64) / 4, 1e-12);
    EXPECT_NEAR(weights[0] + weights[1], 1, 1e-12);
}

TEST(RollingShutter, PartsKnowWhenTheirLinesOpen) {
    const std::vector<SceneSnapshot> parts = rolling_stage(Direction::down, 0.25).snapshots();
    ASSERT_EQ(parts.size(), 2u);
    // In units of the part: the first line opened 0.25 s before the second part, which lasts 0.75 s.
    EXPECT_FLOAT_EQ(parts[0].shutter.first_open, 0);
    EXPECT_FLOAT_EQ(parts[0].shutter.delay, 2);
    EXPECT_FLOAT_EQ(parts[0].shutter.length, 2);
    EXPECT_FLOAT_EQ(parts[1].shutter.first_open, -1.0f / 3);
    EXPECT_FLOAT_EQ(parts[1].shutter.delay, 2.0f / 3);
    EXPECT_FLOAT_EQ(parts[1].shutter.length, 2.0f / 3);
    EXPECT_EQ(parts[0].shutter.direction, kernels::RollingDirection::down);
}

}  // namespace
}  // namespace kadr::test
