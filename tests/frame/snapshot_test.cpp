#include "frame/snapshot.h"

#include <gmock/gmock.h>

#include "stage.h"

namespace kadr {
namespace {

using testing::ElementsAre;
using test::kPi;
using test::message_of;
using test::Stage;
using test::track;

TEST(Snapshot, SplitsTheShutterWhereSomethingJumps) {
    Stage stage;
    const int node = stage.add_node("a");
    stage.animate(node).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {0.25, {1, 0, 0}}, {0.5, {1, 0, 0}}}, Interpolation::step);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);  // nothing jumps at 0.5
    EXPECT_EQ(parts[0].close_s, 0.25);
    EXPECT_DOUBLE_EQ(parts[0].weight, 0.25);
    EXPECT_DOUBLE_EQ(parts[1].weight, 0.75);
    for (const SceneSnapshot& part : parts) EXPECT_EQ(part.motion.headers[0].frame_count, 1u);
    EXPECT_EQ(parts[0].motion.srt[0].translation[0], 0);
    EXPECT_EQ(parts[1].motion.srt[0].translation[0], 1);
    EXPECT_NE(parts[0].geometry_key, parts[1].geometry_key);
}

/// Where along x a cube is while the shutter of a frame is open: at the opening, half-way and at the closing.
std::vector<double> xs_of(const Stage& stage, int frame) {
    const std::vector<SceneSnapshot> parts = stage.snapshots(frame);
    std::vector<double> xs;
    for (const SceneSnapshot& part : parts)
        for (const double u : {0.0, 0.5, 1.0}) xs.push_back(interpolate(part.motion, 0, u)[3].x + part.render_origin.x);
    return xs;
}

TEST(Snapshot, AJumpAtTheClosingBelongsToTheNextFrame) {
    Stage stage;
    stage.add_node("cube");
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 0, 0}}, {2, {3, 0, 0}}}, Interpolation::step);
    EXPECT_THAT(xs_of(stage, 0), ElementsAre(0, 0, 0));
    EXPECT_THAT(xs_of(stage, 1), ElementsAre(1, 1, 1));
    // Whatever the key's time is rounded to.
    for (const double beside : {0.0, 2.0}) {
        stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {std::nextafter(1, beside), {1, 0, 0}}, {2, {3, 0, 0}}}, Interpolation::step);
        EXPECT_THAT(xs_of(stage, 0), ElementsAre(0, 0, 0));
        EXPECT_THAT(xs_of(stage, 1), ElementsAre(1, 1, 1));
    }
}

TEST(Snapshot, AJumpNearAnEndCountsAsAtItLateInAShot) {
    Stage stage;
    stage.add_node("cube");
    const double late_s = 1000001 - 5e-7;  // some thousand ulps from the closing: clips' times may be off by as much there
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {late_s, {1, 0, 0}}}, Interpolation::step);
    EXPECT_THAT(xs_of(stage, 1000000), ElementsAre(0, 0, 0));
    EXPECT_THAT(xs_of(stage, 1000001), ElementsAre(1, 1, 1));
}

TEST(Snapshot, SeamsOnTheShuttersEndsAreNotBlurred) {
    constexpr double kInset = 1e-5;  // of what moves 17 m in 17 frames: parts are looked at a ten-millionth inside of their ends
    const auto near = [](double x) { return testing::DoubleNear(x, kInset); };
    for (const double fps : {24.0, 25.0, 30.0}) {
        Stage stage;
        const int cube = stage.add_node("cube");
        stage.shot.timing.fps = {static_cast<std::int64_t>(fps), 1};
        Track<glm::dvec3> run = track<glm::dvec3>({{0, {0, 0, 0}}, {17 / fps, {17, 0, 0}}});
        Stage by_clip = stage;
        by_clip.animate(cube).translation = run;
        by_clip.shot.scenes[0].layers[0].loop = ClipLayer::Loop::repeat;
        by_clip.shot.scenes[0].layers[0].out_s = 17 / fps;
        run.after = Extrapolation::repeat;
        stage.shot.scenes[0].transform.translate = run;
        for (int pass = 1; pass <= 12; ++pass)
            for (const Stage* one : {&stage, &by_clip}) {
                EXPECT_THAT(xs_of(*one, 17 * pass), ElementsAre(near(0), near(0.5), near(1))) << pass << " at " << fps;
                EXPECT_THAT(xs_of(*one, 17 * pass - 1), ElementsAre(near(16), near(16.5), near(17))) << pass << " at " << fps;
            }
    }
}

TEST(Snapshot, SplitsForCamerasLightsAndSlowedClips) {
    Stage stage;
    stage.shot.scenes[0].layers[0].speed = 0.5;
    stage.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {0.25, {1, 0, 5}}}, Interpolation::step);
    LightSpec light;
    light.strength = track<double>({{0, 1}, {0.75, 2}}, Interpolation::step);
    stage.shot.lights.push_back(light);
    stage.animate(stage.add_node("a")).scale = track<glm::dvec3>({{0, {1, 1, 1}}, {0.25, {2, 2, 2}}}, Interpolation::step);  // 0.5 of the shot
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 4u);
    double weights = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        EXPECT_DOUBLE_EQ(parts[i].open_s, 0.25 * static_cast<double>(i));
        EXPECT_EQ(parts[i].camera_keys.size(), 1u);
        EXPECT_EQ(parts[i].light_keys.size(), 1u);
        weights += parts[i].weight;
    }
    EXPECT_DOUBLE_EQ(weights, 1);
    EXPECT_EQ(parts[2].light_keys[0].radiance.x, 1);
    EXPECT_EQ(parts[3].light_keys[0].radiance.x, 2);
    EXPECT_EQ(parts[1].motion.srt[0].scale[0], 1);
    EXPECT_EQ(parts[2].motion.srt[0].scale[0], 2);
}

TEST(Snapshot, SplitsForSpinsBeyondAHundredAndTwentyNineFrames) {
    Stage stage;
    const int node = stage.add_node("a");
    stage.shot.scenes[0].transform.rotate.axis_angle = RotationTrack::AxisAngle{{0, 1, 0}, track<double>({{0, 0}, {1, 8 * 2 * kPi}})};
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 4u);  // 2880 degrees; 1280 fit into 128 steps
    for (const SceneSnapshot& part : parts) EXPECT_LE(test::worst_error_px(stage, part, 0, node), 0.1 + 1e-3);
    stage.shot.scenes[0].transform.rotate.axis_angle->angle_rad = track<double>({{0, 0}, {1, 1000 * 2 * kPi}});
    EXPECT_EQ(message_of([&] { stage.snapshots(); }),
              "stage.yaml: error: something turns more than 200 times within the shutter of frame 0\n"
              "  expected a slower rotation or a shorter shutter");
}

TEST(Snapshot, KeepsItsGeometryKeyWhileNothingMoves) {
    Stage stage;
    stage.add_node("a");
    stage.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {4, {4, 0, 5}}});
    const SceneSnapshot first = stage.snapshot(0), second = stage.snapshot(1);
    EXPECT_EQ(first.geometry_key, second.geometry_key);  // the camera may move
    stage.animate(stage.add_node("b")).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {4, {1, 0, 0}}});
    EXPECT_NE(stage.snapshot(0).geometry_key, stage.snapshot(1).geometry_key);
}

TEST(Snapshot, FixedInstancesHoldTheirPlaceInTheWorldExactly) {
    Stage stage;
    const int node = stage.add_node("a");
    stage.node(node).translation = {1e7 + 0.123, 0, 0};
    stage.scene.geometries[0].scale = 2;
    stage.scene.geometries[0].centre = {0, 1, 0};
    stage.shot.camera.position = glm::dvec3(1e7, 0, 5);
    stage.shot.camera.look_at = Track<glm::dvec3>(glm::dvec3(1e7, 0, 0));
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_EQ(snapshot.fixed_places[0][3], glm::dvec4(1e7 + 0.123, 1, 0, 1));
    EXPECT_EQ(snapshot.fixed_places[0][0].x, 2);
    EXPECT_NE(snapshot.render_origin.x, 0);
    EXPECT_NEAR(snapshot.motion.srt[0].translation[0] + snapshot.render_origin.x, 1e7 + 0.123, 2e-5);  // half an ulp of 320 m
}

TEST(Snapshot, DefaultEnvironmentIsSkyOrBlackBesideLights) {
    Stage stage;
    EXPECT_FLOAT_EQ(stage.snapshot().environment.radiance.z, 0.92f);
    stage.shot.lights.resize(1);
    EXPECT_EQ(stage.snapshot().environment.radiance.z, 0);
    stage.shot.environment.given = true;
    stage.shot.environment.color = Track<glm::dvec3>(glm::dvec3(1, 2, 3));
    stage.shot.environment.strength = track<double>({{0, 1}, {1, 3}});
    EXPECT_FLOAT_EQ(stage.snapshot().environment.radiance.z, 6);  // the middle of the shutter
}

TEST(Snapshot, CarriesTheSettings) {
    Stage stage;
    stage.shot.image = {64, 32, 1};
    stage.shot.render.filter_width_px = 3;
    stage.shot.render.bounces = {5, 4, 3, 2};
    stage.shot.render.seed = 9;
    stage.shot.environment.visible = false;
    const kernels::Settings settings = stage.snapshot(0).settings;
    EXPECT_EQ(settings.width, 64);
    EXPECT_EQ(settings.filter_radius, 1.5f);
    EXPECT_EQ(settings.filter, kernels::FilterKind::blackman_harris);
    EXPECT_EQ(settings.integrator, kernels::IntegratorKind::path);
    EXPECT_EQ(settings.max_glossy, 3);
    EXPECT_TRUE(settings.transparent_background);
    EXPECT_EQ(settings.seed, 9u);
    EXPECT_EQ(stage.snapshot(1).settings.seed, 9u);
    stage.shot.render.seed_animated = true;
    EXPECT_NE(stage.snapshot(0).settings.seed, stage.snapshot(1).settings.seed);
}

TEST(Snapshot, IsAFunctionOfTheFrameAlone) {
    Stage stage;
    stage.animate(stage.add_node("a")).rotation = track<glm::dquat>({{0, test::turn(0)}, {9, test::turn(80)}});
    const BoundShot bound = stage.bind();
    const SceneSnapshot alone = make_snapshots(bound, bound.sequence().frame(3)).front();
    make_snapshots(bound, bound.sequence().frame(2));
    EXPECT_EQ(make_snapshots(bound, bound.sequence().frame(3)).front().geometry_key, alone.geometry_key);
}

}  // namespace
}  // namespace kadr
