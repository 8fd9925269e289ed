// Bending meshes of a snapshot: keys, bounds, versions.
#include <gtest/gtest.h>

#include <cmath>

#include "frame/bindings.h"
#include "frame/deform.h"
#include "frame/key_grid.h"
#include "stage.h"

namespace kadr {
namespace {

using test::key;
using test::Stage;
using test::track;
using test::turn;

/// A bar along x from -1 to 1 of two joints at its middle; the right half follows joint "tip", a child of "root".
struct BarStage : Stage {
    int mesh, root, tip;

    BarStage() {
        GeometryData& bar = scene.geometries[0];
        for (int i = 0; i <= 8; ++i)
            for (int side = 0; side < 2; ++side) bar.positions.push_back({static_cast<float>(i) / 4 - 1, side * 0.1f, 0});
        for (std::uint32_t i = 0; i < 16; i += 2) bar.indices.insert(bar.indices.end(), {i, i + 2, i + 1, i + 1, i + 2, i + 3});
        bar.skin.per_vertex = 1;
        for (int i = 0; i <= 8; ++i)
            for (int side = 0; side < 2; ++side) {
                bar.skin.joints.push_back(i > 4 ? 1 : 0);
                bar.skin.weights.push_back(1);
            }
        mesh = add_node("bar");
        root = add_node("root", -1, false);
        tip = add_node("tip", root, false);
        Skin skin;
        skin.joints = {root, tip};
        skin.inverse_bind = {glm::dmat4(1), glm::dmat4(1)};
        skin.root = root;
        scene.skins.push_back(skin);
        node(mesh).skin = 0;
    }
    void turn_tip(double degrees, double seconds = 1) { animate(tip).rotation = track<glm::dquat>({{0, turn(0)}, {seconds, turn(degrees)}}); }
};

glm::dvec3 world_of(const SceneSnapshot& snapshot, std::size_t vertex, double u) {
    const SnapshotInstance& instance = snapshot.instances.at(0);
    const DeformedMesh& mesh = *snapshot.deformed.at(static_cast<std::size_t>(instance.deformed));
    const std::size_t count = mesh.vertices.size() / mesh.key_count;
    const double position = u * (mesh.key_count - 1);
    const std::size_t first = std::min<std::size_t>(static_cast<std::size_t>(position), mesh.key_count > 1 ? mesh.key_count - 2 : 0);
    const auto at = [&](std::size_t k) {
        const kernels::Vec3f p = mesh.vertices[std::min<std::size_t>(k, mesh.key_count - 1) * count + vertex].position;
        return glm::dvec3(p.x, p.y, p.z);
    };
    const glm::dvec3 p = glm::mix(at(first), at(first + 1), position - static_cast<double>(first));
    return snapshot.render_origin + glm::dvec3(interpolate(snapshot.motion, 0, u) * glm::dvec4(p, 1));
}

double pixels_a_metre(const Stage& stage, const SceneSnapshot& snapshot) {
    const CameraState camera = camera_at(stage.bind(), snapshot.open_s);
    return 0.5 * stage.shot.image.height / camera.tan_half_height / 5;
}

TEST(Deformation, IgnoresTheTransformOfASkinnedNode) {
    BarStage stage;
    stage.node(stage.mesh).translation = {100, 200, 300};
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.deformed.size(), 1u);
    EXPECT_EQ(snapshot.deformed[0]->key_count, 1u);
    EXPECT_TRUE(snapshot.instances[0].fixed_place >= 0);
    EXPECT_LT(glm::distance(world_of(snapshot, 17, 0), glm::dvec3(1, 0.1, 0)), 1e-6);
}

TEST(Deformation, StaysWithinTheToleranceBetweenKeys) {
    for (const double degrees : {2.0, 30.0, 170.0}) {
        BarStage stage;
        stage.turn_tip(degrees);
        const SceneSnapshot snapshot = stage.snapshot();
        const double scale = pixels_a_metre(stage, snapshot);
        double worst = 0;
        for (int i = 0; i <= 200; ++i) {
            const double u = i / 200.0, angle = glm::radians(degrees * u);
            const glm::dvec3 wanted(std::cos(angle), std::sin(angle), 0);
            worst = std::max(worst, scale * glm::distance(world_of(snapshot, 16, u), wanted));
        }
        EXPECT_LE(worst, stage.shot.render.motion_tolerance_px) << degrees;
        EXPECT_GT(snapshot.motion.max_error_px, 0) << degrees;
        EXPECT_LE(worst, snapshot.motion.max_error_px / 0.9) << degrees;  // measured at three places of a segment
        EXPECT_LE(snapshot.motion.max_error_px, stage.shot.render.motion_tolerance_px) << degrees;
    }
}

TEST(Deformation, LeavesTheMotionOfTheRootToTheInstance) {
    BarStage stage;
    stage.animate(stage.root).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {0.5, 0, 0}}});
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_EQ(snapshot.deformed.at(0)->key_count, 1u);
    EXPECT_GT(snapshot.motion.headers[0].frame_count, 1u);
    EXPECT_LT(glm::distance(world_of(snapshot, 0, 1), glm::dvec3(-0.5, 0, 0)), 1e-6);
}

TEST(Deformation, KeepsItsPrecisionFarAway) {
    BarStage stage;
    const glm::dvec3 far(3e6, -2e6, 1e6);
    stage.turn_tip(40);
    stage.shot.scenes[0].transform.translate = far;
    stage.shot.camera.position = Track<glm::dvec3>(far + glm::dvec3(0, 0, 5));
    stage.shot.camera.look_at = Track<glm::dvec3>(far);
    const SceneSnapshot snapshot = stage.snapshot();
    const glm::dvec3 wanted = far + glm::dvec3(std::cos(glm::radians(40.0)), std::sin(glm::radians(40.0)), 0);
    EXPECT_LT(glm::distance(world_of(snapshot, 16, 1), wanted), 1e-6);
}

/// The bar with a node between its joints, which is none, and joints that were not bound where they stand.
struct ChainStage : BarStage {
    int between;
    glm::dmat4 bind = glm::rotate(glm::translate(glm::dmat4(1), {0.3, -0.1, 0.2}), 0.4, glm::dvec3(0, 1, 0));

    ChainStage() {
        between = add_node("between", root, false);
        node(root).children = {between};
        node(between).children = {tip};
        node(tip).parent = between;
        node(root).translation = {0.5, 0.25, 0};
        node(root).rotation = turn(20);
        node(between).translation = {0.2, 0, 0};
        node(between).rotation = turn(50, {1, 0, 0});
        node(tip).translation = {0, 0.1, 0};
        node(tip).rotation = turn(-30, {0, 1, 1});
        scene.skins[0].inverse_bind[1] = bind;
    }
    glm::dmat4 local(int index) {
        const Node& n = node(index);
        return glm::translate(glm::dmat4(1), n.translation) * glm::mat4_cast(n.rotation);
    }
    void expect_places() {
        const SceneSnapshot snapshot = snapshot_of_now();
        const kernels::Vec3f end = scene.geometries[0].positions[17], start = scene.geometries[0].positions[0];
        const glm::dvec4 wanted_end = local(root) * local(between) * local(tip) * bind * glm::dvec4(end.x, end.y, end.z, 1);
        EXPECT_LT(glm::distance(world_of(snapshot, 17, 0), glm::dvec3(wanted_end)), 1e-6);
        EXPECT_LT(glm::distance(world_of(snapshot, 0, 0), glm::dvec3(local(root) * glm::dvec4(start.x, start.y, start.z, 1))), 1e-6);
    }
    SceneSnapshot snapshot_of_now() const { return snapshot(); }
};

TEST(Deformation, GoesFromTheBindingThroughAllNodesUpToTheRoot) {
    ChainStage stage;
    stage.expect_places();
    // The joints may be listed in any order: the tip before the root that it hangs from.
    std::swap(stage.scene.skins[0].joints[0], stage.scene.skins[0].joints[1]);
    std::swap(stage.scene.skins[0].inverse_bind[0], stage.scene.skins[0].inverse_bind[1]);
    for (std::uint16_t& joint : stage.scene.geometries[0].skin.joints) joint = joint == 0 ? 1 : 0;
    stage.expect_places();
}

TEST(Deformation, KeysOfAllNodesOfTheSkeletonAreCorners) {
    for (const bool joint : {false, true}) {
        ChainStage stage;
        stage.animate(joint ? stage.tip : stage.between).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {0.2, {0.5, 0, 0}}, {0.6, {0, 0.3, 0}}, {1, {0, 0, 0}}});
        const SceneSnapshot snapshot = stage.snapshot();
        EXPECT_EQ(snapshot.deformed.at(0)->key_count, 6u) << joint;  // fifths
        EXPECT_LT(snapshot.deformed[0]->error_px, 1e-3) << joint;    // float vertices on 720 lines
    }
}

TEST(Deformation, IsLeftOutWithAnInstanceThatIsNowhereAndHiddenWithOneThatIsOff) {
    BarStage stage;
    stage.turn_tip(30);
    stage.node(stage.mesh).visible = false;
    const SceneSnapshot off = stage.snapshot();
    ASSERT_EQ(off.instances.size(), 1u);
    EXPECT_EQ(off.instances[0].mask, 0u);
    stage.node(stage.mesh).visible = true;
    EXPECT_NE(stage.snapshot().instances[0].mask, 0u);
    stage.node(stage.root).scale = glm::dvec3(0);
    const SceneSnapshot nowhere = stage.snapshot();
    EXPECT_TRUE(nowhere.instances.empty());
    EXPECT_TRUE(nowhere.deformed.empty());
    EXPECT_EQ(nowhere.motion.max_error_px, 0);
}

TEST(Deformation, SplitsTheShutterWhereItsVerticesAloneStray) {
    // Corners at odd times that no even grid of 128 steps meets; the instance itself stands still.
    BarStage stage;
    stage.animate(stage.tip).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {0.2371, {2, 0, 0}}, {0.6113, {-2, 1, 0}}, {1, {0, 0, 0}}});
    stage.shot.render.samples = 1;  // too few to split the shutter for
    const double whole_px = stage.snapshot().deformed.at(0)->error_px;
    const double enough_px = kDeformationShare * kMotionMargin * stage.shot.render.motion_tolerance_px;
    EXPECT_GT(whole_px, enough_px);
    stage.shot.render.samples = 64;
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    EXPECT_GT(parts.size(), 1u);
    double weights = 0;
    for (const SceneSnapshot& part : parts) weights += part.weight;
    EXPECT_NEAR(weights, 1, 1e-12);
    EXPECT_LT(parts.front().deformed.at(0)->error_px, whole_px);
}

TEST(Deformation, DualQuaternionsKeepTheToleranceToo) {
    BarStage stage;
    stage.turn_tip(120);
    stage.shot.scenes[0].skinning = Skinning::dual_quaternion;
    const SceneSnapshot snapshot = stage.snapshot();
    const double scale = pixels_a_metre(stage, snapshot);
    for (int i = 0; i <= 50; ++i) {
        const double angle = glm::radians(120 * i / 50.0);
        EXPECT_LE(scale * glm::distance(world_of(snapshot, 16, i / 50.0), glm::dvec3(std::cos(angle), std::sin(angle), 0)), stage.shot.render.motion_tolerance_px);
    }
}

TEST(Deformation, ChangesTheKeyWithTheVerticesAlone) {
    BarStage stage;
    stage.shot.timing.frames = {0, 1, 2, 3};
    stage.animate(stage.tip).rotation = track<glm::dquat>({{0, turn(0)}, {1, turn(30)}});  // holds from 1 s on
    const BoundShot bound = stage.bind();
    std::vector<SceneSnapshot> frames;
    for (int frame = 0; frame < 4; ++frame) frames.push_back(make_snapshots(bound, bound.sequence().frame(frame)).front());
    EXPECT_NE(frames[0].geometry_key, frames[1].geometry_key);
    EXPECT_EQ(frames[1].geometry_key, frames[2].geometry_key);
    EXPECT_EQ(frames[1].deformed[0], frames[2].deformed[0]);  // not computed again
    EXPECT_EQ(frames[2].geometry_key, frames[3].geometry_key);
}

struct DropStage : Stage {
    int drop;
    DropStage() {
        GeometryData& g = scene.geometries[0];
        g.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
        g.indices = {0, 1, 2};
        g.targets.push_back({{2}, {{0, 2, 0}}, {}, {}});
        drop = add_node("drop");
        node(drop).weights = {0};
    }
};

TEST(Deformation, CostsNothingWithoutWeights) {
    DropStage stage;
    EXPECT_TRUE(stage.snapshot().deformed.empty());
    stage.node(stage.drop).weights = {0.5};
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.deformed.size(), 1u);
    EXPECT_LT(glm::distance(world_of(snapshot, 2, 0), glm::dvec3(0, 2, 0)), 1e-6);
}

TEST(Deformation, LinearWeightsNeedTwoKeys) {
    DropStage stage;
    stage.animate(stage.drop).weights = {track<double>({{0, 0}, {1, 1}})};
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_EQ(snapshot.deformed.at(0)->key_count, 2u);
    EXPECT_LT(glm::distance(world_of(snapshot, 2, 0.25), glm::dvec3(0, 1.5, 0)), 1e-6);
}

TEST(Deformation, SplitsTheShutterAtStepsOfWeights) {
    DropStage stage;
    stage.animate(stage.drop).weights = {track<double>({{0, 0}, {0.25, 1}}, Interpolation::step)};
    const auto parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_DOUBLE_EQ(parts[0].weight, 0.25);
    EXPECT_LT(glm::distance(world_of(parts[0], 2, 1), glm::dvec3(0, 1, 0)), 1e-6);
    EXPECT_LT(glm::distance(world_of(parts[1], 2, 0), glm::dvec3(0, 3, 0)), 1e-6);
}

TEST(Deformation, TellsWhereVerticesWereAFrameAgo) {
    DropStage stage;
    stage.shot.timing.frames = {0, 1};
    stage.shot.output.aovs = {Aov::motion};
    stage.animate(stage.drop).weights = {track<double>({{0, 0}, {2, 1}})};
    const SceneSnapshot snapshot = stage.snapshot(1);
    ASSERT_TRUE(snapshot.previous);
    const kernels::Vec3f p = snapshot.previous->deformed.at(0).at(2);
    const glm::dvec3 world(snapshot.previous->space_from_geometry[0] * glm::dvec4(p.x, p.y, p.z, 1));
    EXPECT_LT(glm::distance(world, glm::dvec3(0, 1, 0)), 1e-6);
}

TEST(Deformation, MixesTheFilesOwnWeightsWithWhatItsLayersLeave) {
    DropStage stage;
    stage.scene.geometries[0].targets.push_back({{0}, {{1, 0, 0}}, {}, {}});
    stage.node(stage.drop).weights = {0.25, 0.75};
    stage.animate(stage.drop).weights = {Track<double>(1.0)};  // the second weight is not the clip's
    stage.shot.scenes[0].layers[0].weight = Track<double>(0.5);
    EXPECT_EQ(stage.bind().bindings().morphs.weights(stage.drop, 0, 0), (std::vector<double>{0.625, 0.75}));
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_LT(glm::distance(world_of(snapshot, 2, 0), glm::dvec3(0, 1 + 2 * 0.625, 0)), 1e-6);
    EXPECT_LT(glm::distance(world_of(snapshot, 0, 0), glm::dvec3(-1 + 0.75, -1, 0)), 1e-6);
}

NodeOverride weights_of(std::string node, std::vector<Track<double>> weights) {
    NodeOverride result;
    result.name = std::move(node);
    result.weights = std::move(weights);
    result.weights_where = {"stage.yaml", 7, 11};
    return result;
}

TEST(Deformation, WeightsOfTheShotWinOverClipsAndBlur) {
    DropStage stage;
    stage.animate(stage.drop).weights = {track<double>({{0, 1}, {1, 0}})};
    stage.shot.scenes[0].nodes = {weights_of("drop", {track<double>({{0, 0}, {0.5, 0.25}, {1, 1}})})};
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.deformed.size(), 1u);
    EXPECT_EQ(snapshot.deformed[0]->key_count, 3u);  // a key of the vertices for each of the weights'
    EXPECT_LT(glm::distance(world_of(snapshot, 2, 0.25), glm::dvec3(0, 1.25, 0)), 1e-6);
    EXPECT_LT(glm::distance(world_of(snapshot, 2, 0.75), glm::dvec3(0, 2.25, 0)), 1e-6);
}

TEST(Deformation, KeysOfWeightsAreCornersOfTheVertices) {
    const Track<double> fifths = track<double>({{0, 0}, {0.2, 1}, {0.6, 0}, {1, 0.5}});
    for (const bool by_shot : {false, true}) {
        DropStage stage;
        if (by_shot) stage.shot.scenes[0].nodes = {weights_of("drop", {fifths})};
        else stage.animate(stage.drop).weights = {fifths};
        const SceneSnapshot snapshot = stage.snapshot();
        EXPECT_EQ(snapshot.deformed.at(0)->key_count, 6u) << by_shot;  // fifths: two, four, eight parts would miss them
        EXPECT_LT(snapshot.deformed[0]->error_px, 1e-4) << by_shot;    // float vertices on 720 lines
        EXPECT_LT(glm::distance(world_of(snapshot, 2, 0.2), glm::dvec3(0, 3, 0)), 1e-6) << by_shot;
    }
}

TEST(Deformation, ConstantWeightsOfTheShotReplaceTheFiles) {
    DropStage stage;
    stage.shot.scenes[0].nodes = {weights_of("drop", {Track<double>(0.5)})};
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.deformed.size(), 1u);
    EXPECT_EQ(snapshot.deformed[0]->key_count, 1u);
    EXPECT_LT(glm::distance(world_of(snapshot, 2, 0), glm::dvec3(0, 2, 0)), 1e-6);
    EXPECT_EQ(stage.bind().bindings().morphs.weights(stage.drop, 3, 5), std::vector<double>{0.5});
}

TEST(Deformation, StepsOfTheShotsWeightsSplitTheShutter) {
    DropStage stage;
    stage.shot.scenes[0].nodes = {weights_of("drop", {track<double>({{0, 0}, {0.25, 1}}, Interpolation::step)})};
    const auto parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_DOUBLE_EQ(parts[0].weight, 0.25);
    EXPECT_LT(glm::distance(world_of(parts[1], 2, 0), glm::dvec3(0, 3, 0)), 1e-6);
}

TEST(Deformation, RefusesWeightsThatDoNotFitTheMesh) {
    DropStage stage;
    stage.add_node("stone");
    stage.shot.scenes[0].nodes = {weights_of("stone", {Track<double>(0.5)}), weights_of("drop", {Track<double>(0.5), Track<double>(1.0)})};
    EXPECT_EQ(test::message_of([&] { stage.bind(); }),
              "stage.yaml:7:11: error: weights are given for node 'stage/stone', which has no morph targets\n"
              "  expected a node whose mesh has some; remove the key\n"
              "stage.yaml:7:11: error: the weights of node 'stage/drop' are 2 numbers\n"
              "  expected 1, one for each morph target of its mesh");
}

TEST(Deformation, RefusesWhatIsNotFinite) {
    DropStage stage;
    stage.node(stage.drop).weights = {INFINITY};
    EXPECT_EQ(test::message_of([&] { stage.bind(); }),
              "stage.yaml:3:5: error: the mesh of node 'drop' has joints or morph weights that are not finite at 0 s\n  expected finite transforms and weights");
}

}  // namespace
}  // namespace kadr
