// What stands still is made once, and snapshots share it.

#include <gtest/gtest.h>

#include "frame/bindings.h"
#include "stage.h"

namespace kadr {
namespace {

using test::Stage;
using test::track;

/// A node that drifts, between two that stand still; the camera moves by whole metres a frame.
Stage mixed_stage(double camera_step) {
    Stage stage;
    stage.add_node("first");
    stage.animate(stage.add_node("drifts")).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {10, {10, 0, 0}}});
    stage.add_node("last");
    stage.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {10, {0, 0, 5 + 10 * camera_step}}});
    return stage;
}

TEST(StillInstances, AreOneObjectForAllFramesWithTheirRenderOrigin) {
    const Stage stage = mixed_stage(0.1);
    const BoundShot bound = stage.bind();
    const SceneSnapshot a = make_snapshots(bound, bound.sequence().frame(0)).front(), b = make_snapshots(bound, bound.sequence().frame(1)).front();
    ASSERT_EQ(a.render_origin, b.render_origin);
    ASSERT_EQ(a.instances.shared_size(), 2u);
    EXPECT_EQ(a.instances.shared(), b.instances.shared());
    EXPECT_EQ(a.motion.srt.shared(), b.motion.srt.shared());
    EXPECT_EQ(a.fixed_places.shared(), b.fixed_places.shared());
    EXPECT_EQ(a.still_key, b.still_key);
    EXPECT_NE(a.geometry_key, b.geometry_key);  // the other drifts
    const std::uint32_t ids[] = {0, 2, 1};
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(a.instances[i].id, ids[i]) << i;
}

TEST(StillInstances, FollowTheRenderOrigin) {
    Stage stage = mixed_stage(1e4);
    stage.shot.camera.look_at = track<glm::dvec3>({{0, {0, 0, 0}}, {10, {0, 0, 1e5}}});
    const BoundShot bound = stage.bind();
    const SceneSnapshot near = make_snapshots(bound, bound.sequence().frame(0)).front(), far = make_snapshots(bound, bound.sequence().frame(2)).front();
    ASSERT_NE(near.render_origin, far.render_origin);
    EXPECT_NE(near.instances.shared(), far.instances.shared());
    for (const SceneSnapshot* snapshot : {&near, &far})
        EXPECT_EQ(interpolate(snapshot->motion, 1, 0)[3].z + snapshot->render_origin.z, 0);
    // Back again it is the object of before.
    EXPECT_EQ(make_snapshots(bound, bound.sequence().frame(0)).front().instances.shared(), near.instances.shared());
}

TEST(StillInstances, DoNotHoldWhatIsEverHiddenOrBends) {
    Stage stage = mixed_stage(0);
    stage.shot.scenes[0].visible = SwitchTrack{};
    stage.shot.scenes[0].visible.keys = {test::key(0.0, 1.0), test::key(1.0, 0.0)};
    stage.shot.scenes[0].visible.interpolation = Interpolation::step;
    const BoundShot bound = stage.bind();
    EXPECT_TRUE(bound.bindings().still.empty());
    EXPECT_EQ(make_snapshots(bound, bound.sequence().frame(0)).front().instances[0].mask, 0xffffffffu);
    EXPECT_EQ(make_snapshots(bound, bound.sequence().frame(1)).front().instances[0].mask, 0u);
}

TEST(StillInstances, HaveTheirFixedPlacesBeforeThoseOfWhatBlinks) {
    Stage stage;
    stage.node(stage.add_node("blinks")).translation = {2, 0, 0};
    stage.node(stage.add_node("stays")).translation = {1, 0, 0};
    NodeOverride blinks;
    blinks.name = "blinks";
    blinks.visible = track<double>({{0, 1}, {1, 0}}, Interpolation::step);
    stage.shot.scenes[0].nodes = {blinks};
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.instances.shared_size(), 1u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(snapshot.instances[i].fixed_place, static_cast<int>(i));
        EXPECT_EQ(snapshot.fixed_places[i][3].x, 1 + static_cast<double>(i));
    }
}

TEST(StillInstances, KeepTheirIndicesApartFromThoseThatMove) {
    Stage stage = mixed_stage(0);
    stage.shot.scenes[0].transform.translate = test::track<glm::dvec3>({{0, {7, 0, 0}}});
    stage.node(0).rotation = test::turn(30);
    stage.node(1).rotation = test::turn(50);
    const SceneSnapshot snapshot = stage.snapshot(2);
    for (std::size_t i = 0; i < 3; ++i) {
        const double x = snapshot.instances[i].id == 1 ? 9 : 7;
        EXPECT_NEAR(interpolate(snapshot.motion, i, 0)[3].x + snapshot.render_origin.x, x, 1e-5) << i;
    }
    EXPECT_EQ(snapshot.instances[0].fixed_place, 0);
    EXPECT_EQ(snapshot.instances[1].fixed_place, 1);
    EXPECT_EQ(snapshot.instances[2].fixed_place, -1);
}

/// Frames hold the lists of what stands still by reference: nothing is copied, fitted or compared (`kadr_bench` times it).
TEST(StillInstances, AHundredThousandAreSharedByAllFrames) {
    Stage stage;
    stage.add_node("Body");
    InstancesSpec spec;
    spec.grid = GridSpec{{100, 10, 100}, glm::dvec3(2), 0};
    stage.shot.scenes[0].instances = spec;
    const BoundShot bound = stage.bind();
    const SceneSnapshot first = make_snapshots(bound, bound.sequence().frame(0)).front();
    ASSERT_EQ(first.instances.size(), 100'000u);
    for (int frame = 1; frame <= 20; ++frame) {
        const SceneSnapshot next = make_snapshots(bound, bound.sequence().frame(frame)).front();
        EXPECT_EQ(next.geometry_key, first.geometry_key);
        EXPECT_EQ(next.instances.shared(), first.instances.shared());
        EXPECT_EQ(next.fixed_places.shared(), first.fixed_places.shared());
        EXPECT_EQ(next.motion.headers.shared(), first.motion.headers.shared());
        EXPECT_EQ(next.instances.own().size() + next.fixed_places.own().size() + next.motion.headers.own().size(), 0u);
    }
}

}  // namespace
}  // namespace kadr
