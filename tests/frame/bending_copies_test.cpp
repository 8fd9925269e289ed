// Copies of bending meshes that play their clips at other times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "frame/bindings.h"
#include "frame/deform.h"
#include "stage.h"

namespace kadr {
namespace {

using test::key;
using test::message_of;
using test::Stage;
using test::track;
using test::turn;

/// A strip along x whose right end a joint turns and a morph target lifts, both by the clip.
struct StripStage : Stage {
    int mesh, root, tip;

    StripStage() {
        GeometryData& strip = scene.geometries[0];
        MorphTarget lift;
        for (int i = 0; i <= 4; ++i)
            for (int side = 0; side < 2; ++side) {
                strip.positions.push_back({static_cast<float>(i) / 2 - 1, side * 0.1f, 0});
                strip.skin.joints.push_back(i > 2 ? 1 : 0);
                strip.skin.weights.push_back(1);
                lift.positions.push_back({0, 0, i > 2 ? 0.5f : 0.0f});
            }
        for (std::uint32_t i = 0; i < 8; i += 2) strip.indices.insert(strip.indices.end(), {i, i + 2, i + 1, i + 1, i + 2, i + 3});
        strip.skin.per_vertex = 1;
        strip.targets.push_back(lift);
        mesh = add_node("strip");
        root = add_node("root", -1, false);
        tip = add_node("tip", root, false);
        Skin skin;
        skin.joints = {root, tip};
        skin.inverse_bind = {glm::dmat4(1), glm::dmat4(1)};
        skin.root = root;
        scene.skins.push_back(skin);
        node(mesh).skin = 0;
        node(mesh).weights = {0};
        animate(tip).rotation = track<glm::dquat>({{0, turn(0)}, {1.5, turn(60)}, {4, turn(-50)}});
        animate(mesh).weights = {track<double>({{0, 0.0}, {2.25, 1.0}, {4, 0.25}})};
    }

    void copies(const std::vector<double>& offsets_s) {
        InstancesSpec spec;
        spec.where = {"stage.yaml", 5, 14};
        for (const double offset : offsets_s) {
            PlacementSpec place;
            place.offset_s = offset;
            spec.list.push_back(place);
        }
        shot.scenes[0].instances = spec;
    }
};

bool same_vertices(const DeformedMesh& a, const DeformedMesh& b) {
    return a.key_count == b.key_count && std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(), [](const kernels::Vertex& p, const kernels::Vertex& q) {
        return p.position.x == q.position.x && p.position.y == q.position.y && p.position.z == q.position.z && p.normal.x == q.normal.x && p.normal.z == q.normal.z;
    });
}

TEST(BendingCopies, BendAsASceneThatStartsAtTheirOffset) {
    for (const double offset : {0.0, 0.25, 1.25, -0.5}) {
        StripStage copied, alone;
        copied.copies({offset});
        alone.shot.scenes[0].layers[0].start_s = offset;
        alone.shot.output.aovs = copied.shot.output.aovs = {Aov::motion};
        for (const int frame : {0, 1, 2}) {
            const SceneSnapshot a = copied.snapshot(frame), b = alone.snapshot(frame);
            ASSERT_EQ(a.deformed.size(), 1u);
            EXPECT_TRUE(same_vertices(*a.deformed[0], *b.deformed[0])) << offset << ", frame " << frame;
            EXPECT_EQ(interpolate(a.motion, 0, 0), interpolate(b.motion, 0, 0));
            ASSERT_EQ(a.previous->deformed[0].size(), 10u);
            for (std::size_t v = 0; v < 10; ++v) {
                EXPECT_EQ(a.previous->deformed[0][v].y, b.previous->deformed[0][v].y);
                EXPECT_EQ(a.previous->deformed[0][v].z, b.previous->deformed[0][v].z);
            }
        }
    }
}

TEST(BendingCopies, DifferAtOtherTimesOfTheClip) {  // or the test above would prove nothing
    StripStage early, late;
    early.copies({0.25});
    late.copies({0.5});
    EXPECT_FALSE(same_vertices(*early.snapshot().deformed[0], *late.snapshot().deformed[0]));
}

TEST(BendingCopies, ShareTheirVerticesWhereTheirOffsetsAreEqual) {
    StripStage stage;
    stage.copies({0.5, 0, 0.5, 0.25, 0});
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.deformed.size(), 3u);
    ASSERT_EQ(snapshot.instances.size(), 5u);
    const int wanted[] = {2, 0, 2, 1, 0};
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(snapshot.instances[i].deformed, wanted[i]) << i;
    std::vector<std::uint32_t> numbers;
    for (const auto& mesh : snapshot.deformed) numbers.push_back(mesh->number);
    EXPECT_EQ(numbers, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(BendingCopies, OfSeveralMeshesHaveNumbersOfTheirOwn) {
    StripStage stage;
    stage.node(stage.mesh).primitives.push_back({0, 0});
    stage.copies({0.5, 0});
    const BoundShot bound = stage.bind();
    const SceneSnapshot snapshot = make_snapshots(bound, bound.sequence().frame(0)).front();
    ASSERT_EQ(snapshot.deformed.size(), 4u);
    for (std::uint32_t number = 0; number < 4; ++number) {
        EXPECT_EQ(snapshot.deformed[number]->number, number);
        const BentMesh bent = bound.bindings().bent_mesh(number);
        EXPECT_EQ(bent.clip_offset_s, number % 2 == 0 ? 0 : 0.5);
        EXPECT_EQ(bent.deformer, &bound.bindings().deformers[number / 2]);
    }
}

TEST(BendingCopies, LieWithinTheBoundsOfAllOfThem) {
    // The shot shows the first second alone; one copy is at the far end of the clip by then.
    StripStage stage;
    stage.animate(stage.root).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {4, {0, 0, 0}}});
    stage.scene.clips[0].channels[0].translation = track<glm::dvec3>({{0, {0, 0, 0}}, {4, {80, 0, 0}}});
    stage.copies({0, 3});
    const SceneSnapshot snapshot = stage.snapshot();
    for (const auto& mesh : snapshot.deformed)
        for (const kernels::Vertex& vertex : mesh->vertices) EXPECT_LE(std::abs(vertex.position.x), 1.01f);  // looked at at nine times
}

TEST(BendingCopies, SplitTheShutterWhereTheirOwnWeightsJump) {
    StripStage stage;
    stage.scene.clips[0].channels[1].weights = {track<double>({{0, 0.0}, {1, 1.0}}, Interpolation::step)};
    stage.copies({0.25, 0.5});
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_DOUBLE_EQ(parts[0].close_s, 0.5);
    EXPECT_DOUBLE_EQ(parts[1].close_s, 0.75);
}

TEST(BendingCopies, MeetTheToleranceWhereverTheirKeysLie) {
    // The joint's key at 1.5 s lies at 0.7 s of the shutter for the second copy, the weight's at 2.25 s at 0.3 s for the third.
    StripStage stage;
    stage.copies({0, 0.8, 1.95});
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_NE((snapshot.deformed[0]->key_count - 1) % 10, 0u);
    EXPECT_EQ((snapshot.deformed[1]->key_count - 1) % 10, 0u);  // the even grid on which 0.7 lies
    EXPECT_EQ((snapshot.deformed[2]->key_count - 1) % 10, 0u);
    for (const auto& mesh : snapshot.deformed) EXPECT_LE(mesh->error_px, stage.shot.render.motion_tolerance_px);
}

TEST(BendingCopies, ThatWouldTakeTooMuchMemoryAreRefusedWithTheFigure) {
    StripStage stage;
    GeometryData& strip = stage.scene.geometries[0];
    strip.positions.resize(20'000);
    strip.skin.joints.resize(20'000);
    strip.skin.weights.resize(20'000, 1);
    strip.targets[0].positions.resize(20'000);
    std::vector<double> offsets(10'000);
    for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] = static_cast<double>(i) / 1024;
    stage.copies(offsets);
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:5:14: error: the mesh of node 'stage/strip' (20000 vertices) bends at 10000 clip offsets: all bending copies together take about 51 GB\n"
              "  expected at most 16 GB: copies with equal offsets share their vertices, so give fewer different ones (offset_steps), or a coarser mesh");
    std::fill(offsets.begin(), offsets.end(), 0.5);
    stage.copies(offsets);
    EXPECT_EQ(message_of([&] { stage.bind(); }), "no error");
}

}  // namespace
}  // namespace kadr
