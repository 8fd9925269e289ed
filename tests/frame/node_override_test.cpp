// scenes.nodes and scenes.hide: nodes that the shot moves or leaves out, and clips that cannot be played.
#include <gmock/gmock.h>

#include "frame/bindings.h"
#include "stage.h"

namespace kadr {
namespace {

using test::message_of;
using test::Stage;
using test::track;
using test::turn;

NodeOverride named(std::string name) {
    NodeOverride node;
    node.name = std::move(name);
    node.where = {"stage.yaml", 6, 9};
    return node;
}

glm::dvec3 place(const glm::dmat4& m) { return glm::dvec3(m[3]); }

/// "Body" carries "Visor", which carries "Hinge"; a clip moves and turns the hinge.
struct Helmet : Stage {
    int body = add_node("Body"), visor = add_node("Visor", body), hinge = add_node("Hinge", visor);
    Helmet() {
        node(visor).translation = {0, 1, 0};
        node(hinge).scale = {1, 2, 1};
        NodeChannels& channels = animate(hinge);
        channels.translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 0, 0}}});
        channels.rotation = track<glm::dquat>({{0, turn(0)}, {1, turn(50)}});
    }
    glm::dmat4 at(double time_s) const { return bind().node_transforms(time_s)[static_cast<std::size_t>(hinge)]; }
    SceneSpec& spec() { return shot.scenes[0]; }
};

TEST(NodeOverride, ReplacesItsPartAndLeavesTheOthersToTheClip) {
    Helmet stage;
    NodeOverride node = named("Visor/Hinge");
    node.rotates = true;
    node.transform.rotate.axis_angle = RotationTrack::AxisAngle{{1, 0, 0}, track<double>({{0, 0}, {2, 3}})};
    stage.spec().nodes = {node};
    const glm::dquat r = glm::angleAxis(1.5, glm::dvec3(1, 0, 0));
    const glm::dmat4 is = stage.at(1);
    EXPECT_LT(glm::distance(place(is), glm::dvec3(1, 1, 0)), 1e-14);  // the clip's
    EXPECT_LT(glm::distance(glm::dvec3(is[1]), 2.0 * (r * glm::dvec3(0, 1, 0))), 1e-14);  // the shot's turn, the node's scale
    EXPECT_LT(glm::distance(glm::dvec3(is[2]), r * glm::dvec3(0, 0, 1)), 1e-14);
}

TEST(NodeOverride, MovesWhatNoClipMoves) {
    Helmet stage;
    NodeOverride node = named("Body");
    node.translates = node.scales = true;
    node.transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {0, 0, -4}}});
    node.transform.scale = Track<glm::dvec3>(glm::dvec3(3));
    stage.spec().nodes = {node};
    stage.spec().layers[0].clips = ClipLayer::Clips::none;
    EXPECT_LT(glm::distance(place(stage.at(0.5)), glm::dvec3(0, 3, -2)), 1e-14);
    EXPECT_FALSE(stage.bind().fixed_nodes()[static_cast<std::size_t>(stage.visor)]);
    const BoundShot bound = stage.bind();
    const NodeRig& rig = bound.bindings().rig;
    EXPECT_THAT(rig.key_times_of(stage.hinge, -0.5, 0.5, 7), testing::ElementsAre(0));  // an offset of clips shifts no key of the shot
    EXPECT_EQ(rig.activity(rig.select(std::vector<int>{stage.hinge}), -0.5, 0.5)[2].keys, 1);
}

TEST(NodeOverride, ThatIsConstantMakesItsPartStandStill) {
    Helmet stage;
    NodeOverride node = named("Hinge");
    node.translates = node.rotates = true;
    node.transform.translate = Track<glm::dvec3>(glm::dvec3(5, 0, 0));
    node.transform.rotate.orientation = Track<glm::dquat>(turn(90));
    stage.spec().nodes = {node};
    EXPECT_TRUE(stage.bind().fixed_nodes()[static_cast<std::size_t>(stage.hinge)]);
    EXPECT_LT(glm::distance(place(stage.at(0.7)), glm::dvec3(5, 1, 0)), 1e-14);
}

TEST(NodeOverride, KeepsTheShearOfAMatrix) {
    Helmet stage;
    glm::dmat4 sheared(1);
    sheared[1] = {0.5, 1, 0, 0};
    stage.node(stage.visor).matrix = sheared;
    NodeOverride node = named("Visor");
    node.translates = true;
    node.transform.translate = Track<glm::dvec3>(glm::dvec3(0, 0, 7));
    stage.spec().nodes = {node};
    const glm::dmat4 visor = stage.bind().node_transforms(0)[static_cast<std::size_t>(stage.visor)];
    EXPECT_LT(glm::distance(glm::dvec3(visor[1]), glm::dvec3(0.5, 1, 0)), 1e-14);
    EXPECT_LT(glm::distance(place(visor), glm::dvec3(0, 0, 7)), 1e-14);
}

TEST(NodeOverride, StepsSplitTheShutter) {
    Helmet stage;
    NodeOverride node = named("Body");
    node.translates = true;
    node.transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {0.25, {0, 1, 0}}}, Interpolation::step);
    stage.spec().nodes = {node};
    EXPECT_EQ(stage.snapshots().size(), 2u);
}

TEST(NodeOverride, SaysWhichNodesThereAre) {
    Helmet stage;
    stage.add_node("Hinge", stage.body);
    stage.spec().nodes = {named("Vizor"), named("Hinge"), named("Visor"), named("Body/Visor")};
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:6:9: error: 'Vizor' names no node of scene 'stage'\n"
              "  did you mean 'Visor'?\n"
              "stage.yaml:6:9: error: 'Hinge' names 2 nodes of scene 'stage'\n"
              "  expected one; add a parent's name: Body/Visor/Hinge, Body/Hinge\n"
              "stage.yaml:6:9: error: 'Visor' and 'Body/Visor' are the same node, stage/Body/Visor\n"
              "  expected each node once");
}

TEST(Hide, LeavesOutNodesWithAllBelowThem) {
    Helmet stage;
    const int lamp = stage.add_node("Lamp", stage.visor, false), other = stage.add_node("Visor");
    stage.scene.lights.push_back({});
    stage.node(lamp).light = 0;
    EXPECT_EQ(stage.bind().bindings().seeds.size(), 4u);
    EXPECT_EQ(stage.bind().bindings().lights.size(), 1u);
    stage.spec().hide = {{"Visor", {}}};  // both of them
    const BoundShot bound = stage.bind();
    ASSERT_EQ(bound.bindings().seeds.size(), 1u);
    EXPECT_EQ(bound.bindings().seeds[0].node, stage.body);
    EXPECT_TRUE(bound.bindings().lights.empty());
    EXPECT_TRUE(bound.bindings().rig.hidden(stage.hinge) && bound.bindings().rig.hidden(other));
    stage.spec().hide = {{"Body/Visor/Hinge", {}}};
    EXPECT_EQ(stage.bind().bindings().seeds.size(), 3u);
}

TEST(Hide, DoesNotSplitTheShutterForWhatIsNotSeen) {
    Helmet stage;
    stage.scene.clips[0].channels[0].translation->interpolation = Interpolation::step;
    stage.scene.clips[0].channels[0].translation->keys[1].time_s = 0.5;
    EXPECT_EQ(stage.snapshots().size(), 2u);
    stage.spec().hide = {{"Hinge", {}}};
    EXPECT_EQ(stage.snapshots().size(), 1u);
}

TEST(Hide, RefusesUnknownNodesAndTheCameraInUse) {
    Helmet stage;
    stage.scene.cameras.push_back({});
    stage.node(stage.hinge).camera = 0;
    stage.spec().hide = {{"Visr", {"stage.yaml", 7, 13}}, {"Visor", {"stage.yaml", 7, 19}}};
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:7:13: error: 'Visr' names no node of scene 'stage'\n"
              "  did you mean 'Visor'?");
    stage.spec().hide = {{"Visor", {"stage.yaml", 7, 19}}};
    EXPECT_NO_THROW(stage.bind());
    stage.shot.camera.gltf = NodeReference{"stage/Hinge", {"stage.yaml", 9, 17}};
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:9:17: error: camera.gltf is 'stage/Hinge', which scenes.stage.hide leaves out\n"
              "  expected a camera that is there; take 'Visor' out of the list");
}

TEST(PlayingClips, RefuseAClipThatAnimatesNothing) {
    Helmet stage;
    stage.scene.clips.push_back({"Blink", 0, 0, {}, 0});
    stage.scene.clips.push_back({"", 0, 0, {}, 3});
    stage.scene.files[0].clip_count = 3;
    EXPECT_NO_THROW(stage.bind());  // as one of all it does no harm
    ClipLayer blink;
    blink.clips = ClipLayer::Clips::one;
    blink.clip_name = "Blink";
    blink.where = {"stage.yaml", 4, 7};
    ClipLayer third = blink;
    third.clip_index = 2;
    stage.spec().layers = {blink, third};
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:4:7: error: clip 'Blink' of scene 'stage' animates nothing\n"
              "  it has no channels; leave it out\n"
              "stage.yaml:4:7: error: clip 2 of scene 'stage' animates nothing\n"
              "  its 3 channels point to what Kadr does not animate; leave it out");
}

TEST(PlayingClips, RefuseACutBehindTheEnd) {
    Helmet stage;
    stage.scene.clips[0].end_s = 1;
    ClipLayer layer;
    layer.clips = ClipLayer::Clips::one;
    layer.clip_name = "Clip";
    layer.where = {"stage.yaml", 4, 7};
    layer.in_s = 1.5;
    stage.spec().layers = {layer};
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:4:7: error: in is 1.5 s, and clip 'Clip' of scene 'stage' ends at 1 s\n"
              "  expected 0 to 1 s");
}

}  // namespace
}  // namespace kadr
