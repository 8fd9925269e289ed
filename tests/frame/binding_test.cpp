#include "frame/frame_state.h"

#include <gmock/gmock.h>

#include "frame/bindings.h"
#include "stage.h"

namespace kadr {
namespace {

using test::message_of;
using test::Stage;
using test::track;
using test::turn;

NodeReference reference(std::string text) { return {std::move(text), {"stage.yaml", 11, 12}}; }

TEST(Binding, FindsNodesByNameAndPath) {
    Stage stage;
    const int left = stage.add_node("Left"), right = stage.add_node("Right");
    const int middle = stage.add_node("Middle", right);
    const int wheel = stage.add_node("Wheel", left), other = stage.add_node("Wheel", middle);
    stage.add_node("Odd/Name", left);
    const BoundShot bound = stage.bind();
    EXPECT_EQ(bound.node_of(reference("stage")), -1);
    EXPECT_EQ(bound.scene_of(reference("stage")), 0);
    EXPECT_EQ(bound.node_of(reference("stage/Middle")), middle);
    EXPECT_EQ(bound.node_of(reference("stage/Left/Wheel")), wheel);
    EXPECT_EQ(bound.node_of(reference("stage/Right/Wheel")), other);  // levels may be left out
    EXPECT_EQ(bound.node_of(reference("stage/Odd/Name")), other + 1);
}

TEST(Binding, SaysWhatAReferenceMightHaveMeant) {
    Stage stage;
    stage.add_node("Visor");
    stage.shot.camera.look_at = reference("stage/Vizor");
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:11:12: error: 'stage/Vizor' names no node\n"
              "  did you mean 'stage/Visor'?");
    stage.shot.camera.look_at = reference("stag/Visor");
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:11:12: error: 'stag/Visor' names no scene\n"
              "  did you mean 'stage'?");
}

TEST(Binding, SaysOnceWhatTheMiddleOfAnOrbitMightHaveMeant) {
    Stage stage;
    stage.shot.camera.around = reference("stag/Visor");
    stage.shot.camera.look_at = reference("stag/Visor");  // as the reader has it where look_at is not given
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:11:12: error: 'stag/Visor' names no scene\n"
              "  did you mean 'stage'?");
}

TEST(Binding, ListsTheNodesOfAnAmbiguousName) {
    Stage stage;
    stage.add_node("Wheel", stage.add_node("Left"));
    stage.add_node("Wheel", stage.add_node("Right"));
    stage.shot.camera.look_at = reference("stage/Wheel");
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:11:12: error: 'stage/Wheel' names 2 nodes\n"
              "  expected one; add a parent's name: stage/Left/Wheel, stage/Right/Wheel");
}

TEST(Binding, ReportsAllProblemsAtOnce) {
    Stage stage;
    stage.shot.camera.look_at = reference("stage/Nobody");
    stage.shot.scenes[0].layers[0].clips = ClipLayer::Clips::one;
    stage.shot.scenes[0].layers[0].clip_name = "Walk";
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:4:7: error: scene 'stage' has no clip 'Walk'\n"
              "  there are no clips of the file\n"
              "stage.yaml:11:12: error: 'stage/Nobody' names no node\n"
              "  there are no nodes");
}

TEST(Binding, FindsANamelessNodeByItsNumberAsMessagesCallIt) {
    Stage stage;
    stage.add_node("Box");
    const int first = stage.add_node("", -1, false), second = stage.add_node("", -1, false);
    stage.scene.cameras.push_back({});
    stage.node(first).camera = stage.node(second).camera = 0;
    stage.shot.camera.gltf = reference("stage/#2");
    EXPECT_NO_THROW(stage.bind());
}

TEST(Binding, WantsACameraForTheCamera) {
    Stage stage;
    stage.add_node("Box");
    const int helper = stage.add_node("Rig", -1, false);
    const int eye = stage.add_node("Rig_Orientation", helper, false);
    stage.scene.cameras.push_back({});
    stage.node(eye).camera = 0;
    stage.shot.camera.gltf = reference("stage/Box");
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:11:12: error: camera.gltf is 'stage/Box', which is no camera\n"
              "  expected one of the cameras of 'stage': stage/Rig/Rig_Orientation");
    stage.shot.camera.gltf = reference("stage/Rig");
    EXPECT_EQ(stage.bind().node_of(*stage.shot.camera.gltf), eye);
}

TEST(Binding, RefusesWhatTheAnalyticIntegratorDoesNotHave) {
    Stage stage;
    stage.shot.render.integrator = Integrator::direct;
    LightSpec panel;
    panel.id = "panel";
    panel.kind = LightKind::area;
    panel.where = {"stage.yaml", 20, 3};
    LightSpec bulb = panel;
    bulb.id = "bulb";
    bulb.kind = LightKind::point;
    bulb.radius_m = Track<double>(0.1);
    stage.shot.lights = {panel, bulb};
    stage.shot.environment.image = "sky.exr";
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:20:3: error: lights.panel.type is area, which render.integrator direct does not have\n"
              "  expected a directional, point or spot light without a size; use integrator: path\n"
              "stage.yaml:20:3: error: lights.bulb.radius is above 0, which render.integrator direct does not have\n"
              "  expected a directional, point or spot light without a size; use integrator: path\n"
              "stage.yaml:12:1: error: environment.image is given, which render.integrator direct does not have\n"
              "  expected environment.color; use integrator: path");
    stage.shot.render.integrator = Integrator::path;
    EXPECT_NO_THROW(stage.bind());
}

TEST(Binding, RunsFromFrameZeroToTheEndOfTheLongestClip) {
    Stage stage;
    stage.shot.frames_given = false;
    stage.shot.timing.fps = {24, 1};
    EXPECT_THAT(stage.bind().timing().frames, testing::ElementsAre(0));
    stage.animate(stage.add_node("a")).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1.01, {1, 0, 0}}});
    stage.scene.clips[0].end_s = 1.01;
    EXPECT_EQ(stage.bind().timing().frames.back(), 25);  // 24.24 frames
    stage.shot.scenes[0].layers[0].speed = 2;
    EXPECT_EQ(stage.bind().timing().frames.back(), 13);
    stage.scene.clips[0].end_s = 1e9;
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml: error: the longest clip runs for 500000000 s\n"
              "  expected fewer than 1000000 frames; give timing.frames");
}

TEST(Binding, KnowsWhatNeverMoves) {
    Stage stage;
    const int still = stage.add_node("still"), mover = stage.add_node("mover"), child = stage.add_node("child", mover);
    const int idle = stage.add_node("idle");
    stage.animate(mover).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 0, 0}}});
    stage.animate(idle).translation = track<glm::dvec3>({{0, {2, 0, 0}}, {1, {2, 0, 0}}});
    std::vector<bool> fixed = stage.bind().fixed_nodes();
    EXPECT_TRUE(fixed[static_cast<std::size_t>(still)]);
    EXPECT_FALSE(fixed[static_cast<std::size_t>(mover)]);
    EXPECT_FALSE(fixed[static_cast<std::size_t>(child)]);
    EXPECT_TRUE(fixed[static_cast<std::size_t>(idle)]);  // a channel that never changes
    EXPECT_EQ(stage.bind().node_transforms(0)[static_cast<std::size_t>(idle)][3].x, 2);
    stage.shot.scenes[0].transform.rotate.axis_angle = RotationTrack::AxisAngle{{0, 1, 0}, track<double>({{0, 0}, {1, 1}})};
    fixed = stage.bind().fixed_nodes();
    EXPECT_FALSE(fixed[static_cast<std::size_t>(still)]);
}

TEST(Binding, PlaysClipsFromTheirStartAtTheirSpeed) {
    Stage stage;
    stage.animate(stage.add_node("a")).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {10, {10, 0, 0}}});
    stage.shot.scenes[0].layers[0].start_s = 1;
    stage.shot.scenes[0].layers[0].speed = 2;
    EXPECT_DOUBLE_EQ(stage.bind().node_transforms(3)[0][3].x, 7);
    EXPECT_DOUBLE_EQ(stage.bind().node_transforms(100)[0][3].x, 10);  // holds
    stage.shot.scenes[0].layers[0].speed = -1;
    stage.shot.scenes[0].layers[0].start_s = 8;
    EXPECT_DOUBLE_EQ(stage.bind().node_transforms(3)[0][3].x, 5);
    stage.shot.scenes[0].layers[0].clips = ClipLayer::Clips::none;
    EXPECT_DOUBLE_EQ(stage.bind().node_transforms(3)[0][3].x, 0);
}

TEST(Binding, AnOffsetShiftsTheTimeOfClipsAlone) {
    Stage stage;
    const int parent = stage.add_node("parent"), child = stage.add_node("child", parent);
    stage.animate(child).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {0, 0, 0}}, {10, {9, 0, 0}}});
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {10, {0, 10, 0}}});
    stage.shot.scenes[0].layers[0].speed = 2;
    const BoundShot bound = stage.bind();
    const NodeRig& rig = bound.bindings().rig;
    EXPECT_LT(glm::distance(glm::dvec3(rig.node_transform(child, 1, 0.5)[3]), glm::dvec3(2, 1, 0)), 1e-14);
    EXPECT_EQ(rig.all_transforms(1, 0.5)[static_cast<std::size_t>(child)], rig.node_transform(child, 1, 0.5));
    const NodeRig::Selection selection = rig.select(std::vector<int>{child});
    EXPECT_THAT(rig.key_times_of(child, 0.1, 4), testing::ElementsAre(0.5));
    EXPECT_THAT(rig.key_times_of(child, 0.1, 4, -0.25), testing::UnorderedElementsAre(0.25, 0.75));
    EXPECT_EQ(rig.activity(selection, 0, 1)[1].keys, 1);
    EXPECT_EQ(rig.activity(selection, 0, 1, 0.75)[1].keys, 0);
}

TEST(Binding, ChainsTransformsInDouble) {
    Stage stage;
    const int root = stage.add_node("root"), child = stage.add_node("child", root);
    stage.shot.scenes[0].transform.translate = Track<glm::dvec3>(glm::dvec3(0, 1, 0));
    stage.node(root).rotation = turn(90);
    stage.node(child).matrix = glm::translate(glm::dmat4(1), glm::dvec3(1, 0, 0));
    stage.animate(root).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {5, 0, 0}}});
    const glm::dmat4 world = stage.bind().node_transforms(1)[static_cast<std::size_t>(child)];
    EXPECT_LT(glm::distance(glm::dvec3(world[3]), glm::dvec3(5, 2, 0)), 1e-14);
}

TEST(Binding, WarnsWhereNothingShines) {
    Stage stage;
    stage.add_node("a");
    ASSERT_EQ(stage.bind().warnings().size(), 1u);
    EXPECT_EQ(stage.bind().warnings()[0].text(),
              "stage.yaml: warning: there are no lights and no environment\n"
              "  lit by the default sky; add `lights` or `environment`");
    stage.shot.environment.given = true;
    ASSERT_EQ(stage.bind().warnings().size(), 1u);
    EXPECT_EQ(stage.bind().warnings()[0].found, "nothing shines: no lights, a black environment and no emissive material");
    stage.scene.materials[0].emission = {1, 1, 1};
    EXPECT_TRUE(stage.bind().warnings().empty());
}

}  // namespace
}  // namespace kadr
