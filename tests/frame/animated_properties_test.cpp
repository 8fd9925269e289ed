// Lights, cameras and the environment over time, and what clips drive through pointers.
#include <gtest/gtest.h>

#include "frame/bindings.h"
#include "shot/schema.h"
#include "stage.h"

namespace kadr {
namespace {

using test::Stage;
using test::track;

LightSpec sun_light() {
    LightSpec sun;
    sun.id = "sun";
    sun.where = {"stage.yaml", 20, 3};
    sun.kind = LightKind::directional;
    return sun;
}

/// A clip that drives one property of the stage's file.
template <class T>
void drive(Stage& stage, Property property, int index, Track<T> values) {
    stage.drive(0, property, index, std::move(values));
}

int add_lamp(Stage& stage) {
    SceneLight spot;
    spot.kind = kernels::LightKind::spot;
    spot.inner_rad = 0.2;
    spot.outer_rad = 0.4;
    stage.scene.lights.push_back(spot);
    const int node = stage.add_node("lamp", -1, false);
    stage.node(node).light = 0;
    return node;
}

TEST(LightTracks, RangeAndAngularDiameterHaveKeys) {
    Stage stage;
    LightSpec bulb;
    bulb.id = "bulb";
    bulb.range_m = track<double>({{0, 2}, {1, 4}});
    stage.shot.lights.push_back(bulb);
    LightSpec sun = sun_light();
    sun.angular_diameter_rad = track<double>({{0, 0.2}, {1, 0.4}});
    stage.shot.lights.push_back(sun);
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_FLOAT_EQ(snapshot.light_keys[snapshot.lights[0].first].range, 2);
    EXPECT_FLOAT_EQ(snapshot.light_keys[snapshot.lights[0].first + snapshot.lights[0].count - 1].range, 4);
    EXPECT_FLOAT_EQ(snapshot.light_keys[snapshot.lights[1].first].one_minus_cos, 2 * std::pow(std::sin(0.05f), 2));
    EXPECT_FLOAT_EQ(snapshot.light_keys[snapshot.lights[1].first + snapshot.lights[1].count - 1].one_minus_cos, 2 * std::pow(std::sin(0.1f), 2));
    EXPECT_LE(snapshot.light_error, 1e-3);
    EXPECT_GT(snapshot.light_error, 0);  // the cosine bends
}

TEST(LightTracks, ThatAreLinearHaveNoError) {
    Stage stage;
    LightSpec bulb;
    bulb.strength = track<double>({{0, 1}, {1, 2}});
    stage.shot.lights.push_back(bulb);
    EXPECT_LT(stage.snapshot().light_error, 1e-6);
    stage.shot.lights[0].strength = track<double>({{0, 1}, {0.123, 4}, {0.3211, 1}, {0.789, 3}});
    EXPECT_EQ(stage.snapshots().size(), 4u);  // more than 32 even segments would meet these keys: parts begin with them
    for (const SceneSnapshot& part : stage.snapshots()) EXPECT_LT(part.light_error, 1e-6);
    stage.shot.render.samples = 1;  // too few to split the shutter for
    EXPECT_GT(stage.snapshot().light_error, 1e-3);
    EXPECT_LT(stage.snapshot().light_error, 0.3);
}

TEST(LightTracks, SunsThatGrowFromAPointKeepASurface) {
    Stage stage;
    LightSpec sun = sun_light();
    sun.angular_diameter_rad = track<double>({{0, 0}, {1, 0.4}});
    stage.shot.lights.push_back(sun);
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_GT(snapshot.light_keys[0].one_minus_cos, 0);
    EXPECT_LT(snapshot.light_keys[0].one_minus_cos, 1e-4f);
}

TEST(LightTracks, VisibilitySplitsTheShutter) {
    Stage stage;
    LightSpec bulb;
    bulb.visible = track<double>({{0, 1}, {0.25, 0}}, Interpolation::step);
    stage.shot.lights.push_back(bulb);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].lights.size(), 1u);
    EXPECT_TRUE(parts[1].lights.empty());
    EXPECT_EQ(parts[1].environment.radiance.x, 0);  // a hidden light does not bring the default sky back
}

TEST(Environments, ThatChangeLinearlyKeepOnePart) {
    Stage stage;
    stage.shot.environment.given = true;
    stage.shot.environment.color = Track<glm::dvec3>(glm::dvec3(1, 0.5, 0));
    stage.shot.environment.strength = track<double>({{0, 0}, {1, 8}});
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_FLOAT_EQ(parts[0].environment.radiance.y, 2);
}

TEST(Environments, ThatFlashKeepTheirMean) {
    Stage stage;
    stage.shot.environment.given = true;
    stage.shot.environment.color = Track<glm::dvec3>(glm::dvec3(1));
    stage.shot.environment.strength = track<double>({{0.2, 0}, {0.5, 10}, {0.6, 0}});  // the mean is 10 * 0.4 / 2
    double mean = 0;
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    for (const SceneSnapshot& part : parts) mean += part.weight * part.environment.radiance.x;
    EXPECT_GT(parts.size(), 2u);
    EXPECT_LE(parts.size(), 16u);
    EXPECT_NEAR(mean, 2, 1e-5);  // radiance is kept in floats, and every part begins just inside of its jump
}

TEST(Environments, ThatTurnAreFollowedToHalfADegree) {
    Stage stage;
    stage.shot.environment.given = true;
    stage.shot.environment.image = "sky.exr";
    stage.shot.environment.rotate_rad = track<double>({{0, 0}, {1, 0.0349}});  // 2 degrees
    EXPECT_EQ(stage.snapshots().size(), 4u);
}

TEST(Environments, OfAnImageHaveItsStrengthAloneAndTheTurnOfTheMiddle) {
    Stage stage;
    stage.shot.environment.given = true;
    stage.shot.environment.image = "sky.exr";
    stage.shot.environment.color = Track<glm::dvec3>(glm::dvec3(0.1, 0.2, 0.3));  // of an environment without an image
    stage.shot.environment.strength = track<double>({{0, 2}, {1, 4}});
    stage.shot.environment.rotate_rad = track<double>({{0, 1}, {1, 1.008}});  // less than half a degree
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 1u);
    const EnvironmentSnapshot& sky = parts[0].environment;
    EXPECT_EQ(sky.image, "sky.exr");
    for (const float channel : {sky.radiance.x, sky.radiance.y, sky.radiance.z}) EXPECT_FLOAT_EQ(channel, 3);
    EXPECT_FLOAT_EQ(sky.rotate_rad, 1.004f);
}

TEST(Environments, ThatJumpSplitTheShutterWhicheverTrackDoes) {
    const auto jump = [](auto a, auto b) { return track<decltype(a)>({{0, a}, {0.25, b}}, Interpolation::step); };
    for (const int which : {0, 1, 2}) {
        Stage stage;
        EnvironmentSpec& sky = stage.shot.environment;
        sky.given = true;
        sky.color = Track<glm::dvec3>(glm::dvec3(1));
        if (which == 2) sky.image = "sky.exr";
        if (which == 0) sky.color = jump(glm::dvec3(1), glm::dvec3(2));
        if (which == 1) sky.strength = jump(1.0, 2.0);
        if (which == 2) sky.rotate_rad = jump(0.0, 2.0);
        const std::vector<SceneSnapshot> parts = stage.snapshots();
        ASSERT_EQ(parts.size(), 2u) << which;
        EXPECT_EQ(parts[0].close_s, 0.25) << which;
        EXPECT_FLOAT_EQ(which < 2 ? parts[1].environment.radiance.y : parts[1].environment.rotate_rad, 2) << which;
    }
}

TEST(Pointers, HoldTheInnerConeAtTheOuterOne) {
    Stage stage;
    add_lamp(stage);  // 0.2 and 0.4
    drive(stage, Property::light_inner, 0, track<double>({{0, 0.6}}));
    const kernels::Light& light = stage.snapshot().light_keys.front();
    EXPECT_FLOAT_EQ(light.inner_rad, 0.4f);
    EXPECT_FLOAT_EQ(light.cos_inner, std::cos(0.4f));
    EXPECT_FLOAT_EQ(light.outer_rad, 0.4f);
}

TEST(Pointers, DriveLights) {
    Stage stage;
    add_lamp(stage);
    drive(stage, Property::light_color, 0, track<glm::dvec3>({{0, {1, 0, 0}}, {1, {0, 1, 0}}}));
    drive(stage, Property::light_intensity, 0, track<double>({{0, 8}}));
    drive(stage, Property::light_range, 0, track<double>({{0, 5}}));
    drive(stage, Property::light_inner, 0, track<double>({{0, 0.3}}));
    drive(stage, Property::light_outer, 0, track<double>({{0, 0.6}}));
    const SceneSnapshot snapshot = stage.snapshot();
    const kernels::Light &first = snapshot.light_keys.front(), &last = snapshot.light_keys.back();
    EXPECT_FLOAT_EQ(first.radiance.x, 8);
    EXPECT_FLOAT_EQ(last.radiance.y, 8);
    EXPECT_FLOAT_EQ(last.radiance.x, 0);
    EXPECT_FLOAT_EQ(first.range, 5);
    EXPECT_FLOAT_EQ(first.inner_rad, 0.3f);
    EXPECT_FLOAT_EQ(first.outer_rad, 0.6f);
}

TEST(Pointers, KeepToTheirEntrysTime) {
    Stage stage;
    add_lamp(stage);
    drive(stage, Property::light_intensity, 0, track<double>({{0, 0}, {1000, 1000}}));
    stage.shot.scenes[0].layers[0].speed = 2;
    stage.shot.scenes[0].layers[0].start_s = 100;
    const SceneSnapshot snapshot = stage.snapshot(10);
    EXPECT_FLOAT_EQ(snapshot.light_keys.front().radiance.x, 120);
    EXPECT_FLOAT_EQ(snapshot.light_keys.back().radiance.x, 122);
    stage.shot.scenes[0].layers.clear();
    EXPECT_FLOAT_EQ(stage.snapshot(10).light_keys.front().radiance.x, 1);
}

TEST(Pointers, ThatJumpSplitTheShutter) {
    Stage stage;
    add_lamp(stage);
    drive(stage, Property::light_intensity, 0, track<double>({{0, 1}, {0.5, 3}}, Interpolation::step));
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_FLOAT_EQ(parts[0].light_keys.at(0).radiance.x, 1);
    EXPECT_FLOAT_EQ(parts[1].light_keys.at(0).radiance.x, 3);
}

TEST(Pointers, DriveCameras) {
    Stage stage;
    stage.scene.cameras.push_back({"Lens", false, 0.8, 0, 1, 1, 0.1, 0});
    const int node = stage.add_node("camera", -1, false);
    stage.node(node).camera = 0;
    stage.shot.camera.gltf = NodeReference{"stage/camera", {}};
    drive(stage, Property::camera_yfov, 0, track<double>({{0, 0.4}, {1, 0.8}}));
    drive(stage, Property::camera_znear, 0, track<double>({{0, 1}, {1, 2}}));
    drive(stage, Property::camera_zfar, 0, track<double>({{0, 50}}));
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_FLOAT_EQ(snapshot.camera_keys.front().tan_half_height, std::tan(0.2f));
    EXPECT_FLOAT_EQ(snapshot.camera_keys.back().tan_half_height, std::tan(0.4f));
    EXPECT_GT(snapshot.camera_keys.size(), 1u);
    EXPECT_FLOAT_EQ(snapshot.camera.near_clip, 1.5f);  // of the middle
    EXPECT_FLOAT_EQ(snapshot.camera.far_clip, 50);
}

TEST(Pointers, DriveMaterials) {
    Stage stage;
    stage.add_node("cube");
    stage.scene.material_names = {"Paint"};
    stage.scene.material_sources.resize(1);
    stage.scene.material_sources[0].index = 4;  // of the file's materials the fifth
    stage.scene.material_sources[0].emissive = {1, 1, 1};
    stage.scene.files[0].material_count = 1;
    stage.scene.materials[0].base_color_texture.texture = 0;
    drive(stage, Property::metallic, 4, track<double>({{0, 0.5}}));
    drive(stage, Property::emissive_strength, 4, track<double>({{0, 3}}));
    drive(stage, Property::occlusion_strength, 4, track<double>({{0, 0.25}}));
    drive(stage, Property::texture_offset, 4, track<glm::dvec2>({{0, {0.25, 0.5}}}));
    drive(stage, Property::texture_rotation, 4, track<double>({{0, test::kPi / 2}}));
    drive(stage, Property::texture_scale, 4, track<glm::dvec2>({{0, {2, 3}}}));
    const SceneSnapshot snapshot = stage.snapshot();
    const kernels::Material& m = snapshot.materials.at(snapshot.instances.at(0).material);
    EXPECT_EQ(m.metallic, 0.5f);
    EXPECT_EQ(m.emission.x, 3);
    EXPECT_EQ(m.occlusion_strength, 0.25f);
    EXPECT_FLOAT_EQ(m.base_color_texture.m02, 0.25f);
    EXPECT_FLOAT_EQ(m.base_color_texture.m12, 0.5f);
    EXPECT_NEAR(m.base_color_texture.m00, 0, 1e-6);
    EXPECT_FLOAT_EQ(m.base_color_texture.m01, 3);
    EXPECT_FLOAT_EQ(m.base_color_texture.m10, -2);
    // The shot's own track wins over the clip's.
    stage.shot.scenes[0].materials.emplace_back().name = "Paint";
    stage.shot.scenes[0].materials[0].metallic = Track<double>(0.75);
    const SceneSnapshot own = stage.snapshot();
    EXPECT_EQ(own.materials.at(own.instances.at(0).material).metallic, 0.75f);
    EXPECT_EQ(own.materials.at(own.instances.at(0).material).emission.x, 3);
}

/// The stage's only cube, with a texture in each slot but that of occlusion, which no kernel reads.
struct Textured : Stage {
    Textured() {
        add_node("cube");
        scene.material_names = {"Paint"};
        scene.material_sources.resize(1);
        scene.material_sources[0].index = 0;
        scene.files[0].material_count = 1;
        kernels::Material& paint = scene.materials[0];
        for (kernels::TextureSlot* slot : {&paint.base_color_texture, &paint.metallic_roughness_texture, &paint.normal_texture, &paint.emissive_texture}) slot->texture = 0;
    }
    template <class T>
    void move(Property property, TextureUse use, Track<T> values) {
        drive(0, property, 0, std::move(values));
        scene.clips[0].properties.back().use = use;
    }
};

TEST(MovingTextures, AreFollowedToPartsOfTheirSize) {
    using enum TextureUse;
    for (const TextureUse use : {base_color, metallic_roughness, normal, emissive}) {
        Textured shifted, still;
        shifted.move(Property::texture_offset, use, track<glm::dvec2>({{0, {0, 0}}, {1, {0, 4.0 / 256}}}));
        EXPECT_EQ(shifted.snapshots().size(), 4u) << static_cast<int>(use);
        still.move(Property::texture_offset, use, track<glm::dvec2>({{0, {0, 0}}, {1, {0, 0.9 / 256}}}));
        EXPECT_EQ(still.snapshots().size(), 1u) << static_cast<int>(use);
    }
    Textured turned, grown;
    turned.move(Property::texture_rotation, base_color, track<double>({{0, 0}, {1, 2.0 / 256}}));
    EXPECT_EQ(turned.snapshots().size(), 2u);
    grown.move(Property::texture_scale, base_color, track<glm::dvec2>({{0, {1, 1}}, {1, {1 + 2.0 / 256, 1}}}));
    EXPECT_EQ(grown.snapshots().size(), 2u);
    grown.scene.materials[0].base_color_texture.texture = -1;  // nothing is seen of it
    EXPECT_EQ(grown.snapshots().size(), 1u);
}

TEST(MovingTextures, MoveTheirOwnTextureAlone) {
    using enum TextureUse;
    Textured stage;
    stage.move(Property::texture_offset, normal, track<glm::dvec2>({{0, {0.25, 0.5}}}));
    stage.move(Property::texture_offset, emissive, track<glm::dvec2>({{0, {0.125, 0.75}}}));
    stage.move(Property::texture_scale, metallic_roughness, track<glm::dvec2>({{0, {2, 3}}}));
    const SceneSnapshot snapshot = stage.snapshot();
    const kernels::Material& m = snapshot.materials.at(snapshot.instances.at(0).material);
    EXPECT_EQ(m.base_color_texture.m02, 0);
    EXPECT_EQ(m.base_color_texture.m00, 1);
    EXPECT_EQ(m.normal_texture.m02, 0.25f);
    EXPECT_EQ(m.normal_texture.m12, 0.5f);
    EXPECT_EQ(m.emissive_texture.m02, 0.125f);
    EXPECT_EQ(m.emissive_texture.m12, 0.75f);
    EXPECT_EQ(m.metallic_roughness_texture.m00, 2);
    EXPECT_EQ(m.metallic_roughness_texture.m11, 3);
}

TEST(Pointers, OfTwoClipsTheLastWins) {
    Stage stage;
    add_lamp(stage);
    drive(stage, Property::light_intensity, 0, track<double>({{0, 5}}));
    stage.scene.clips.push_back(stage.scene.clips[0]);
    stage.scene.files[0].clip_count = 2;
    stage.scene.clips[1].properties[0].track = track<double>({{0, 7}});
    EXPECT_FLOAT_EQ(stage.snapshot().light_keys.front().radiance.x, 7);
}

TEST(TrackLimits, AreCheckedWhereTheFrameRangeIsKnown) {
    Stage stage;
    stage.shot.shutter = {0, 0.5};
    Track<double> falling = track<double>({{0, 8}, {1, 4}});
    falling.before = falling.after = Extrapolation::continued;
    stage.shot.limited_tracks.push_back({"lights.bulb.intensity", {{"stage.yaml", 20, 3}, {}, {}, 1, {}, false}, find_field("lights.intensity"), {falling}});
    EXPECT_EQ(test::message_of([&] { stage.bind(); }), "no error");
    stage.shot.timing.frames = {0, 2};
    EXPECT_EQ(test::message_of([&] { stage.bind(); }),
              "stage.yaml:20:3: error: lights.bulb.intensity is -2 cd at 2.5 s (frame 2.5)\n"
              "  expected at least 0 cd; the track goes on with its end's slope; use hold, or a key where it should stop");
    // Without a range the clips say how long the shot is.
    stage.shot.frames_given = false;
    EXPECT_EQ(test::message_of([&] { stage.bind(); }), "no error");
    add_lamp(stage);
    drive(stage, Property::light_intensity, 0, track<double>({{0, 8}}));
    EXPECT_NE(test::message_of([&] { stage.bind(); }).find("is -3994 cd at 1000.5 s (frame 1000.5)"), std::string::npos);
}

TEST(TrackLimits, TheMotionLayerLooksAFrameBack) {
    Stage stage;
    Track<double> rising = track<double>({{0, 4}, {1, 8}});
    rising.before = Extrapolation::continued;
    stage.shot.limited_tracks.push_back({"camera.focus", {{"stage.yaml", 20, 3}, {}, {}, 1, {}, false}, find_field("camera.focus"), {rising}});
    EXPECT_EQ(test::message_of([&] { stage.bind(); }), "no error");
    stage.shot.output.aovs = {Aov::motion};
    EXPECT_NE(test::message_of([&] { stage.bind(); }).find("camera.focus is 0 m at -1 s (frame -1)"), std::string::npos);
}

/// What binding warns of, without the warnings about other things.
std::string limit_warnings(const Stage& stage) {
    std::string text;
    const std::vector<Diagnostic> warnings = stage.bind().warnings();
    for (const Diagnostic& warning : warnings)
        if (warning.found.find("drives") != std::string::npos) text += warning.text() + "\n";
    return text;
}

TEST(PointerLimits, HoldWhatAClipDrivesBeyondAndSaySo) {
    Stage stage;
    stage.scene.files[0].path = "stage.glb";
    add_lamp(stage);
    stage.scene.lights[0].name = "Lamp";
    stage.shot.timing.frames = {0, 1, 2, 3};
    drive(stage, Property::light_intensity, 0, track<double>({{0, 8}, {2, -8}, {4, 8}}));
    EXPECT_FLOAT_EQ(stage.snapshot(0).light_keys.front().radiance.x, 8);
    EXPECT_FLOAT_EQ(stage.snapshot(1).light_keys.front().radiance.x, 0);
    EXPECT_FLOAT_EQ(stage.snapshot(2).light_keys.front().radiance.x, 0);
    EXPECT_EQ(limit_warnings(stage), "stage.glb: warning: clip 'clip 0' drives the intensity of light 'Lamp' to -8 at 2 s of the clip\n  expected at least 0; the property is held there\n");
    stage.shot.timing.frames = {0};  // 8 to 0: what comes later is not played
    EXPECT_EQ(limit_warnings(stage), "");
    stage.shot.timing.frames = {0, 1};  // ends at -8
    stage.shot.scenes[0].layers.push_back(stage.shot.scenes[0].layers[0]);
    EXPECT_NE(limit_warnings(stage), "");
    EXPECT_EQ(limit_warnings(stage).find("drives"), limit_warnings(stage).rfind("drives"));  // two layers play the same channel
    for (ClipLayer& layer : stage.shot.scenes[0].layers) layer.weight = Track<double>(0.0);
    EXPECT_EQ(limit_warnings(stage), "");
}

TEST(PointerLimits, HoldTheMixOfLayersNotItsParts) {
    Stage stage;
    add_lamp(stage);
    stage.scene.lights[0].intensity = 8;
    stage.shot.scenes[0].layers[0].weight = Track<double>(0.5);
    drive(stage, Property::light_intensity, 0, track<double>({{0, -2}}));
    EXPECT_FLOAT_EQ(stage.snapshot().light_keys.front().radiance.x, 3);
}

TEST(PointerLimits, AreCheckedBetweenTheKeysOfACubic) {
    Stage stage;
    add_lamp(stage);
    Track<double> swing = track<double>({{0, 1}, {1, 1}}, Interpolation::cubic);
    swing.keys[0].out_tangent = -8, swing.keys[1].in_tangent = 8;
    drive(stage, Property::light_intensity, 0, swing);
    EXPECT_NE(limit_warnings(stage).find("drives the intensity of light 0 to -1 at 0.5 s of the clip"), std::string::npos) << limit_warnings(stage);
    stage.shot.scenes[0].layers[0].speed = 0;
    EXPECT_EQ(limit_warnings(stage), "");  // stands at its first key
    stage.shot.scenes[0].layers[0].start_s = 0.25;
    EXPECT_NE(limit_warnings(stage).find("to -0.5 at 0.25 s"), std::string::npos) << limit_warnings(stage);
}

TEST(PointerLimits, EveryPropertyHasItsOwn) {
    Stage stage;
    stage.add_node("cube");
    stage.scene.material_names = {"Paint"};
    stage.scene.material_sources.resize(1);
    stage.scene.material_sources[0].index = 4;
    stage.scene.material_sources[0].emissive = {1, 1, 1};
    stage.scene.files[0].material_count = 1;
    drive(stage, Property::base_color, 4, track<glm::dvec3>({{0, {0.5, 1.5, -0.5}}}));
    drive(stage, Property::roughness, 4, track<double>({{0, 1.25}}));
    drive(stage, Property::metallic, 4, track<double>({{0, -1}}));
    drive(stage, Property::emissive_strength, 4, track<double>({{0, -3}}));
    drive(stage, Property::normal_scale, 4, track<double>({{0, -2}}));
    drive(stage, Property::ior, 4, track<double>({{0, 0.5}}));
    const SceneSnapshot snapshot = stage.snapshot();
    const kernels::Material& m = snapshot.materials.at(snapshot.instances.at(0).material);
    EXPECT_EQ(m.base_color.x, 0.5f);
    EXPECT_EQ(m.base_color.y, 1);
    EXPECT_EQ(m.base_color.z, 0);
    EXPECT_EQ(m.roughness, 1);
    EXPECT_EQ(m.metallic, 0);
    EXPECT_EQ(m.emission.x, 0);
    EXPECT_EQ(m.normal_scale, -2);
    EXPECT_EQ(m.dielectric_f0, 0);
    const std::string warnings = limit_warnings(stage);
    EXPECT_NE(warnings.find("the base colour of material 'Paint' to 1.5 at 0 s of the clip\n  expected 0 to 1; the property is held there"), std::string::npos) << warnings;
    EXPECT_NE(warnings.find("the roughness of material 'Paint' to 1.25"), std::string::npos) << warnings;
    EXPECT_NE(warnings.find("the metallic factor of material 'Paint' to -1"), std::string::npos) << warnings;
    EXPECT_NE(warnings.find("the emissive strength of material 'Paint' to -3"), std::string::npos) << warnings;
    EXPECT_NE(warnings.find("the index of refraction of material 'Paint' to 0.5 at 0 s of the clip\n  expected at least 1"), std::string::npos) << warnings;
    EXPECT_EQ(warnings.find("normal"), std::string::npos) << warnings;
}

}  // namespace
}  // namespace kadr
