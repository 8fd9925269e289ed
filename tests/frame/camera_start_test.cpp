// Where the rays of a long lens start: as near to what it shows as nothing forbids.
#include "frame/camera_start.h"

#include <gtest/gtest.h>

#include "frame/stage.h"

namespace kadr::test {
namespace {

/// A camera 1000 m from the origin, along +z, that sees 18 mm a metre: 18 m there, 10 m high.
class CameraStart : public ::testing::Test {
protected:
    CameraStart() {
        GeometryData& cube = stage_.scene.geometries[0];
        for (int corner = 0; corner < 8; ++corner) cube.positions.push_back({corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f});
        cube.indices = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5};
        stage_.shot.camera.position = PositionTrack(glm::dvec3(0, 0, 1000));
        stage_.shot.camera.look_at = PositionTrack(glm::dvec3(0, 0, 0));
        stage_.shot.camera.focal_length_mm = Track<double>(2000);
        stage_.shot.shutter = {0, 1};
        stage_.add_node("Subject");
    }

    int add(const char* name, glm::dvec3 place, glm::dvec3 scale = glm::dvec3(1)) {
        const int node = stage_.add_node(name);
        stage_.node(node).translation = place;
        stage_.node(node).scale = scale;
        return node;
    }
    double start() const {
        const SceneSnapshot snapshot = stage_.snapshot();
        return snapshot.camera_keys.front().start * snapshot.unit_m;
    }
    /// Before something at this depth, by no more than a few times what the picture is wide there.
    void expect_just_before(double depth) const {
        EXPECT_LT(start(), depth - 0.005 * depth);
        EXPECT_GT(start(), depth - 0.05 * depth);
    }

    Stage stage_;
};

TEST_F(CameraStart, IsJustBeforeWhatIsSeen) {
    expect_just_before(999);
    const SceneSnapshot snapshot = stage_.snapshot();
    const kernels::CameraKey& key = snapshot.camera_keys.front();
    EXPECT_NEAR(snapshot.render_origin.z + key.position.z, 1000 - start(), 1e-4);
    EXPECT_NEAR(key.focus_distance, 1000 - start(), 1e-4);
}

TEST_F(CameraStart, IsTheCameraUnderAWiderLens) {
    stage_.shot.camera.focal_length_mm = Track<double>(300);
    EXPECT_EQ(start(), 0);
}

TEST_F(CameraStart, IsTheCameraWhereNothingIsSeen) {
    stage_.shot.camera.look_at = PositionTrack(glm::dvec3(1000, 0, 1000));
    EXPECT_EQ(start(), 0);
}

TEST_F(CameraStart, HeedsWhatIsNearerAndInViewAlone) {
    add("Beside", {0, 30, 900});
    expect_just_before(999);
    add("Bird", {0, 0.5, 800}, glm::dvec3(0.1));
    expect_just_before(199.9);
}

/// Its box holds the camera, its triangles do not.
TEST_F(CameraStart, LooksAtTheTrianglesOfWhatSurroundsTheCamera) {
    add("Ground", {0, -5, 0}, {2000, 1, 2000});  // 4 m below the axis: in view from some 700 m on
    stage_.shot.camera.look_at = PositionTrack(glm::dvec3(0, 0, 0));
    const double half_height = 0.5 * 36 / 2000 / (16 / 9.0), corner = std::hypot(half_height, 0.5 * 36 / 2000);
    EXPECT_LT(start(), 4 / half_height);
    EXPECT_GT(start(), 0.9 * 4 / corner);
}

TEST_F(CameraStart, HeedsWhatCrossesTheViewWhileTheShutterIsOpen) {
    stage_.animate(add("Bird", {0, 0, 0})).translation = track<glm::dvec3>({{0, {-100, 0, 800}}, {1, {100, 0, 800}}});
    expect_just_before(199);  // at the shutter's opening and closing it is far out of view
}

TEST_F(CameraStart, HeedsWhatTheCameraTurnsTo) {
    add("Beside", {60, 0, 700});
    expect_just_before(999);
    stage_.shot.camera.look_at = PositionTrack(track<glm::dvec3>({{0, {0, 0, 0}}, {1, {200, 0, 0}}}));
    EXPECT_LT(start(), 299);
    EXPECT_GT(start(), 0);
}

TEST_F(CameraStart, IgnoresWhatIsHidden) {
    add("Bird", {0, 0, 800});
    expect_just_before(199);
    stage_.node(1).visible = false;
    expect_just_before(999);
}

TEST_F(CameraStart, HeedsLightsThatHaveASurface) {
    LightSpec bulb;
    bulb.id = "bulb";
    bulb.kind = LightKind::point;
    bulb.position = PositionTrack(glm::dvec3(0, 0, 700));
    stage_.shot.lights.push_back(bulb);
    expect_just_before(999);
    stage_.shot.lights[0].radius_m = Track<double>(0.1);
    expect_just_before(299.9);
}

TEST_F(CameraStart, IsTheCameraInTheMidstOfThings) {
    add("Eyelash", {0, 0, 999.9}, glm::dvec3(0.01));
    EXPECT_LT(start(), 0.1);
}

/// What the camera's keys say between themselves is what the true camera sees: the plane turns along.
TEST_F(CameraStart, MovesWithACameraThatTurns) {
    stage_.shot.camera.look_at = PositionTrack(track<glm::dvec3>({{0, {0, 0, 0}}, {1, {5, 0, 0}}}));
    const SceneSnapshot snapshot = stage_.snapshot();
    ASSERT_GT(snapshot.camera_keys.size(), 1u);
    ASSERT_GT(snapshot.camera_keys.front().start, 900);
    EXPECT_LE(snapshot.camera_error_px, 0.1);
    const kernels::CameraKey &first = snapshot.camera_keys.front(), &last = snapshot.camera_keys.back();
    EXPECT_EQ(first.start, last.start);
    EXPECT_NEAR(last.position.x - first.position.x, 5 * first.start / std::hypot(1000, 5), 1e-3);
}

}  // namespace
}  // namespace kadr::test
