#include "render/path_overlay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frame/stage.h"
#include "kernels/camera/camera.h"
#include "output/image_io.h"
#include "render/fake_device.h"
#include "render/motion_paths.h"
#include "render/overview.h"
#include "render/render_job.h"
#include "render/tiny_shot.h"

namespace kadr {
namespace {

using test::key;
using test::Stage;
using test::track;
using testing::ElementsAre;

constexpr int kWidth = 400, kHeight = 200;

/// The camera of Stage: at (0, 0, 5), 50 mm on 36 mm, so 0.36 wide at one metre. Five frames, one a second, the shutter
/// open for the first half of each.
struct PathStage : Stage {
    PathStage() {
        shot.image.width = kWidth;
        shot.image.height = kHeight;
        shot.timing.frames = {0, 1, 2, 3, 4};
        shot.shutter = {0, 0.5};
        scene.geometries[0].positions = {{-1, -1, -1}, {1, 1, 1}};
    }
    /// A box with corners at half of (1, 1, 1) that goes from x = -1 to 1 in four seconds.
    int add_mover() {
        const int node = add_node("Box");
        scene.geometries[0].scale = 0.5;
        animate(node).translation = track<glm::dvec3>({{0, {-1, 0, 0}}, {4, {1, 0, 0}}});
        return node;
    }
    std::vector<ScreenPath> seen(double now_s = 0) const {
        const BoundShot bound = bind();
        const PathTimes times = path_times(bound, shot.timing.frames);
        const ScreenCamera camera(camera_at(bound, now_s), kWidth, kHeight);
        std::vector<ScreenPath> paths;
        for (const MotionPath& path : motion_paths(bound, times, now_s)) paths.push_back(project(path, times, camera));
        return paths;
    }
};

double length(const ScreenPath& path, bool exposed) {
    double sum = 0;
    for (const PathSegment& segment : path.segments)
        if (segment.exposed == exposed) sum += glm::distance(segment.from, segment.to);
    return sum;
}

TEST(ScreenCameraTest, AgreesWithTheRenderersProjection) {
    PathStage stage;
    stage.shot.camera.position = glm::dvec3(1, 2, 5);
    const BoundShot bound = stage.bind();
    const CameraState state = camera_at(bound, 0);
    const ScreenCamera camera(state, kWidth, kHeight);
    const auto keys = fit_camera(bound, 0, 0, RenderSpace{}).keys;
    kernels::Camera kernel = make_camera(bound, 0);
    kernel.keys = keys.data();
    kernel.key_count = 1;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> number(-1, 1);
    for (int i = 0; i < 200; ++i) {
        const kernels::Vec3f p{number(random), number(random), number(random)};
        const auto wanted = kernels::project<float>(kernel, kWidth, kHeight, p, 0.0f);
        const auto is = camera.project({p.x, p.y, p.z});
        ASSERT_TRUE(is);
        // Floats of a few units through about ten operations, times 200 pixels.
        EXPECT_NEAR(is->px.x, wanted.x, 1e-3);
        EXPECT_NEAR(is->px.y, wanted.y, 1e-3);
    }
}

TEST(ScreenCameraTest, ClipsWhatRunsBehindTheCamera) {
    const PathStage stage;
    const ScreenCamera camera(camera_at(stage.bind(), 0), kWidth, kHeight);
    EXPECT_FALSE(camera.project({0, 0, 6}));
    EXPECT_FALSE(camera.project({0, 0, 6}, {1, 0, 7}));
    const auto seen = camera.project({0, 0, 0}, {0.1, 0, 10});
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->first.px.x, 200, 1e-9);
    EXPECT_NEAR(seen->second.depth, 0.02 * 5, 1e-9) << "cut where the near limit is";
    EXPECT_TRUE(std::isfinite(seen->second.px.x));
}

TEST(PathTest, TicksLieWhereTheFramesAre) {
    PathStage stage;
    stage.add_mover();
    const std::vector<ScreenPath> paths = stage.seen();
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_EQ(paths[0].name, "stage/Box");
    ASSERT_EQ(paths[0].ticks.size(), 5u);
    for (int i = 0; i < 5; ++i) {
        const double x = -1 + 0.5 * i;
        EXPECT_EQ(paths[0].ticks[i].frame, i);
        EXPECT_NEAR(paths[0].ticks[i].at.x, 200 * (1 + x / (5 * 0.36)), 0.01) << i;
        EXPECT_NEAR(paths[0].ticks[i].at.y, 100, 0.01);
        EXPECT_NEAR(paths[0].ticks[i].depth, 5, 1e-9);
        EXPECT_NEAR(std::abs(paths[0].ticks[i].across.y), 1, 1e-9) << "a level path has upright ticks";
    }
}

TEST(PathTest, ExposedPiecesAreThoseOfTheShutter) {
    PathStage stage;
    stage.add_mover();
    const std::vector<ScreenPath> paths = stage.seen();
    // 111 px of path a metre; half a metre a frame, half of which the shutter is open. The last frame's is after the
    // end.
    const double metre = 200 / (5 * 0.36);
    EXPECT_NEAR(length(paths[0], true), 4 * 0.25 * metre, 0.01);
    EXPECT_NEAR(length(paths[0], false), 4 * 0.25 * metre, 0.01);
    EXPECT_NEAR(paths[0].length_px, 2 * metre, 0.01);
}

TEST(PathTest, JumpsAreGaps) {
    PathStage stage;
    stage.animate(stage.add_node("Box")).translation =
        track<glm::dvec3>({{0, {-1, 0, 0}}, {1.3, {-0.5, 0, 0}}, {2.6, {1, 0, 0}}}, Interpolation::step);
    EXPECT_NEAR(length(stage.seen()[0], true) + length(stage.seen()[0], false), 0, 1e-6);
    EXPECT_EQ(stage.seen()[0].ticks.size(), 5u);
}

TEST(PathTest, WhatTurnsIsFollowedByACorner) {
    PathStage stage;
    stage.animate(stage.add_node("Wheel")).rotation = track<glm::dquat>({{0, test::turn(0)}, {4, test::turn(120)}});
    const std::vector<ScreenPath> paths = stage.seen();
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_EQ(paths[0].name, "stage/Wheel (a corner)");
    const BoundShot bound = stage.bind();
    const PathTimes times = path_times(bound, stage.shot.timing.frames);
    const MotionPath path = motion_paths(bound, times, 0)[0];
    EXPECT_NEAR(glm::length(glm::dvec2(path.position(0))), std::sqrt(2.0), 1e-9);
    EXPECT_NEAR(glm::length(glm::dvec2(path.position(2.7))), std::sqrt(2.0), 1e-9);
}

TEST(PathTest, AMiddleThatIsNotQuiteTheAxisIsNoReasonToFollowIt) {
    PathStage stage;
    const int node = stage.add_node("Propeller");
    stage.scene.geometries[0].centre = {0.2, 0, 0};  // uneven blades: the middle of their box goes round the axis
    stage.animate(node).rotation = track<glm::dquat>({{0, test::turn(0)}, {4, test::turn(170)}});
    EXPECT_EQ(stage.seen()[0].name, "stage/Propeller (a corner)");
    stage.scene.geometries[0].centre = {3, 0, 0};  // swings on a long arm
    EXPECT_EQ(stage.seen()[0].name, "stage/Propeller");
}

TEST(PathTest, WhatHangsTogetherIsOneObject) {
    PathStage stage;
    const int root = stage.add_mover();
    stage.add_node("Hat", root);
    stage.add_node("Rock");
    ASSERT_EQ(stage.seen().size(), 1u);
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {4, {0, 1, 0}}});
    ASSERT_EQ(stage.seen().size(), 1u) << "the whole scene moves now";
    EXPECT_EQ(stage.seen()[0].name, "stage");
}

TEST(PathTest, TheCameraSeesItsOwnWayAhead) {
    PathStage stage;
    stage.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {4, {1, 0, 1}}});
    const std::vector<ScreenPath> paths = stage.seen(0);
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_EQ(paths[0].name, "camera");
    // At 0 s it looks along -z from z = 5; a quarter of the way each second.
    ASSERT_EQ(paths[0].ticks.size(), 4u) << "its own place cannot be seen";
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(paths[0].ticks[i].frame, i + 1);
        EXPECT_NEAR(paths[0].ticks[i].at.x, 200 * (1 + 0.25 / 0.36), 0.01) << i;
    }
    EXPECT_TRUE(stage.seen(4)[0].ticks.empty()) << "from the end all of it lies behind";
}

TEST(PathTest, TheTargetHasAPath) {
    PathStage stage;
    stage.shot.camera.look_at = track<glm::dvec3>({{0, {0, 0, 0}}, {4, {1, 0, 0}}});
    const std::vector<ScreenPath> paths = stage.seen();
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_EQ(paths[0].name, "look at");
    EXPECT_NEAR(paths[0].ticks[4].at.x, 200 * (1 + 1 / (5 * 0.36)), 0.01);
}

TEST(PathTest, LightsHavePathsUnlessTheyAreFarAway) {
    PathStage stage;
    for (const LightKind kind : {LightKind::point, LightKind::directional}) {
        LightSpec light;
        light.id = kind == LightKind::point ? "bulb" : "sun";
        light.kind = kind;
        light.position = track<glm::dvec3>({{0, {0, 0, 0}}, {4, {1, 0, 0}}});
        stage.shot.lights.push_back(light);
    }
    ASSERT_EQ(stage.seen().size(), 1u);
    EXPECT_EQ(stage.seen()[0].name, "bulb");
    EXPECT_NEAR(stage.seen()[0].ticks[4].at.x, 200 * (1 + 1 / (5 * 0.36)), 0.01);
}

TEST(PathTest, LongestPathsFirstAndTheRestCounted) {
    PathStage stage;
    for (int i = 1; i <= 4; ++i)
        stage.animate(stage.add_node("N" + std::to_string(i))).translation =
            track<glm::dvec3>({{0, {0, 0, 0}}, {4, {0.2 * i, 0, 0}}});
    stage.shot.camera.look_at = track<glm::dvec3>({{0, {0, 0, 0}}, {4, {0.1, 0, 0}}});
    std::vector<ScreenPath> paths = stage.seen();
    EXPECT_EQ(keep_most_prominent(paths, 2), 2);
    std::vector<std::string> names;
    for (const ScreenPath& path : paths) names.push_back(path.name);
    EXPECT_THAT(names, ElementsAre("look at", "stage/N4", "stage/N3"));
}

TEST(PathTest, TicksStayApart) {
    ScreenPath path;
    path.ticks.resize(100);
    path.length_px = 1000;
    EXPECT_EQ(tick_step(path), 1);
    path.length_px = 250;
    EXPECT_EQ(tick_step(path), 2);
    path.length_px = 99;
    EXPECT_EQ(tick_step(path), 5);
    path.length_px = 30;
    EXPECT_EQ(tick_step(path), 20);
}

TEST(PathDrawingTest, LinesAreBrightWhereExposedAndFainterBehindSurfaces) {
    PathStage stage;
    stage.add_mover();
    std::vector<ScreenPath> paths = stage.seen();
    paths[0].tolerance = 0;
    const auto drawn = [&](const std::vector<float>& depth) {
        Image picture{kWidth, kHeight, {"R", "G", "B"}, std::vector<float>(3u * kWidth * kHeight, 0.0f)};
        draw_paths(picture, paths, 0, depth);
        return picture;
    };
    const DisplayColor color = path_color(MotionPath::Subject::object, 0);
    // Between the ticks of frames 1 and 2: x = -0.375 m is exposed (1.25 s), x = -0.125 m is not (1.75 s).
    const auto column = [](double x) { return static_cast<int>(200 * (1 + x / 1.8)); };
    const Image bare = drawn({});
    EXPECT_NEAR(bare.at(column(-0.375), 100, 2), color.b, 0.02);
    EXPECT_GT(bare.at(column(-0.375), 101, 2), bare.at(column(-0.125), 101, 2) + 0.3) << "thick and thin";
    const std::size_t pixels = static_cast<std::size_t>(kWidth) * kHeight;
    EXPECT_EQ(drawn(std::vector<float>(pixels, 6)).pixels, bare.pixels) << "a surface behind the path";
    const Image behind = drawn(std::vector<float>(pixels, 3));
    EXPECT_NEAR(behind.at(column(-0.375), 100, 2), 0.35 * color.b, 0.02);
}

/// Every frame's place on every path, and the shot's camera, seen by the second one.
TEST(OverviewTest, HasAllOfTheMotionInItsPicture) {
    PathStage stage;
    stage.add_mover();
    stage.shot.camera.position = track<glm::dvec3>({{0, {-3, 1, 5}}, {4, {9, 2, 3}}});
    const BoundShot bound = stage.bind();
    const PathTimes times = path_times(bound, stage.shot.timing.frames);
    const std::vector<MotionPath> paths = motion_paths(bound, times, 2);
    ASSERT_EQ(paths.size(), 2u);
    for (const Viewpoint from : {Viewpoint::side, Viewpoint::top, Viewpoint::iso}) {
        const Shot second = overview_shot(bound, paths, times, from, 2);
        const ScreenCamera camera(camera_at(BoundShot(second, stage.scene), 0), kWidth, kHeight);
        double widest = 0;
        for (const MotionPath& path : paths)
            for (const FrameTime& frame : times.frames) {
                const auto point = camera.project(path.position(frame.time_s()));
                ASSERT_TRUE(point);
                const double x = std::abs(point->px.x / kWidth - 0.5), y = std::abs(point->px.y / kHeight - 0.5);
                EXPECT_LT(std::max(x, y), 0.5) << static_cast<int>(from);
                widest = std::max({widest, x, y});
            }
        EXPECT_GT(widest, 0.25) << "and it fills the picture";
    }
}

TEST(OverviewTest, TopHasTheCamerasViewUpwards) {
    PathStage stage;
    stage.add_mover();
    const BoundShot bound = stage.bind();
    const PathTimes times = path_times(bound, stage.shot.timing.frames);
    const Shot second = overview_shot(bound, motion_paths(bound, times, 0), times, Viewpoint::top, 0);
    const ScreenCamera camera(camera_at(BoundShot(second, stage.scene), 0), kWidth, kHeight);
    EXPECT_LT(camera.project({0, 0, 0})->px.y, camera.project({0, 0, 5})->px.y);
    EXPECT_LT(camera.project({-1, 0, 0})->px.x, camera.project({1, 0, 0})->px.x);
}

class PathPreviewTest : public testing::Test {
protected:
    void SetUp() override {
        fake_device() = {};
        interrupt_requested() = false;
        options_.kind = PreviewKind::path;
        options_.render.shot = write_tiny_shot(folder_.path(), "  frames: out/{name}.{frame:04}.png\n");
        options_.render.overrides.width = 120;
        options_.render.overrides.height = 80;
        options_.output = folder_.path() / "path.png";
    }
    FrameReport run() { return render_preview(options_, {}); }

    TemporaryFolder folder_;
    PreviewOptions options_;
};

TEST_F(PathPreviewTest, DrawsOverTheFrameThatIsAskedFor) {
    options_.frame = 2;
    options_.render.overrides.set = {{"camera.look_at", "{ keys: { 0 f: [-0.5, 0, 0], 3 f: [0.5, 0, 0] } }"}};
    const FrameReport report = run();
    EXPECT_EQ(report.preview, "path");
    EXPECT_THAT(report.frames, ElementsAre(2));
    EXPECT_EQ(report.note, "");
    Metadata metadata = image_io().read_metadata(options_.output);
    EXPECT_EQ(metadata["preview"], "path");
    EXPECT_EQ(metadata.count("settings"), 0u);
}

TEST_F(PathPreviewTest, SaysThatNothingMoves) { EXPECT_EQ(run().note, "nothing moves during these frames"); }

TEST_F(PathPreviewTest, SaysThatNothingOfItShows) {
    options_.render.overrides.set = {{"camera.position", "{ keys: { 0 f: [0, 0, 4], 3 f: [0, 0, 6] } }"}};
    EXPECT_EQ(run().note, "nothing that moves is in the picture; try --from iso");
    options_.from = Viewpoint::iso;
    EXPECT_EQ(run().note, "");
}

}  // namespace
}  // namespace kadr
