// What several layers of clips drive at once: numbers and colours are mixed by weight, switches go to the greatest weight.
#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "frame/bindings.h"
#include "frame/layered_switch.h"
#include "stage.h"

namespace kadr {
namespace {

using test::Stage;
using test::track;

/// A spot of 10 cd without a range, red in clip 0 and green in clip 1.
struct Lamp : Stage {
    Lamp() {
        SceneLight spot;
        spot.kind = kernels::LightKind::spot;
        spot.intensity = 10;
        scene.lights.push_back(spot);
        node(add_node("lamp", -1, false)).light = 0;
        drive(0, Property::light_color, 0, Track<glm::dvec3>(glm::dvec3(1, 0, 0)));
        drive(1, Property::light_color, 0, Track<glm::dvec3>(glm::dvec3(0, 1, 0)));
        drive(0, Property::light_intensity, 0, track<double>({{0, 20}, {10, 30}}));
        play({Track<double>(1.0), Track<double>(1.0)});
    }
    kernels::Light at(int frame) const { return snapshot(frame).light_keys.front(); }
};

TEST(PropertyMix, DividesWeightsByTheirSumAndFillsUpWithTheFilesOwn) {
    Lamp stage;
    stage.play({Track<double>(3.0), Track<double>(1.0)});
    EXPECT_FLOAT_EQ(stage.at(0).radiance.x, 0.75f * 20);  // clip 0 alone has the intensity
    EXPECT_FLOAT_EQ(stage.at(0).radiance.y, 0.25f * 20);
    EXPECT_FLOAT_EQ(stage.at(0).radiance.z, 0);
    stage.play({Track<double>(0.25), Track<double>(0.25)});
    const float intensity = 0.25f * 25 + 0.75f * 10;  // at 5 s
    EXPECT_FLOAT_EQ(stage.at(5).radiance.x, 0.75f * intensity);
    EXPECT_FLOAT_EQ(stage.at(5).radiance.y, 0.75f * intensity);
    EXPECT_FLOAT_EQ(stage.at(5).radiance.z, 0.5f * intensity);
    stage.play({Track<double>(0.0), Track<double>(0.0)});
    EXPECT_FLOAT_EQ(stage.at(5).radiance.x, 10);
}

TEST(PropertyMix, CrossFadesInsideTheShutter) {
    Lamp stage;
    stage.scene.clips[0].properties.pop_back();
    // The middle of the fade is a corner of the light's path: it is met, although it is no key of a clip.
    stage.play({track<double>({{0, 1}, {0.3, 0.5}, {1, 0}}), track<double>({{0, 0}, {0.3, 0.5}, {1, 1}})});
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    for (const SceneSnapshot& part : parts) EXPECT_LT(part.light_error, 1e-6);
    EXPECT_FLOAT_EQ(parts.front().light_keys.front().radiance.x, 10);
    EXPECT_FLOAT_EQ(parts.back().light_keys.back().radiance.y, 10);
}

TEST(PropertyMix, SplitsTheShutterWhereALayerJumps) {
    Lamp stage;
    stage.play({track<double>({{0, 1}, {0.25, 0}}, Interpolation::step), Track<double>(1.0)});
    stage.drive(1, Property::light_outer, 0, track<double>({{0, 0.5}, {0.5, 0.6}, {3, 0.5}}, Interpolation::step));
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_DOUBLE_EQ(parts[0].close_s, 0.25);
    EXPECT_DOUBLE_EQ(parts[1].close_s, 0.5);
    EXPECT_FLOAT_EQ(parts[0].light_keys[0].radiance.y, 0.5f * 20);
    EXPECT_FLOAT_EQ(parts[1].light_keys[0].radiance.y, 10);
    EXPECT_FLOAT_EQ(parts[1].light_keys[0].outer_rad, 0.5f);
    EXPECT_FLOAT_EQ(parts[2].light_keys[0].outer_rad, 0.6f);
    const BoundShot bound = stage.bind();
    EXPECT_THAT(bound.bindings().properties.of(0, PropertyOwner::light, 0)[0].discontinuities(0, 1, 0), testing::ElementsAre(0.25));
    // The seam of a loop, half-way into the second frame.
    stage.play({Track<double>(1.0), Track<double>(1.0)});
    stage.scene.clips[0].properties[1].track = track<double>({{0, 20}, {1.5, 30}});
    stage.layer(0).loop = ClipLayer::Loop::repeat;
    stage.layer(0).out_s = 1.5;
    ASSERT_EQ(stage.snapshots(1).size(), 2u);
    EXPECT_DOUBLE_EQ(stage.snapshots(1)[0].close_s, 1.5);
}

TEST(PropertyMix, LeavesAnInfiniteRangeWithoutAJump) {
    Lamp stage;
    stage.drive(0, Property::light_range, 0, Track<double>(5.0));
    EXPECT_FLOAT_EQ(stage.at(0).range, 5);
    stage.play({Track<double>(0.999), Track<double>(1.0)});
    EXPECT_NEAR(stage.at(0).range, 5, 0.01);
    stage.play({Track<double>(0.25), Track<double>(1.0)});
    EXPECT_FLOAT_EQ(stage.at(0).range, 20);
    stage.play({Track<double>(0.0), Track<double>(1.0)});
    EXPECT_EQ(stage.at(0).range, 0);  // infinite
    stage.scene.lights[0].range_m = 9;
    stage.play({Track<double>(0.25), Track<double>(1.0)});
    EXPECT_FLOAT_EQ(stage.at(0).range, 8);
}

TEST(PropertyMix, HoldsForMaterials) {
    Stage stage;
    stage.add_node("cube");
    stage.scene.material_names = {"Paint"};
    stage.scene.material_sources.resize(1);
    stage.scene.material_sources[0].index = 0;
    stage.scene.material_sources[0].emissive = {1, 1, 1};
    stage.scene.files[0].material_count = 1;
    stage.scene.materials[0].base_color_texture.texture = 0;
    stage.drive(0, Property::roughness, 0, Track<double>(0.5));
    stage.drive(1, Property::roughness, 0, Track<double>(0.25));
    stage.drive(0, Property::emissive_strength, 0, Track<double>(9.0));
    stage.drive(1, Property::texture_offset, 0, Track<glm::dvec2>(glm::dvec2(0.5, 1)));
    stage.play({Track<double>(0.25), Track<double>(0.5)});
    const SceneSnapshot snapshot = stage.snapshot();
    const kernels::Material& paint = snapshot.materials.at(snapshot.instances.at(0).material);
    EXPECT_FLOAT_EQ(paint.roughness, 0.25f * 0.5f + 0.5f * 0.25f + 0.25f);
    EXPECT_FLOAT_EQ(paint.emission.x, 0.25f * 9 + 0.75f);
    EXPECT_FLOAT_EQ(paint.base_color_texture.m02, 0.25f);
}

TEST(PropertyMix, HoldsForCameras) {
    Stage stage;
    stage.scene.cameras.push_back({"Lens", false, 0.8, 0, 1, 1, 0.1, 0});
    stage.node(stage.add_node("camera", -1, false)).camera = 0;
    stage.shot.camera.gltf = NodeReference{"stage/camera", {}};
    stage.drive(0, Property::camera_yfov, 0, Track<double>(0.4));
    stage.drive(1, Property::camera_yfov, 0, Track<double>(0.6));
    stage.drive(1, Property::camera_zfar, 0, Track<double>(50.0));
    stage.play({Track<double>(0.5), Track<double>(0.25)});
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_FLOAT_EQ(snapshot.camera_keys.front().tan_half_height, std::tan(0.5f * (0.5f * 0.4f + 0.25f * 0.6f + 0.25f * 0.8f)));
    EXPECT_FLOAT_EQ(snapshot.camera.far_clip, 200);
}

TEST(PropertyMix, OfOneLayerTheLaterClipCounts) {
    Lamp stage;
    stage.drive(1, Property::light_intensity, 0, Track<double>(40.0));
    ClipLayer all;
    all.weight = Track<double>(0.5);
    stage.shot.scenes[0].layers = {all};
    EXPECT_FLOAT_EQ(stage.at(0).radiance.y, 0.5f * 40 + 0.5f * 10);
    EXPECT_FLOAT_EQ(stage.at(0).radiance.x, 0.5f * 25);
}

// ---- Switches ----

/// A cube that clip 0 hides and clip 1 shows.
struct Blinker : Stage {
    explicit Blinker(bool own = true) {
        node(add_node("cube")).visible = own;
        drive(0, Property::node_visible, 0, track<double>({{0, 0}}, Interpolation::step));
        drive(1, Property::node_visible, 0, track<double>({{0, 1}}, Interpolation::step));
    }
    bool visible() const { return snapshot().instances[0].mask != 0; }
    bool with(double first, double second) {
        play({Track<double>(first), Track<double>(second)});
        return visible();
    }
};

TEST(SwitchMix, GoesToTheGreatestWeightAndOfEqualOnesToTheLater) {
    Blinker stage;
    EXPECT_FALSE(stage.with(1, 0.9));
    EXPECT_TRUE(stage.with(0.9, 1));
    EXPECT_TRUE(stage.with(1, 1));
    EXPECT_TRUE(stage.with(0.3, 0));  // its own weight is 0.7
    EXPECT_FALSE(stage.with(0.5, 0));  // equal to its own: the layer comes later
    Blinker hidden(false);
    EXPECT_FALSE(hidden.with(0, 0.4));
    EXPECT_TRUE(hidden.with(0, 0.7));
    EXPECT_TRUE(hidden.with(0.3, 0.4));  // three candidates: 0.3 own, 0.3 and 0.4
    EXPECT_FALSE(hidden.with(0, 0));
}

TEST(SwitchMix, SplitsTheShutterAtTheHandover) {
    Blinker stage;
    stage.play({track<double>({{0, 1}, {1, 0}}), track<double>({{0, 0}, {1, 3}})});  // equal at a quarter
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_NEAR(parts[0].close_s, 0.25, 1e-11);
    EXPECT_EQ(parts[0].instances[0].mask, 0u);
    EXPECT_NE(parts[1].instances[0].mask, 0u);
    // Where both show the same there is nothing to split.
    stage.scene.clips[0].properties[0].track = track<double>({{0, 1}}, Interpolation::step);
    EXPECT_EQ(stage.snapshots().size(), 1u);
}

TEST(SwitchMix, FollowsWeightsThatRunAlongCurves) {
    Blinker stage;
    stage.play({track<double>({{0, 1}, {1, 0}}), track<double>({{0, 0}, {1, 1}})});
    for (std::size_t i = 0; i < 2; ++i) stage.layer(i).weight.keys[0].ease = Ease{0.42, 0, 1, 1};  // slow, then fast
    const BoundShot bound = stage.bind();
    const std::vector<double> times = bound.bindings().visibility.discontinuities(0, 1, {{0}});
    ASSERT_EQ(times.size(), 1u);
    EXPECT_GT(times[0], 0.6);
    EXPECT_NEAR(evaluate(stage.layer(1).weight, times[0]), 0.5, 1e-11);
}

// Whatever the weights do, the state is constant between the times that are reported. Each of them changes it, but for
// steps of weights that do not decide.
RC_GTEST_PROP(SwitchMixProperty, ChangesWhereItSaysAndNowhereElse, ()) {
    const bool own = *rc::gen::arbitrary<bool>();
    Stage stage;
    stage.node(stage.add_node("cube")).visible = own;
    const int count = *rc::gen::inRange(1, 5);
    const auto interpolation = *rc::gen::element(Interpolation::linear, Interpolation::step);
    std::vector<Track<double>> weights;
    for (int i = 0; i < count; ++i) {
        stage.drive(i, Property::node_visible, 0, track<double>({{0, *rc::gen::inRange(0, 2)}}, Interpolation::step));
        const auto weight = [] { return 0.0137 * *rc::gen::inRange(0, 100); };
        const double middle = 0.01 * *rc::gen::inRange(1, 99) + 0.001 * i;
        weights.push_back(track<double>({{0, weight()}, {middle, weight()}, {1, weight()}}, interpolation));
    }
    stage.play(weights);
    const BoundShot bound = stage.bind();
    const VisibilityRig& rig = bound.bindings().visibility;
    std::vector<double> times = rig.discontinuities(0, 1, {{0}});
    std::sort(times.begin(), times.end());
    times.insert(times.begin(), 0);
    times.push_back(1);
    for (std::size_t i = 1; i < times.size(); ++i) {
        // Jumps that fall together but for rounding are one.
        const double length = times[i] - times[i - 1], inset = 1e-9;
        if (length <= 2 * inset) continue;
        const bool state = rig.at(times[i - 1] + inset).visible(0);
        for (int step = 0; step <= 500; ++step) RC_ASSERT(rig.at(std::lerp(times[i - 1] + inset, times[i] - inset, step / 500.0)).visible(0) == state);
        if (i > 1 && interpolation == Interpolation::linear) RC_ASSERT(rig.at(times[i - 1] - 1e-9).visible(0) != state);
    }
}

}  // namespace
}  // namespace kadr
