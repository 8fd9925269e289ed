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

/// A sheet on a node, which a morph target lifts.
int add_sheet(Stage& stage) {
    GeometryData& sheet = stage.scene.geometries.emplace_back();
    sheet.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    sheet.indices = {0, 1, 2};
    sheet.targets.push_back({{0, 1, 2}, {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}, {}, {}});
    const int node = stage.add_node("Sheet");
    stage.node(node).primitives = {{static_cast<int>(stage.scene.geometries.size()) - 1, 0}};
    stage.node(node).weights = {0};
    return node;
}
/// A path with corners at odd times, of some size: what one part of 129 even frames misses.
template <class T>
Track<T> jolts(T reach) {
    return track<T>({{0, T(0)}, {0.2371, reach}, {0.6113, -reach}, {1, T(0)}});
}

TEST(MotionReport, AddsWhatPlacesAndVerticesOfABendingMeshMiss) {
    const auto report = [](bool bends, bool moves, double cube_m) {
        Stage stage;
        stage.shot.render.samples = 1;  // nothing is split
        const int sheet = add_sheet(stage);
        if (bends) stage.animate(sheet).weights = {jolts(1.0)};
        if (moves) stage.animate(sheet).translation = jolts(glm::dvec3(0.5, 0, 0));
        if (cube_m > 0) stage.animate(stage.add_node("Cube")).translation = jolts(glm::dvec3(cube_m, 0, 0));
        return report_of(stage);
    };
    const MotionReport bends = report(true, false, 0), moves = report(false, true, 0), both = report(true, true, 0);
    ASSERT_GT(bends.vertices_px, 0.1);
    ASSERT_GT(moves.instances_px, 0.1);
    EXPECT_EQ(bends.instances_px, bends.vertices_px);
    EXPECT_EQ(moves.vertices_px, 0);
    // The error of either is measured by a bound that knows how near the whole comes, hence not to the last digit.
    EXPECT_NEAR(both.instances_px, both.vertices_px + moves.instances_px, 0.1 * both.instances_px);
    EXPECT_GT(both.instances_px, 1.05 * std::max(both.vertices_px, moves.instances_px));
    EXPECT_EQ(both.worst, "node 'stage/Sheet'");
    // A body beside it, that strays less or more than both together: nothing is added to it.
    const MotionReport far = report(true, true, 5), near = report(true, true, 0.01), alone = report(false, false, 5);
    EXPECT_EQ(near.instances_px, both.instances_px);
    EXPECT_EQ(near.worst, "node 'stage/Sheet'");
    EXPECT_GT(alone.instances_px, both.instances_px);
    EXPECT_EQ(far.instances_px, alone.instances_px);
    EXPECT_EQ(far.worst, "node 'stage/Cube'");
    const MotionReport vertices = report(true, false, 0.01);  // of the places the cube's strays most
    EXPECT_EQ(vertices.instances_px, bends.instances_px);
    EXPECT_EQ(vertices.worst, "node 'stage/Sheet'");
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
