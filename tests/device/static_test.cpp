// What does not change between frames is not built again.
#include <gtest/gtest.h>

#include "device/rendered_frame.h"

namespace kadr::test {
namespace {

StructureCounts set_frame(Device& device, const Stage& stage, int frame) {
    device.set_frame(stage.snapshots(frame).front());
    return device.statistics().structures;
}

std::unique_ptr<Device> device_with(const Stage& stage) {
    std::unique_ptr<Device> device = make_device({"cpu", 1, 0}).device;
    device->load(stage.scene, nullptr);
    return device;
}

/// Two squares that stand still, one flattened and one behind a node that swings from frame 100 on.
Stage swinging_later() {
    GlowingStage stage;
    stage.add_node("Still");
    const int swing = stage.add_node("Swing");
    stage.animate(swing).rotation = track<glm::dquat>({{100 / 24.0, turn(0)}, {200 / 24.0, turn(90)}});
    return stage;
}

TEST(StaticFrame, BuildsNothingAgain) {
    const Stage stage = swinging_later();
    const auto device = device_with(stage);
    // What is flattened, the swinging mesh, and all instances together.
    EXPECT_EQ(set_frame(*device, stage, 0), (StructureCounts{3, 0, 0}));
    EXPECT_EQ(set_frame(*device, stage, 1), (StructureCounts{0, 0, 3}));
    EXPECT_EQ(set_frame(*device, stage, 2), (StructureCounts{0, 0, 3}));
}

TEST(StaticFrame, AMovingCameraOrLightBuildsNothing) {
    Stage stage = swinging_later();
    stage.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {1, {0.1, 0, 5}}});
    LightSpec light;
    light.strength = track<double>({{0, 1.0}, {1, 2.0}});
    stage.shot.lights.push_back(light);
    const auto device = device_with(stage);
    set_frame(*device, stage, 0);
    EXPECT_EQ(set_frame(*device, stage, 1).built, 0u);
}

TEST(StaticFrame, MovingInstancesLeaveTheirMeshesAlone) {
    const Stage stage = swinging_later();
    const auto device = device_with(stage);
    set_frame(*device, stage, 0);
    const StructureCounts moving = set_frame(*device, stage, 150);
    EXPECT_EQ(moving.kept, 2u);  // what is flattened, and the mesh
    EXPECT_EQ(moving.built + moving.updated, 1u);
}

TEST(ClosedShutter, CostsNoMotion) {
    // shutter: 0 in the middle of the swing: one frame an instance, one key, and Embree sees nothing that moves.
    Stage stage = swinging_later();
    stage.shot.shutter = {0, 0};
    stage.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {10, {3, 0, 5}}});
    const std::vector<SceneSnapshot> parts = stage.snapshots(150);
    ASSERT_EQ(parts.size(), 1u);
    for (const kernels::TransformHeader& header : parts[0].motion.headers) EXPECT_EQ(header.frame_count, 1u);
    EXPECT_EQ(parts[0].camera_keys.size(), 1u);
    EXPECT_TRUE(parts[0].shutter.plain);
    const auto device = device_with(stage);
    device->set_frame(parts[0]);
    EXPECT_EQ(device->statistics().instances, 1u);
    EXPECT_EQ(device->statistics().moving_instances, 0u);
}

}  // namespace
}  // namespace kadr::test
