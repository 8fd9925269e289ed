// The sequencer's paths against double-precision references at random times, and what does not depend on the frame rate.
#include <gtest/gtest.h>

#include <random>

#include "frame/key_grid.h"
#include "frame/snapshot_key.h"
#include "frame/stage.h"

namespace kadr::test {
namespace {

constexpr unsigned kSeed = 20240611;

/// A grandchild under two nodes that turn about different axes and are stretched unevenly: sheared throughout.
Stage composite(std::mt19937& random) {
    std::uniform_real_distribution<double> number(-1, 1);
    const auto vector = [&] { return glm::dvec3(number(random), number(random), number(random)); };
    Stage stage;
    stage.shot.image.width = 640;
    stage.shot.image.height = 360;
    int node = -1;
    for (int depth = 0; depth < 3; ++depth) {
        node = stage.add_node("Node" + std::to_string(depth), node, depth == 2);
        NodeChannels& channels = stage.animate(node);
        const glm::dvec3 axis = vector() + glm::dvec3(0, 0, 2);
        channels.rotation = track<glm::dquat>({{0, turn(120 * number(random), axis)}, {0.4, turn(120 * number(random), axis)}, {1, turn(30, axis)}});
        channels.translation = track<glm::dvec3>({{0, 0.3 * vector()}, {0.7, 0.3 * vector()}, {1, 0.3 * vector()}}, Interpolation::smooth);
        channels.scale = track<glm::dvec3>({{0, glm::dvec3(0.6) + 0.4 * vector()}, {1, glm::dvec3(0.6) + 0.4 * vector()}});
    }
    return stage;
}

TEST(PathProof, CompositesFollowTheirTruePathWithinTheTolerance) {
    std::mt19937 random(kSeed);
    for (int round = 0; round < 12; ++round) {
        const Stage stage = composite(random);
        for (const SceneSnapshot& part : stage.snapshots()) {
            ASSERT_EQ(part.instances.size(), 1u);
            EXPECT_EQ(part.motion.types[0], FrameType::matrix);
            const double tolerance = stage.shot.render.motion_tolerance_px, reported = part.motion.max_error_px;
            EXPECT_LE(worst_error_px(stage, part, 0, 2), tolerance) << "round " << round << ", seed " << kSeed;
            EXPECT_LE(reported, kMotionMargin * tolerance) << "round " << round << ", seed " << kSeed;
        }
    }
}

TEST(PathProof, VelocitiesAreThoseOfTheTruePath) {
    // A point of an orbiting, spinning body: its velocity by differences of the interpolated frames against those of the
    // exact path. Keys stray by at most the tolerance over a step of the grid, so the slope between keys is off by less
    // than four tolerances a step.
    Stage stage;
    const int arm = stage.add_node("Arm", -1, false), tip = stage.add_node("Tip", arm);
    stage.node(tip).translation = {1, 0, 0};
    stage.animate(arm).rotation = track<glm::dquat>({{0, turn(0)}, {1, turn(150)}});
    stage.animate(tip).rotation = track<glm::dquat>({{0, turn(0, {1, 1, 0})}, {1, turn(80, {1, 1, 0})}});
    const SceneSnapshot part = stage.snapshot();
    const BoundShot bound = stage.bind();
    const double metres_a_px = 5.0 / (0.5 * stage.shot.image.height / camera_at(bound, 0).tan_half_height);
    const double step = 1.0 / (part.motion.headers[0].frame_count - 1);
    const double slope = 4 * stage.shot.render.motion_tolerance_px * metres_a_px / step;
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> time(0.01, 0.99);
    for (int i = 0; i < 200; ++i) {
        const double t = time(random), h = 1e-4;
        const glm::dvec4 point(0.5, 0.5, 0.5, 1);
        const auto is = [&](double at) { return glm::dvec3(interpolate(part.motion, 0, at) * point); };
        const auto wanted = [&](double at) { return glm::dvec3(bound.node_transforms(at)[static_cast<std::size_t>(tip)] * point); };
        const glm::dvec3 speed = (is(t + h) - is(t - h)) / (2 * h), truth = (wanted(t + h) - wanted(t - h)) / (2 * h);
        EXPECT_LT(glm::distance(speed, truth), slope) << "at " << t << ", seed " << kSeed;
        EXPECT_GT(glm::length(truth), 10 * slope);  // or the line above would say nothing
    }
}

TEST(PathProof, TheSameShotAgreesAtEveryFrameRate) {
    // Frames of 24, 25, 30000/1001 and 120 a second meet at multiples of 1001 s; a shutter in seconds is then the same.
    Stage stage;
    stage.shot.shutter = {0, 0, -1.0 / 96, 1.0 / 96, {ShutterCurve::Shape::smooth, {}}, {RollingShutter::Direction::down, 0.004}};
    const int node = stage.add_node("Node");
    stage.animate(node).rotation = track<glm::dquat>({{1000.99, turn(0)}, {1001.003, turn(40)}, {1001.02, turn(110)}});
    stage.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {2000, {40, 3, 9}}});
    LightSpec light;
    light.strength = track<double>({{1000, 1.0}, {1001.001, 4.0}}, Interpolation::step);
    stage.shot.lights.push_back(light);
    std::vector<SceneSnapshot> reference;
    for (const auto& [fps, frame] : {std::pair{Rational{24, 1}, 24 * 1001}, {Rational{25, 1}, 25 * 1001}, {Rational{30000, 1001}, 30000}, {Rational{120, 1}, 120 * 1001}}) {
        stage.shot.timing.fps = fps;
        const std::vector<SceneSnapshot> parts = stage.snapshots(frame);
        if (reference.empty()) reference = parts;
        ASSERT_EQ(parts.size(), 2u);  // the light's step lies inside the shutter
        EXPECT_EQ(content_key(parts), content_key(reference)) << fps.numerator << "/" << fps.denominator;
        for (std::size_t i = 0; i < parts.size(); ++i) EXPECT_EQ(parts[i].geometry_key, reference[i].geometry_key);
    }
}

TEST(PathProof, SharesOfThePartsAddUp) {
    // Steps at random times, every curve, with and without rolling lines.
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> time(0.02, 0.98);
    using Shape = ShutterCurve::Shape;
    for (const Shape shape : {Shape::box, Shape::triangle, Shape::smooth, Shape::keys})
        for (const bool rolling : {false, true}) {
            Stage stage;
            stage.shot.shutter = {0, 0.5, 0, 0, {shape, {{0, 0.2}, {0.5, 1}, {1, 0}}}, {}};
            if (rolling) stage.shot.shutter.rolling = {RollingShutter::Direction::left, 0.5};
            stage.add_node("Node");
            std::vector<double> times{0, time(random), time(random), time(random), time(random)};
            std::sort(times.begin(), times.end());
            std::vector<std::pair<double, glm::dvec3>> keys;
            for (const double t : times) keys.push_back({t, {t, 0, 0}});
            stage.shot.scenes[0].transform.translate = track<glm::dvec3>(keys, Interpolation::step);
            double sum = 0;
            for (const SceneSnapshot& part : stage.snapshots()) {
                EXPECT_GE(part.weight, 0);
                sum += part.weight;
            }
            EXPECT_NEAR(sum, 1, 1e-12) << "shape " << static_cast<int>(shape) << ", seed " << kSeed;
        }
}

}  // namespace
}  // namespace kadr::test
