// Orbit, dolly, shake, and cameras and scenes that turn into their paths.
#include <gtest/gtest.h>

#include "anim/transform.h"
#include "frame/camera_keys.h"
#include "frame/decompose.h"
#include "stage.h"

namespace kadr {
namespace {

using test::kPi;
using test::message_of;
using test::Stage;
using test::track;

glm::dvec3 forward_of(const CameraState& camera) { return camera.rotation * glm::dvec3(0, 0, -1); }

PositionTrack along(std::vector<glm::dvec3> points, Track<double> at) {
    PositionTrack position;
    position.path = PathMotion{Path(std::move(points), false), std::move(at), true, {0, 1, 0}, {"stage.yaml", 9, 3}};
    return position;
}

/// Largest distance in pixels between the camera keys, interpolated as the kernels do, and the true camera: of the
/// subject, which stands in the middle unless the camera shakes or looks along a path, and of a point beside it.
double worst_error_px(const Stage& stage) {
    const BoundShot bound = stage.bind();
    const SceneSnapshot snapshot = stage.snapshot();
    const std::vector<kernels::CameraKey>& keys = snapshot.camera_keys;
    const auto position_of = [&](const kernels::CameraKey& key) { return glm::dvec3(key.position.x, key.position.y, key.position.z) + snapshot.render_origin; };
    const auto rotation_of = [](const kernels::CameraKey& key) { return glm::normalize(glm::dquat(key.rotation[3], key.rotation[0], key.rotation[1], key.rotation[2])); };
    double worst = 0;
    constexpr int kTimes = 997;
    for (int i = 0; i <= kTimes; ++i) {
        const double u = static_cast<double>(i) / kTimes, at = u * static_cast<double>(keys.size() - 1);
        const std::size_t k = std::min(static_cast<std::size_t>(at), std::max<std::size_t>(keys.size(), 2) - 2), next = std::min(k + 1, keys.size() - 1);
        const CameraState wanted = camera_at(bound, std::lerp(snapshot.open_s, snapshot.close_s, u));
        CameraState is = wanted;
        is.position = glm::mix(position_of(keys[k]), position_of(keys[next]), at - static_cast<double>(k));
        is.rotation = slerp_shorter(rotation_of(keys[k]), rotation_of(keys[next]), at - static_cast<double>(k));
        const auto project = [&](const CameraState& camera, const glm::dvec3& point) {
            const glm::dvec3 seen = glm::conjugate(camera.rotation) * (point - camera.position);
            return glm::dvec2(seen) / -seen.z * (0.5 * stage.shot.image.height / camera.tan_half_height);
        };
        for (const double aside : {0.0, 0.3}) {
            const glm::dvec3 point = wanted.position + wanted.rotation * glm::dvec3(aside, -aside, -1) * wanted.subject_distance;
            worst = std::max(worst, glm::distance(project(is, point), project(wanted, point)));
        }
    }
    return worst;
}

TEST(Rig, OrbitGoesAroundANodeThatMoves) {
    Stage stage;
    const int node = stage.add_node("robot");
    stage.animate(node).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {2, 0, 0}}});
    stage.shot.camera.position.orbit = OrbitMotion{glm::dvec3(0), 4.0, 1.0, track<double>({{0, 0}, {1, 0.25}}), 0};
    stage.shot.camera.around = NodeReference{"stage/robot", {}};
    stage.shot.camera.look_at = NodeReference{"stage/robot", {}};
    const BoundShot bound = stage.bind();
    EXPECT_LT(glm::distance(camera_at(bound, 0).position, glm::dvec3(0, 1, 4)), 1e-14);
    EXPECT_LT(glm::distance(camera_at(bound, 1).position, glm::dvec3(6, 1, 0)), 1e-14);
    EXPECT_NEAR(camera_at(bound, 0.3).subject_distance, std::sqrt(17), 1e-12);
    EXPECT_LE(worst_error_px(stage), 0.1 + 2e-3);  // the tolerance, and float quaternions on 720 lines
}

TEST(Rig, AQuickOrbitIsFittedToo) {
    Stage stage;
    stage.shot.camera.position.orbit = OrbitMotion{glm::dvec3(0), 4.0, 1.0, track<double>({{0, 0}, {1, 0.25}}), 0};
    EXPECT_GE(stage.snapshot().camera_keys.size(), 10u);  // 10 degrees a step
    EXPECT_LE(worst_error_px(stage), 0.1 + 2e-3);
}

TEST(Rig, DollyMovesAlongTheViewAndKeepsItsDirection) {
    Stage stage;
    stage.shot.camera.position = glm::dvec3(3, 0, 4);
    stage.shot.camera.dolly_m = track<double>({{0, -5}, {1, 4}});
    stage.shot.camera.f_stop = Track<double>(4.0);
    const BoundShot bound = stage.bind();
    EXPECT_LT(glm::distance(camera_at(bound, 0).position, glm::dvec3(6, 0, 8)), 1e-14);
    EXPECT_LT(glm::distance(camera_at(bound, 1).position, glm::dvec3(0.6, 0, 0.8)), 1e-14);
    EXPECT_LT(glm::distance(forward_of(camera_at(bound, 1)), glm::dvec3(-0.6, 0, -0.8)), 1e-14);
    EXPECT_NEAR(camera_at(bound, 1).focus_distance, 1, 1e-14);  // the focus stays on what it looks at
    EXPECT_LE(worst_error_px(stage), 0.1 + 2e-3);
}

TEST(Rig, DollyStopsBeforeTheTarget) {
    Stage stage;
    stage.shot.camera.dolly_m = Track<double>(5.0);
    EXPECT_EQ(message_of([&] { stage.snapshot(); }),
              "stage.yaml:9:1: error: camera.dolly is 5 m at 0 s, and what the camera looks at is 5 m away\n"
              "  expected a dolly that stops before camera.look_at");
}

TEST(Rig, ShakeComesOnTopAndLeavesTheFocusAlone) {
    Stage stage;
    stage.shot.camera.position.orbit = OrbitMotion{glm::dvec3(0), 4.0, 1.0, track<double>({{0, 0}, {1, 0.1}}), 0};
    stage.shot.camera.dolly_m = track<double>({{0, 0}, {1, 1}});
    stage.shot.camera.f_stop = Track<double>(2.0);
    const CameraState steady = camera_at(stage.bind(), 0.4);
    stage.shot.camera.shake = Shake{glm::dvec3(0.01), glm::dvec3(0.005), 4, 3};
    const CameraState shaken = camera_at(stage.bind(), 0.4);
    const ShakeOffset offset = evaluate(*stage.shot.camera.shake, 0.4);
    EXPECT_LT(glm::distance(shaken.position, steady.position + steady.rotation * offset.offset_m), 1e-14);
    EXPECT_NEAR(angle_between(shaken.rotation, steady.rotation), glm::length(offset.turn_rad), 1e-12);
    EXPECT_EQ(shaken.focus_distance, steady.focus_distance);
    EXPECT_LE(worst_error_px(stage), 0.1 + 2e-3);
}

TEST(Rig, ShakeTurnsAboutTheCamerasOwnAxes) {
    for (int axis = 0; axis < 3; ++axis) {
        Stage stage;
        stage.shot.camera.position = glm::dvec3(3, 4, 5);
        stage.shot.camera.look_at = Track<glm::dvec3>(glm::dvec3(-1, 0, 2));
        const CameraState steady = camera_at(stage.bind(), 0.4);
        glm::dvec3 amplitude(0);
        amplitude[axis] = 0.2;
        stage.shot.camera.shake = Shake{glm::dvec3(0), amplitude, 4, 3};
        const CameraState shaken = camera_at(stage.bind(), 0.4);
        const double angle = evaluate(*stage.shot.camera.shake, 0.4).turn_rad[axis];
        ASSERT_GT(std::abs(angle), 0.01);
        // The axis of the turn stays where the steady camera has it; the next one goes towards the one after it.
        glm::dvec3 own(0), next(0), wanted(0);
        own[axis] = 1, next[(axis + 1) % 3] = 1;
        wanted[(axis + 1) % 3] = std::cos(angle), wanted[(axis + 2) % 3] = std::sin(angle);
        EXPECT_LT(glm::distance(shaken.rotation * own, steady.rotation * own), 1e-14) << axis;
        EXPECT_LT(glm::distance(shaken.rotation * next, steady.rotation * wanted), 1e-14) << axis;
    }
}

TEST(Rig, ShakeFasterThanTheShutterIsNotPassedOver) {
    Stage stage;
    stage.shot.camera.shake = Shake{glm::dvec3(0.002), glm::dvec3(0.001), 25, 1};  // 25 cycles in the shutter
    EXPECT_GE(stage.snapshot().camera_keys.size(), 101u);
    EXPECT_LE(worst_error_px(stage), 0.1 + 2e-3);
}

TEST(Rig, AuthoredCamerasShakeToo) {
    Stage stage;
    const int node = stage.add_node("Camera", -1, false);
    stage.scene.cameras.emplace_back();
    stage.node(node).camera = 0;
    stage.shot.camera.gltf = NodeReference{"stage/Camera", {}};
    stage.shot.camera.shake = Shake{glm::dvec3(0.1), glm::dvec3(0), 8, 3};
    EXPECT_LT(glm::distance(camera_at(stage.bind(), 0.4).position, evaluate(*stage.shot.camera.shake, 0.4).offset_m), 1e-14);
}

TEST(Rig, ACameraLooksAlongItsPath) {
    Stage stage;
    stage.shot.camera.position = along({{0, 1, 0}, {0, 1, -4}, {4, 1, -8}}, track<double>({{-9, 0}, {1, 1}}));  // a tenth of it in the shutter
    const BoundShot bound = stage.bind();
    EXPECT_LT(glm::distance(forward_of(camera_at(bound, -9)), glm::dvec3(0, 0, -1)), 1e-12);
    EXPECT_LT(glm::distance(forward_of(camera_at(bound, 1)), glm::normalize(glm::dvec3(1, 0, -1))), 1e-9);
    EXPECT_LE(worst_error_px(stage), 0.1 + 2e-3);
}

TEST(Rig, ACameraAlongAPathNeedsAFocusOfItsOwn) {
    Stage stage;
    stage.shot.camera.position = along({{0, 1, 0}, {0, 1, -4}}, track<double>({{0, 0}, {1, 1}}));
    stage.shot.camera.f_stop = Track<double>(4.0);
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:9:1: error: camera.f_stop is given without camera.focus\n"
              "  expected a distance or a node in camera.focus: a camera that looks along its path has no look_at to focus on");
}

TEST(Rig, SaysWhereAPathHasNoDirection) {
    Stage stage;
    stage.shot.camera.position = along({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, Track<double>(0.5));
    EXPECT_EQ(message_of([&] { stage.snapshot(); }),
              "stage.yaml:9:1: error: the path of camera.position turns back on itself at 0 s and has no direction there\n"
              "  expected a point beside it that makes the turn a curve, or look_at instead of orient: along");
}

TEST(Rig, SaysWhenUpLiesAlongTheView) {
    const std::string message =
        "stage.yaml:9:1: error: camera.up lies along the view at 0 s\n"
        "  expected a direction beside the view, such as up: [0, 0, -1] for one straight down";
    Stage stage;
    stage.shot.camera.position = glm::dvec3(0, 5, 0);
    EXPECT_EQ(message_of([&] { stage.snapshot(); }), "no error");  // still, and nobody asked for an up
    stage.shot.camera.up_given = true;
    EXPECT_EQ(message_of([&] { stage.snapshot(); }), message);
    stage.shot.camera.up_given = false;
    stage.shot.camera.look_at = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 0, 0}}});  // a view that turns would flip
    EXPECT_EQ(message_of([&] { stage.snapshot(); }), message);
    stage.shot.camera.look_at = NodeReference{"stage", {}};
    EXPECT_EQ(message_of([&] { stage.snapshot(); }), "no error");
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {0, 1, 0}}});
    EXPECT_EQ(message_of([&] { stage.snapshot(); }), message);
}

TEST(Rig, ASceneTurnsIntoItsPathWithinTheTolerance) {
    Stage stage;
    const int node = stage.add_node("car");
    stage.shot.scenes[0].transform.translate = along({{-2, 0, 0}, {-1, 0, -1}, {0, 0, 0}, {1, 0, 1}, {2, 0, 0}}, track<double>({{-11, 0}, {13, 1}}));
    const SceneSnapshot snapshot = stage.snapshot();  // a frame of 24: 23 cm past the path's third point
    EXPECT_GT(snapshot.motion.headers[0].frame_count, 2u);
    EXPECT_LE(test::worst_error_px(stage, snapshot, 0, node), 0.1);
}

TEST(Rig, ARepeatedSpinIsSplitAtItsSeamAndFitted) {
    Stage stage;
    const int node = stage.add_node("wheel");
    Track<glm::dquat> spin;
    spin.keys = {{0, test::turn(0), {}, {}, {}, Spin{2, {0, 0, 1}}}, {0.6, test::turn(90), {}, {}, {}, {}}};
    spin.after = Extrapolation::repeat;
    stage.shot.scenes[0].transform.rotate.orientation = spin;
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_NEAR(parts[0].close_s, 0.6, 1e-6);
    EXPECT_LE(test::worst_error_px(stage, parts[1], 0, node), 0.1);
    stage.shot.scenes[0].transform.rotate.orientation.after = Extrapolation::hold;  // the value before the seam at its very time
    EXPECT_LE(test::worst_error_px(stage, parts[0], 0, node), 0.1);
    EXPECT_GE(parts[0].motion.headers[0].frame_count, 82u);  // 810 degrees, 10 a step
}

TEST(Rig, LightsOrbit) {
    Stage stage;
    LightSpec bulb;
    bulb.position.orbit = OrbitMotion{glm::dvec3(0, 2, 0), 1.0, 0.0, track<double>({{0, 0}, {1, 1}}), 0};
    stage.shot.lights.push_back(bulb);
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_GE(snapshot.light_keys.size(), 17u);
    EXPECT_NEAR(snapshot.light_keys.front().position.z, 1, 1e-6);
    EXPECT_NEAR(snapshot.light_keys[snapshot.light_keys.size() / 4].position.x, 1, 1e-6);
}

}  // namespace
}  // namespace kadr
