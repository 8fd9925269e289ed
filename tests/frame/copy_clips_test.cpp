// What clips drive in copies of a scene that play them at other times: lights, visibility, materials, cameras.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frame/bindings.h"
#include "stage.h"

namespace kadr {
namespace {

using test::message_of;
using test::Stage;
using test::track;

/// Copies of the stage side by side, with these clip offsets.
InstancesSpec copies_at(const std::vector<double>& offsets_s) {
    InstancesSpec spec;
    spec.where = {"stage.yaml", 5, 14};
    for (const double offset : offsets_s) spec.list.push_back({{static_cast<double>(spec.list.size()), 0, 0}, {1, 0, 0, 0}, glm::dvec3(1), offset});
    return spec;
}

TEST(CopyClips, MoveTheLightsOfEveryCopyInItsOwnTime) {
    Stage stage;
    stage.scene.lights.resize(1);
    stage.node(stage.add_node("lamp", -1, false)).light = 0;
    stage.drive(0, Property::light_intensity, 0, track<double>({{0, 0}, {10, 10}}));
    stage.drive(0, Property::light_range, 0, track<double>({{0, 1}, {4.25, 2}, {8, 3}}, Interpolation::step));
    stage.shot.scenes[0].instances = copies_at({0, 2.5, 4});
    const std::vector<SceneSnapshot> parts = stage.snapshots(0);  // 0 s to 1 s: the range jumps at 0.25 s for the last copy
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_DOUBLE_EQ(parts[0].close_s, 0.25);
    const auto first_key = [](const SceneSnapshot& part, std::size_t light) { return part.light_keys[part.lights[light].first]; };
    EXPECT_FLOAT_EQ(first_key(parts[0], 0).radiance.x, 0);
    EXPECT_FLOAT_EQ(first_key(parts[0], 1).radiance.x, 2.5);
    EXPECT_FLOAT_EQ(first_key(parts[0], 2).radiance.x, 4);
    EXPECT_EQ(first_key(parts[0], 2).range, 1);
    EXPECT_EQ(first_key(parts[1], 2).range, 2);
    EXPECT_EQ(first_key(parts[1], 1).range, 1);
}

TEST(CopyClips, KeysOfLightsAreMetInEveryCopy) {
    Stage stage;
    stage.scene.lights.resize(1);
    stage.node(stage.add_node("lamp", -1, false)).light = 0;
    stage.drive(0, Property::light_intensity, 0, track<double>({{0, 1}, {2.8, 1}, {3, 9}, {10, 9}}));
    stage.shot.scenes[0].instances = copies_at({0, 2.5});
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_EQ(snapshot.lights[0].count, 1u);
    EXPECT_GT(snapshot.lights[1].count, 2u);
    EXPECT_LT(snapshot.light_error, 1e-6);
}

TEST(CopyClips, HideTheNodesOfEveryCopyInItsOwnTime) {
    Stage stage;
    const int parent = stage.add_node("parent", -1, false), cube = stage.add_node("cube", parent);
    stage.scene.lights.resize(1);
    stage.node(cube).light = 0;
    stage.drive(0, Property::node_visible, parent, track<double>({{0, 1}, {2, 0}, {3.5, 1}}, Interpolation::step));
    stage.shot.scenes[0].instances = copies_at({0, 1.25, 3});  // hidden from 2 to 3.5 s, 0.75 to 2.25 s, -1 to 0.5 s
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_DOUBLE_EQ(parts[0].close_s, 0.5);
    EXPECT_DOUBLE_EQ(parts[1].close_s, 0.75);
    const auto seen = [](const SceneSnapshot& part) {
        std::vector<bool> all;
        for (const SnapshotInstance& instance : part.instances) all.push_back(instance.mask != 0);
        return all;
    };
    EXPECT_THAT(seen(parts[0]), testing::ElementsAre(true, true, false));
    EXPECT_THAT(seen(parts[1]), testing::ElementsAre(true, true, true));
    EXPECT_THAT(seen(parts[2]), testing::ElementsAre(true, false, true));
    EXPECT_EQ(parts[0].lights.size(), 2u);
    EXPECT_EQ(parts[1].lights.size(), 3u);
    // The shot's own switches keep to the shot's time.
    NodeOverride shown;
    shown.name = "parent";
    shown.visible = track<double>({{0, 1}, {2, 0}}, Interpolation::step);
    stage.shot.scenes[0].nodes = {shown};
    EXPECT_EQ(stage.snapshots().size(), 1u);
}

/// A cube whose paint gets lighter by a clip.
struct Painted : Stage {
    Painted() {
        add_node("cube");
        scene.material_names = {"Paint"};
        scene.material_sources.resize(1);
        scene.material_sources[0].index = 0;
        scene.files[0].material_count = 1;
        drive(0, Property::metallic, 0, track<double>({{0, 0}, {1000, 1}}));
    }
    std::vector<float> metallic() const {
        const SceneSnapshot shown = snapshot();
        std::vector<float> values;
        for (const SnapshotInstance& instance : shown.instances) values.push_back(shown.materials.at(instance.material).metallic);
        return values;
    }
};

TEST(CopyClips, GiveEveryCopyAMaterialOfItsTime) {
    Painted stage;
    stage.shot.scenes[0].instances = copies_at({99.5, 499.5, -100, 99.5});
    EXPECT_THAT(stage.metallic(), testing::ElementsAre(0.1f, 0.5f, 0.0f, 0.1f));
    EXPECT_EQ(stage.snapshot().materials.size(), 1u + 3u);  // the file's own and one for each time
    // A clip that stands still needs but one.
    stage.layer(0).speed = 0;
    stage.layer(0).start_s = 250;
    EXPECT_THAT(stage.metallic(), testing::Each(0.25f));
    EXPECT_EQ(stage.snapshot().materials.size(), 1u + 1u);
}

TEST(CopyClips, SplitTheShutterWhereAMaterialOfACopyJumps) {
    Painted stage;
    stage.scene.clips[0].properties[0].track = track<double>({{0, 0}, {2.75, 1}}, Interpolation::step);
    stage.shot.scenes[0].instances = copies_at({0, 2.5});
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_DOUBLE_EQ(parts[0].close_s, 0.25);
    EXPECT_EQ(parts[0].materials.at(parts[0].instances[1].material).metallic, 0);
    EXPECT_EQ(parts[1].materials.at(parts[1].instances[1].material).metallic, 1);
    EXPECT_EQ(parts[1].materials.at(parts[1].instances[0].material).metallic, 0);
}

TEST(CopyClips, RefuseMoreMaterialsThanMeshesCanHave) {
    Painted stage;
    std::vector<double> offsets;
    for (int i = 0; i < 1025; ++i) offsets.push_back(0.125 * i);
    stage.shot.scenes[0].instances = copies_at(offsets);
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:5:14: error: copies play clips at 1025 different times, and the clips change material 'Paint' of scene 'stage'\n"
              "  expected at most 1024: every time needs a material of its own; take fewer copies, or offsets that repeat");
    for (double& offset : offsets) offset = std::fmod(offset, 16);
    stage.shot.scenes[0].instances = copies_at(offsets);
    EXPECT_EQ(stage.snapshot().materials.size(), 1u + 128u);
}

TEST(CopyClips, TheAuthoredCameraIsThatOfTheFirstCopy) {
    Stage stage;
    stage.scene.cameras.push_back({"Lens", false, 0.8, 0, 1, 1, 0.1, 0});
    stage.node(stage.add_node("camera", -1, false)).camera = 0;
    stage.shot.camera.gltf = NodeReference{"stage/camera", {}};
    stage.drive(0, Property::camera_yfov, 0, track<double>({{0, 0.4}, {10, 0.8}}));
    stage.shot.scenes[0].instances = copies_at({5, 0});
    EXPECT_FLOAT_EQ(stage.snapshot().camera_keys.front().tan_half_height, std::tan(0.5f * 0.6f));
}

}  // namespace
}  // namespace kadr
