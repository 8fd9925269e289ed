// Materials, variants and visibility over time, as snapshots hold them.
#include <gtest/gtest.h>

#include "frame/bindings.h"
#include "stage.h"

namespace kadr {
namespace {

using test::message_of;
using test::Stage;
using test::track;

/// A stage with two materials, "Paint" and "Glow"; node 0 wears the first, node 1 the second.
struct PaintStage : Stage {
    PaintStage() {
        scene.materials.resize(2);
        scene.material_names = {"Paint", "Glow"};
        scene.material_sources.resize(2);
        scene.material_sources[0].index = 0;
        scene.material_sources[1].index = 1;
        scene.material_sources[1].emissive = {1, 0.5, 0};
        scene.material_sources[1].emissive_strength = 8;
        scene.materials[1].emission = {8, 4, 0};
        scene.files[0].material_count = 2;
        add_node("painted");
        add_node("glowing");
        node(1).primitives[0].material = 1;
    }
    MaterialSpec& change(const char* name) {
        MaterialSpec spec;
        spec.name = name;
        spec.where = {"stage.yaml", 6, 5};
        shot.scenes[0].materials.push_back(spec);
        return shot.scenes[0].materials.back();
    }
    /// The material that an instance wears in a snapshot.
    kernels::Material worn(const SceneSnapshot& snapshot, std::size_t instance) const {
        return (snapshot.materials.empty() ? scene.materials : snapshot.materials).at(snapshot.instances.at(instance).material);
    }
};

TEST(Materials, StayTheScenesWhereNothingChangesThem) {
    PaintStage stage;
    EXPECT_TRUE(stage.snapshot().materials.empty());
}

TEST(Materials, AreEvaluatedInTheMiddleOfTheShutter) {
    PaintStage stage;
    stage.change("Paint").base_color = track<glm::dvec3>({{0, {0, 0, 0}}, {100, {1, 0.5, 0}}});
    const SceneSnapshot snapshot = stage.snapshot(50);  // 50 s to 51 s
    EXPECT_FLOAT_EQ(stage.worn(snapshot, 0).base_color.x, 0.505f);
    EXPECT_FLOAT_EQ(stage.worn(snapshot, 0).base_color.y, 0.2525f);
    EXPECT_EQ(snapshot.materials.size(), 3u);  // the file's two, and a copy
    EXPECT_EQ(snapshot.materials[0].base_color.x, 1);
}

TEST(Materials, EveryFactorHasItsTrack) {
    PaintStage stage;
    MaterialSpec& paint = stage.change("Paint");
    paint.metallic = Track<double>(0.25);
    paint.roughness = Track<double>(0.5);
    paint.ior = Track<double>(2.0);
    paint.emissive = Track<glm::dvec3>(glm::dvec3(1, 2, 3));
    paint.emissive_strength = Track<double>(2.0);
    paint.alpha = Track<double>(0.75);
    paint.alpha_cutoff = Track<double>(0.125);
    paint.normal_scale = Track<double>(3.0);
    const kernels::Material m = stage.worn(stage.snapshot(), 0);
    EXPECT_EQ(m.metallic, 0.25f);
    EXPECT_EQ(m.roughness, 0.5f);
    EXPECT_FLOAT_EQ(m.dielectric_f0, 1.0f / 9);
    EXPECT_EQ(m.emission.z, 6);
    EXPECT_EQ(m.alpha, 0.75f);
    EXPECT_EQ(m.alpha_mode, kernels::AlphaMode::blend);  // the file's is opaque, where alpha would mean nothing
    EXPECT_EQ(m.alpha_cutoff, 0.125f);
    EXPECT_EQ(m.normal_scale, 3);
}

TEST(Materials, ColourAndStrengthOfEmissionChangeAlone) {
    PaintStage stage;
    stage.change("Glow").emissive_strength = Track<double>(2.0);
    EXPECT_EQ(stage.worn(stage.snapshot(), 1).emission.y, 1);
    stage.shot.scenes[0].materials[0].emissive_strength.reset();
    stage.shot.scenes[0].materials[0].emissive = Track<glm::dvec3>(glm::dvec3(0, 0, 1));
    EXPECT_EQ(stage.worn(stage.snapshot(), 1).emission.z, 8);
    EXPECT_EQ(stage.worn(stage.snapshot(), 1).emission.x, 0);
}

TEST(Materials, OfOneNameChangeTogether) {
    PaintStage stage;
    stage.scene.material_names[1] = "Paint";
    stage.change("Paint").roughness = Track<double>(0.5);
    EXPECT_EQ(stage.worn(stage.snapshot(), 0).roughness, 0.5f);
    EXPECT_EQ(stage.worn(stage.snapshot(), 1).roughness, 0.5f);
}

/// The same file once more, as the loader does it: own nodes, shared materials.
void add_second_entry(Stage& stage) {
    stage.shot.scenes.push_back(stage.shot.scenes[0]);
    stage.shot.scenes[1].id = "again";
    stage.shot.scenes[1].materials.clear();
    SceneFile file = stage.scene.files[0];
    file.id = "again";
    file.first_node = static_cast<int>(stage.scene.nodes.size());
    for (int& root : file.roots) root += file.first_node;
    for (int i = 0; i < file.node_count; ++i) stage.scene.nodes.push_back(stage.scene.nodes[static_cast<std::size_t>(i)]);
    stage.scene.files.push_back(file);
}

TEST(Materials, OfOtherEntriesOfTheFileStay) {
    PaintStage stage;
    stage.change("Paint").roughness = Track<double>(0.5);
    add_second_entry(stage);
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.instances.size(), 4u);
    EXPECT_EQ(stage.worn(snapshot, 0).roughness, 0.5f);
    EXPECT_EQ(stage.worn(snapshot, 2).roughness, 1);
}

TEST(Materials, UnknownNamesAreRefused) {
    PaintStage stage;
    stage.change("Pant");
    EXPECT_EQ(message_of([&] { stage.bind(); }), "stage.yaml:6:5: error: scene 'stage' shows no material 'Pant'\n  did you mean 'Paint'?");
    stage.shot.scenes[0].materials[0].name = "Chrome and leather";
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:6:5: error: scene 'stage' shows no material 'Chrome and leather'\n  expected one of the file's materials: Paint, Glow");
}

TEST(Materials, ThatJumpSplitTheShutter) {
    PaintStage stage;
    stage.change("Paint").roughness = track<double>({{0, 1}, {0.25, 0.5}}, Interpolation::step);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(stage.worn(parts[0], 0).roughness, 1);
    EXPECT_EQ(stage.worn(parts[1], 0).roughness, 0.5f);
    EXPECT_DOUBLE_EQ(parts[0].weight, 0.25);
}

TEST(Materials, ThatChangeFastSplitTheShutter) {
    PaintStage stage;
    stage.change("Paint").base_color = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 1, 1}}});
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 8u);  // an eighth at most in each
    double mean = 0, mean_square = 0;
    for (const SceneSnapshot& part : parts) {
        const double color = stage.worn(part, 0).base_color.x;
        mean += part.weight * color;
        mean_square += part.weight * color * color;
    }
    EXPECT_NEAR(mean, 0.5, 1e-7);
    EXPECT_NEAR(mean_square, 1.0 / 3, 1.0 / 768);  // light that met the surface twice
    stage.shot.scenes[0].materials[0].base_color = track<glm::dvec3>({{0, {0, 0, 0}}, {8, {1, 1, 1}}});
    EXPECT_EQ(stage.snapshots().size(), 1u);
}

TEST(Materials, LinearEmissionNeedsNoSplit) {
    PaintStage stage;
    stage.change("Glow").emissive_strength = track<double>({{0, 0}, {1, 100}});
    ASSERT_EQ(stage.snapshots().size(), 1u);  // radiance is linear in it: the middle is the mean
    EXPECT_FLOAT_EQ(stage.worn(stage.snapshot(), 1).emission.x, 50);
    stage.shot.scenes[0].materials[0].emissive_strength = track<double>({{0, 0}, {0.5, 100}, {1, 0}});
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_FLOAT_EQ(stage.worn(parts[0], 1).emission.x, 50);
}

TEST(Variants, ChooseTheMaterial) {
    PaintStage stage;
    stage.scene.files[0].variants = {"Day", "Night"};
    stage.node(0).primitives[0].variants = {{1, 1}};
    EXPECT_EQ(stage.snapshot().instances[0].material, 0u);
    stage.shot.scenes[0].variant = "Night";
    EXPECT_EQ(stage.snapshot().instances[0].material, 1u);
    stage.shot.scenes[0].variant = "Day";  // no mapping of its own
    EXPECT_EQ(stage.snapshot().instances[0].material, 0u);
    stage.shot.scenes[0].variant = "Nigth";
    stage.shot.scenes[0].variant_where = {"stage.yaml", 7, 14};
    EXPECT_EQ(message_of([&] { stage.bind(); }), "stage.yaml:7:14: error: scene 'stage' has no variant 'Nigth'\n  did you mean 'Night'?");
    stage.scene.files[0].variants.clear();
    EXPECT_EQ(message_of([&] { stage.bind(); }), "stage.yaml:7:14: error: scene 'stage' has no variant 'Nigth'\n  the file has no variants; remove the key");
}

TEST(Visibility, OfASceneSplitsTheShutterWhereItJumps) {
    PaintStage stage;
    stage.shot.scenes[0].visible = track<double>({{0, 0}, {0.25, 1}}, Interpolation::step);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].instances[0].mask, 0u);
    EXPECT_EQ(parts[1].instances[0].mask, 0xffffffffu);
    EXPECT_DOUBLE_EQ(parts[1].weight, 0.75);
}

TEST(Visibility, OfANodeHoldsForAllBelowIt) {
    PaintStage stage;
    const int parent = stage.add_node("parent", -1, false), child = stage.add_node("child", parent);
    SceneLight lamp;
    stage.scene.lights.push_back(lamp);
    stage.node(child).light = 0;
    EXPECT_EQ(stage.snapshot().lights.size(), 1u);
    stage.node(parent).visible = false;
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_EQ(snapshot.instances[0].mask, 0xffffffffu);
    EXPECT_EQ(snapshot.instances[2].mask, 0u);
    EXPECT_TRUE(snapshot.lights.empty());
}

TEST(Visibility, OfTheShotsNodesReplacesWhatTheFileSays) {
    PaintStage stage;
    const int child = stage.add_node("child", 0);
    stage.node(child).visible = false;
    NodeOverride painted, shown;
    painted.name = "painted";
    painted.visible = track<double>({{0, 1}, {0.75, 0}}, Interpolation::step);
    shown.name = "child";
    shown.visible = SwitchTrack(1.0);
    stage.shot.scenes[0].nodes = {painted, shown};
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_DOUBLE_EQ(parts[0].weight, 0.75);
    const auto mask = [&](std::size_t part, std::uint32_t id) {
        for (const SnapshotInstance& instance : parts[part].instances)
            if (instance.id == id) return instance.mask;
        return 1u;
    };
    EXPECT_EQ(mask(0, 0), 0xffffffffu);
    EXPECT_EQ(mask(0, 2), 0xffffffffu);
    EXPECT_EQ(mask(1, 0), 0u);
    EXPECT_EQ(mask(1, 2), 0u);  // below it
    EXPECT_EQ(mask(1, 1), 0xffffffffu);
}

TEST(Visibility, OfASceneThatIsOffStaysOff) {
    PaintStage stage;
    stage.scene.lights.emplace_back();
    stage.node(0).light = 0;
    EXPECT_EQ(stage.snapshot().lights.size(), 1u);
    stage.shot.scenes[0].visible = SwitchTrack(0.0);
    const SceneSnapshot snapshot = stage.snapshot();
    for (const SnapshotInstance& instance : snapshot.instances) EXPECT_EQ(instance.mask, 0u);
    EXPECT_TRUE(snapshot.lights.empty());
}

TEST(Visibility, ASwitchBelowAnotherNeedsBoth) {
    PaintStage stage;
    stage.add_node("child", 0);
    NodeOverride above, below;
    above.name = "painted";
    above.visible = track<double>({{0, 1}, {0.5, 0}}, Interpolation::step);
    below.name = "child";
    below.visible = track<double>({{0, 0}, {0.25, 1}}, Interpolation::step);
    stage.shot.scenes[0].nodes = {above, below};
    for (const double offset : {0.0, 3.0}) {
        if (offset != 0) {  // copies ask every switch above in their own time; that of the node "glowing" follows a clip
            stage.drive(0, Property::node_visible, 1, track<double>({{0, 1}, {100, 0}}, Interpolation::step));
            stage.shot.scenes[0].instances.emplace().list = {{{0, 0, 0}, {1, 0, 0, 0}, glm::dvec3(1), offset}};
        }
        const std::vector<SceneSnapshot> parts = stage.snapshots();
        ASSERT_EQ(parts.size(), 3u);
        const auto shown = [&](std::size_t part, std::uint32_t id) {
            for (const SnapshotInstance& instance : parts[part].instances)
                if (instance.id == id) return instance.mask != 0;
            ADD_FAILURE() << "no instance " << id;
            return false;
        };
        for (std::size_t part = 0; part < 3; ++part) {
            EXPECT_EQ(shown(part, 0), part < 2) << part << ' ' << offset;
            EXPECT_EQ(shown(part, 2), part == 1) << part << ' ' << offset;
        }
    }
}

TEST(Visibility, OfClipsFollowsTheClipsTime) {
    PaintStage stage;
    stage.animate(0);
    PropertyChannel blink;
    blink.property = Property::node_visible;
    blink.index = 1;
    blink.track = track<double>({{0, 1}, {4, 0}}, Interpolation::step);
    stage.scene.clips[0].properties.push_back(blink);
    stage.shot.scenes[0].layers[0].speed = 8;  // jumps at half a second
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_DOUBLE_EQ(parts[0].weight, 0.5);
    EXPECT_EQ(parts[0].instances[1].mask, 0xffffffffu);
    EXPECT_EQ(parts[1].instances[1].mask, 0u);
    EXPECT_EQ(parts[1].instances[0].mask, 0xffffffffu);
}

}  // namespace
}  // namespace kadr
