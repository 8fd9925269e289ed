#include "frame/camera_keys.h"

#include <gtest/gtest.h>

#include "frame/decompose.h"
#include "frame/render_origin.h"
#include "stage.h"

namespace kadr {
namespace {

using test::kPi;
using test::message_of;
using test::Stage;
using test::track;

/// The direction through a point of the image plane (0 ... width from the left, 0 ... height from below), as the kernels have it.
glm::dvec3 direction_of(const CameraState& camera, double x, double y, const ImageSpec& image) {
    const glm::dvec3 local((2 * x / image.width - 1) * camera.tan_half_width, (2 * y / image.height - 1) * camera.tan_half_height, -1);
    return camera.rotation * glm::normalize(local);
}

/// The analytic model's convention.
glm::dvec3 analytic_direction(double x, double y, const ImageSpec& image, double fov_y) {
    const double a = image.pixel_aspect * image.width / image.height;
    const double height = 2 / (1 + a), width = 2 - height;
    return glm::normalize(glm::dvec3(x / image.width * width - width / 2, y / image.height * height - height / 2, -(height / 2) / std::tan(fov_y / 2)));
}

TEST(Camera, AgreesWithTheAnalyticImagePlane) {
    for (const double pixel_aspect : {1.0, 0.5, 2.0})
        for (const double fov : {0.3, 0.7, 2.0}) {
            Stage stage;
            stage.shot.image = {640, 360, pixel_aspect};
            stage.shot.camera.vertical_fov_rad = Track<double>(fov);
            const BoundShot bound = stage.bind();
            const CameraState camera = camera_at(bound, 0);
            for (const double x : {0.5, 100.5, 639.5})
                for (const double y : {0.5, 200.5, 359.5})
                    EXPECT_LT(glm::distance(direction_of(camera, x, y, stage.shot.image), analytic_direction(x, y, stage.shot.image, fov)), 1e-14);
        }
}

TEST(Camera, TakesFiftyMillimetresOnThirtySixByDefault) {
    Stage stage;
    stage.shot.image = {1280, 720, 1};
    const CameraState camera = camera_at(stage.bind(), 0);
    EXPECT_DOUBLE_EQ(camera.tan_half_width, 18.0 / 50);
    EXPECT_DOUBLE_EQ(camera.tan_half_height, 18.0 / 50 * 720 / 1280);
}

TEST(Camera, FitsTheSensor) {
    Stage stage;
    stage.shot.image = {400, 800, 1};
    stage.shot.camera.focal_length_mm = Track<double>(24.0);
    EXPECT_DOUBLE_EQ(camera_at(stage.bind(), 0).tan_half_height, 0.5);  // upright: the sensor's 24 mm are the height
    stage.shot.camera.fit = CameraSpec::Fit::horizontal;
    EXPECT_DOUBLE_EQ(camera_at(stage.bind(), 0).tan_half_width, 18.0 / 24);
    EXPECT_DOUBLE_EQ(camera_at(stage.bind(), 0).tan_half_height, 2 * 18.0 / 24);
}

TEST(Camera, LensIsFocalLengthOverTwiceTheStop) {
    Stage stage;
    stage.shot.camera.focal_length_mm = Track<double>(35.0);
    stage.shot.camera.f_stop = Track<double>(2.8);
    const CameraState camera = camera_at(stage.bind(), 0);
    EXPECT_NEAR(camera.lens_radius, 0.035 / 2.8 / 2, 1e-15);
    EXPECT_DOUBLE_EQ(camera.focus_distance, 5);  // on look_at
    stage.shot.camera.focus = Track<double>(2.0);
    EXPECT_DOUBLE_EQ(camera_at(stage.bind(), 0).focus_distance, 2);
    stage.node(stage.add_node("near")).translation = {1, 0, 3};
    stage.shot.camera.focus = NodeReference{"stage/near", {}};
    EXPECT_DOUBLE_EQ(camera_at(stage.bind(), 0).focus_distance, 2);  // along the axis
}

TEST(Camera, LooksStraightDownWithNorthOnTop) {
    Stage stage;
    stage.shot.camera.position = glm::dvec3(0, 5, 0);
    const CameraState camera = camera_at(stage.bind(), 0);
    EXPECT_LT(glm::distance(camera.rotation * glm::dvec3(0, 0, -1), glm::dvec3(0, -1, 0)), 1e-14);
    EXPECT_LT(glm::distance(camera.rotation * glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1)), 1e-14);
}

TEST(Camera, SaysWhenItLooksAtItself) {
    Stage stage;
    stage.shot.camera.position = glm::dvec3(1, 2, 3);
    stage.shot.camera.look_at = Track<glm::dvec3>(glm::dvec3(1, 2, 3));
    EXPECT_EQ(message_of([&] { stage.snapshot(); }),
              "stage.yaml:9:1: error: camera.position and camera.look_at are the same point at 0 s\n"
              "  expected two points: the view has no direction");
}

TEST(Camera, SaysWhenItFocusesBehindItself) {
    Stage stage;
    stage.node(stage.add_node("behind")).translation = {0, 0, 7};
    stage.shot.camera.f_stop = Track<double>(2.0);
    stage.shot.camera.focus = NodeReference{"stage/behind", {}};
    EXPECT_EQ(message_of([&] { stage.snapshot(); }),
              "stage.yaml:9:1: error: camera.focus lies 2 m behind the camera at 0 s\n"
              "  expected a point in front of it");
}

TEST(Camera, AuthoredCamerasKeepTheirVerticalField) {
    Stage stage;
    stage.shot.image = {400, 200, 1};
    const int node = stage.add_node("Camera", -1, false);
    SceneCamera source;
    source.yfov_rad = 0.6;
    source.znear = 0.1;
    stage.scene.cameras.push_back(source);
    stage.node(node).camera = 0;
    stage.node(node).scale = {3, 3, 3};
    stage.node(node).translation = {1, 2, 3};
    stage.node(node).rotation = test::turn(90, {0, 1, 0});
    stage.shot.camera.gltf = NodeReference{"stage/Camera", {}};
    const CameraState camera = camera_at(stage.bind(), 0);
    EXPECT_DOUBLE_EQ(camera.tan_half_height, std::tan(0.3));
    EXPECT_DOUBLE_EQ(camera.tan_half_width, 2 * std::tan(0.3));
    EXPECT_LT(glm::distance(camera.rotation * glm::dvec3(0, 0, -1), glm::dvec3(-1, 0, 0)), 1e-14);
    EXPECT_EQ(camera.position, glm::dvec3(1, 2, 3));
    stage.scene.cameras[0].orthographic = true;
    stage.scene.cameras[0].ymag = 4;
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_TRUE(snapshot.camera.orthographic);
    EXPECT_FLOAT_EQ(snapshot.camera_keys[0].tan_half_height, 4);
    EXPECT_FLOAT_EQ(snapshot.camera_keys[0].tan_half_width, 8);
}

TEST(CameraKeys, OneWhenStill) {
    Stage stage;
    EXPECT_EQ(stage.snapshot().camera_keys.size(), 1u);
    stage.shot.camera.position = track<glm::dvec3>({{5, {0, 0, 5}}, {6, {1, 0, 5}}});
    EXPECT_EQ(stage.snapshot().camera_keys.size(), 1u);
}

TEST(CameraKeys, FollowAPanWithinTheTolerance) {
    Stage stage;
    stage.shot.camera.look_at = track<glm::dvec3>({{0, {-6, 0, 0}}, {1, {6, 1, 0}}});
    const BoundShot bound = stage.bind();
    const std::vector<kernels::CameraKey> keys = stage.snapshot().camera_keys;
    ASSERT_GT(keys.size(), 10u);
    ASSERT_LE(keys.size(), 129u);
    const double pixel = 2 * camera_at(bound, 0).tan_half_height / stage.shot.image.height;  // radians in the middle
    for (int i = 0; i <= 1000; ++i) {
        const double position = i / 1000.0 * static_cast<double>(keys.size() - 1);
        const std::size_t k = std::min(static_cast<std::size_t>(position), keys.size() - 2);
        const auto quaternion = [](const kernels::CameraKey& key) { return glm::dquat(key.rotation[3], key.rotation[0], key.rotation[1], key.rotation[2]); };
        const glm::dquat a = quaternion(keys[k]), b = quaternion(keys[k + 1]);
        EXPECT_GT(glm::dot(a, b), 0);
        EXPECT_LE(glm::degrees(angle_between(a, b)), 10 + 1e-4);
        const glm::dquat is = slerp_shorter(glm::normalize(a), glm::normalize(b), position - static_cast<double>(k));
        EXPECT_LE(angle_between(is, camera_at(bound, i / 1000.0).rotation) / pixel, 0.1 + 1e-3);  // float quaternions
    }
}

/// Looks along -z.
CameraState camera_with(const glm::dvec3& position, double subject_distance, double tan_half_height = 1) {
    CameraState camera;
    camera.position = position;
    camera.subject_distance = subject_distance;
    camera.tan_half_height = tan_half_height;
    return camera;
}

TEST(RenderOrigin, IsTheWorldsOriginForScenesAroundIt) {
    EXPECT_EQ(render_origin(camera_with({3, -8, 20}, 5)), glm::dvec3(0));
    EXPECT_EQ(render_origin(camera_with({0, 0, 1e-4}, 1e-4)), glm::dvec3(0));
    EXPECT_EQ(render_origin(camera_with({0, 0, 1e7}, 1e7, 1e-7)), glm::dvec3(0)) << "a telescope looks at it";
}

double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

TEST(RenderOrigin, StaysNearACameraFarAway) {
    const glm::dvec3 position(1e7 + 0.3, -3e6, 12);
    for (const double distance : {0.01, 1.0, 5.0, 1000.0}) {
        const glm::dvec3 subject = position - glm::dvec3(0, 0, distance);
        EXPECT_LE(largest(subject - render_origin(camera_with(position, distance))), 64 * distance);
    }
    EXPECT_EQ(render_origin(camera_with(position, 5)), render_origin(camera_with(position + glm::dvec3(1, 1, 1), 5)));
}

TEST(RenderOrigin, StaysNearerToWhatNarrowViewsShow) {
    const glm::dvec3 subject(1e7 + 0.3, -3e6, 12);
    for (const double tan_half_height : {0.1, 1e-3, 1e-6}) {
        const double distance = 1e5, half_height = tan_half_height * distance;
        const glm::dvec3 off = subject - render_origin(camera_with(subject + glm::dvec3(0, 0, distance), distance, tan_half_height));
        EXPECT_LE(largest(off), 64 * half_height);
    }
}

CameraState looking(double distance, double half_height) {
    CameraState camera;
    camera.subject_distance = distance;
    camera.tan_half_width = camera.tan_half_height = half_height / distance;
    return camera;
}

TEST(RenderSpace, CountsInMetresWherePicturesShowThingsOfEverydaySize) {
    for (const double shown : {0.25, 1.0, 1e3, 1e6}) EXPECT_EQ(render_space(looking(2 * shown, shown / 2)).unit_m, 1) << shown;
    // Below and above, in the power of two below what is shown.
    EXPECT_EQ(render_space(looking(1, 0.1)).unit_m, 0.125);
    EXPECT_EQ(render_space(looking(1e-9, 1e-9)).unit_m, 0x1p-30);
    EXPECT_EQ(render_space(looking(6e9, 1.5e9)).unit_m, 0x1p31);
    // What a wide view shows at the subject's distance is wider than what matters.
    EXPECT_EQ(render_space(looking(0.5, 1e9)).unit_m, 1);
}

TEST(RenderSpace, ChangesCoordinatesWithoutRounding) {
    const RenderSpace space{{64, -32, 8}, 0x1p-10};
    EXPECT_EQ(space.from_world(glm::dvec3(64.5, -32, 7)), glm::dvec3(512, 0, -1024));
    const glm::dmat4 m = space.from_world(glm::translate(glm::dmat4(1), {64, -32, 9}));
    EXPECT_EQ(m[0][0], 1024);
    EXPECT_EQ(m[3], glm::dvec4(0, 0, 1024, 1));
}

}  // namespace
}  // namespace kadr
