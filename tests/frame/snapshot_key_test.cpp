#include "frame/snapshot_key.h"

#include <gtest/gtest.h>

#include <functional>

#include "frame/stage.h"

namespace kadr::test {
namespace {

Stage furnished() {
    Stage stage;
    stage.add_node("Cube");
    LightSpec light;
    light.id = "key";
    light.position = glm::dvec3(1, 2, 3);
    stage.shot.lights.push_back(light);
    stage.shot.environment.given = true;
    return stage;
}

TEST(SnapshotKey, DoesNotDependOnTheFrame) {
    Stage stage = furnished();
    stage.shot.shutter.curve.shape = ShutterCurve::Shape::triangle;
    stage.shot.shutter.rolling = {RollingShutter::Direction::down, 0.01};
    stage.shot.timing.fps = {30000, 1001};
    const Hash first = content_key(stage.snapshots(0));
    for (const int frame : {1, 2, 1000, 999983}) EXPECT_EQ(content_key(stage.snapshots(frame)), first) << frame;
}

TEST(SnapshotKey, DependsOnEverythingThatCanBeSeen) {
    const std::pair<const char*, std::function<void(Stage&)>> changes[] = {
        {"node", [](Stage& s) { s.node(0).translation.x = 1e-5; }},
        {"scene", [](Stage& s) { s.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {0, 0, 1e-3}}}); }},
        {"camera", [](Stage& s) { s.shot.camera.position = glm::dvec3(0, 0, 5.0001); }},
        {"camera's way", [](Stage& s) { s.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {1, {0, 0, 5.01}}}); }},
        {"lens", [](Stage& s) { s.shot.camera.focal_length_mm = Track<double>(50.01); }},
        {"blades", [](Stage& s) { s.shot.camera.blades = 5; }},
        {"light", [](Stage& s) { s.shot.lights[0].strength = Track<double>(1.001); }},
        {"light's fall-off", [](Stage& s) { s.shot.lights[0].falloff = SpotFalloff::linear; }},
        {"environment", [](Stage& s) { s.shot.environment.color = glm::dvec3(0, 0, 1e-4); }},
        {"environment's turn", [](Stage& s) { s.shot.environment.rotate_rad = Track<double>(0.1); }},
        {"background", [](Stage& s) { s.shot.environment.visible = false; }},
        {"image size", [](Stage& s) { s.shot.image.width += 1; }},
        {"filter", [](Stage& s) { s.shot.render.filter_width_px = 1.6; }},
        {"seed", [](Stage& s) { s.shot.render.seed = 1; }},
        {"bounces", [](Stage& s) { s.shot.render.bounces.glossy = 3; }},
        {"clamp", [](Stage& s) { s.shot.render.clamp_indirect = 10; }},
        {"curve", [](Stage& s) { s.shot.shutter.curve.shape = ShutterCurve::Shape::smooth; }},
        {"rolling", [](Stage& s) { s.shot.shutter.rolling = {RollingShutter::Direction::down, 0.01}; }},
        {"a step inside the shutter", [](Stage& s) { s.shot.lights[0].strength = track<double>({{0, 1.0}, {0.3, 2.0}}, Interpolation::step); }},
        {"motion layer", [](Stage& s) { s.shot.output.aovs = {Aov::motion}; }},
    };
    const Hash plain = content_key(furnished().snapshots());
    for (const auto& [what, change] : changes) {
        Stage stage = furnished();
        change(stage);
        EXPECT_NE(content_key(stage.snapshots()), plain) << what;
    }
}

/// A clip of a second in which a node swings and turns, looped.
Stage looping(ClipLayer::Loop loop) {
    Stage stage = furnished();
    stage.animate(0).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {0.4, {1, 0.3, 0}}, {1, {0, 0, 0}}});
    stage.animate(0).rotation = track<glm::dquat>({{0, turn(0)}, {0.5, turn(100)}, {1, turn(200)}});
    stage.scene.clips[0].end_s = 1;
    stage.shot.scenes[0].layers[0].loop = loop;
    stage.shot.shutter = {0, 0.5};
    return stage;
}

TEST(SnapshotKey, FramesOfALoopAreTheSameInEveryPass) {
    for (const auto& [loop, seconds] : {std::pair(ClipLayer::Loop::repeat, 1), std::pair(ClipLayer::Loop::pingpong, 2)})
        for (const int fps : {24, 25, 30}) {
            Stage stage = looping(loop);
            stage.shot.timing.fps = {fps, 1};
            const BoundShot bound = stage.bind();
            const auto key_at = [&](int frame) { return content_key(make_snapshots(bound, bound.sequence().frame(frame))); };
            const int period = seconds * fps;
            for (int frame = 0; frame < period; ++frame)
                for (const int pass : {1, 2, 7, 60}) EXPECT_EQ(key_at(frame + pass * period), key_at(frame)) << fps << ' ' << frame << ' ' << pass;
            EXPECT_NE(key_at(1), key_at(2));
        }
}

TEST(SnapshotKey, ASampleSeedThatIsAnimatedChangesWithTheFrame) {
    Stage stage = furnished();
    stage.shot.render.seed_animated = true;
    EXPECT_NE(content_key(stage.snapshots(0)), content_key(stage.snapshots(1)));
}

}  // namespace
}  // namespace kadr::test
