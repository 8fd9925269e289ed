#include "frame/motion_report.h"

#include <gtest/gtest.h>

#include "frame/stage.h"

namespace kadr::test {
namespace {

MotionReport report_of(const Stage& stage) { return motion_report(stage.bind(), stage.snapshots()); }

TEST(MotionReport, SaysHowNearTheKeysOfInstancesCome) {
    Stage stage;
    stage.animate(stage.add_node("Cube")).rotation = track<glm::dquat>({{0, turn(0)}, {1, turn(90)}});
    const MotionReport still_camera = report_of(stage);
    EXPECT_EQ(still_camera.instances_px, stage.snapshot().motion.max_error_px);
    EXPECT_EQ(still_camera.camera_px, 0);
    EXPECT_EQ(still_camera.frames, stage.snapshot().motion.headers[0].frame_count);
    EXPECT_EQ(still_camera.parts, 1u);
    EXPECT_TRUE(still_camera.met());
    EXPECT_EQ(still_camera.worst, "");
}

TEST(MotionReport, TheCamerasErrorIsWhatItsInterpolationMisses) {
    // The camera passes its target by on a line: positions are met exactly, the turn is not even in time.
    Stage stage;
    stage.add_node("Cube");
    stage.shot.camera.position = track<glm::dvec3>({{0, {-2, 0, 5}}, {1, {3, 0, 5}}});
    const MotionReport report = report_of(stage);
    EXPECT_GT(report.camera_px, 1e-4);
    EXPECT_LE(report.camera_px, 0.9 * stage.shot.render.motion_tolerance_px);  // the fit's own margin
    Stage coarse = stage;
    coarse.shot.render.motion_tolerance_px = 10;
    EXPECT_GT(report_of(coarse).camera_px, report.camera_px);
}

TEST(MotionReport, NamesWhatMissesTheTolerance) {
    // Eleven keys at odd times within one shutter, every one a jolt: no even grid of 129 frames meets them.
    Stage stage;
    const int node = stage.add_node("Shaker");
    std::vector<std::pair<double, glm::dvec3>> keys;
    for (int i = 0; i <= 11; ++i) keys.push_back({i / 11.3 + 0.0071 * (i % 3), {i % 2 ? 1.0 : -1.0, 0, 0}});
    stage.animate(node).translation = track<glm::dvec3>(keys);
    const MotionReport report = report_of(stage);
    EXPECT_FALSE(report.met());
    EXPECT_GT(report.instances_px, 0.1);
    EXPECT_EQ(report.worst, "node 'stage/Shaker'");
    // A camera that does the same.
    Stage other;
    other.add_node("Cube");
    for (auto& [time, place] : keys) place.z = 5;
    other.shot.camera.position = track<glm::dvec3>(keys);
    EXPECT_EQ(report_of(other).worst, "the camera");
}

}  // namespace
}  // namespace kadr::test
