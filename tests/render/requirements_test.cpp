#include "render/requirements.h"

#include <gmock/gmock.h>

#include "render/plain_stage.h"

namespace kadr {
namespace {

using test::track;
using testing::IsEmpty;

struct Plain : test::PlainStage {
    RequirementSet needs() const {
        const BoundShot bound = bind();
        return requirements_of(bound);
    }
    /// What this asks for beyond a plain one.
    std::vector<Requirement> more() const {
        const RequirementSet plain = Plain().needs();
        std::vector<Requirement> result;
        for (const Requirement& entry : needs().entries)
            if (std::find(plain.entries.begin(), plain.entries.end(), entry) == plain.entries.end()) result.push_back(entry);
        return result;
    }
};

using Entries = std::vector<Requirement>;

TEST(Requirements, OfAPlainShotAreItsIntegratorAndItsMaterial) {
    EXPECT_EQ(Plain().needs().entries, (Entries{{Feature::integrator_path, "render.integrator"}, {Feature::metallic, "material 'paint'"}}));
}

TEST(Requirements, EveryFeatureHasItsRow) {
    for (std::size_t i = 0; i < all_features().size(); ++i) EXPECT_EQ(all_features()[i].feature, static_cast<Feature>(i));
    EXPECT_EQ(all_features().size(), static_cast<std::size_t>(Feature::denoiser) + 1);
}

TEST(Requirements, NameWhatMovesWhileTheShutterIsOpen) {
    Plain stage;
    stage.animate(stage.ball).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {2, {1, 0, 0}}});
    EXPECT_EQ(stage.more(), (Entries{{Feature::blur_instances, "node 'stage/Ball'"}, {Feature::moves_instances, "node 'stage/Ball'"}}));
    stage.shot.shutter = {0, 0};
    EXPECT_EQ(stage.more(), (Entries{{Feature::moves_instances, "node 'stage/Ball'"}})) << "a closed shutter blurs nothing";
    stage.shot.shutter = {0, 0.5};
    stage.shot.timing.frames = {5, 6};
    EXPECT_THAT(stage.more(), IsEmpty()) << "it has come to rest before the first frame";
}

TEST(Requirements, CountWhoAsks) {
    Plain stage;
    stage.add_node("Other", stage.ball);
    stage.animate(stage.ball).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {2, {1, 0, 0}}});
    const RequirementSet set = stage.needs();
    EXPECT_FALSE(set.needs(Feature::blur_camera));
    const Requirement* blur = set.find(Feature::blur_instances);
    ASSERT_TRUE(blur);
    EXPECT_EQ(blur->first, "node 'stage/Ball'");
    EXPECT_EQ(blur->count, 2u);
}

TEST(Requirements, OfTheCamera) {
    Plain stage;
    stage.shot.camera.f_stop = 2.8;
    stage.shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {2, {1, 0, 5}}});
    EXPECT_EQ(stage.more(), (Entries{{Feature::camera_lens, "camera.f_stop"}, {Feature::blur_camera, "camera.position"}}));
    Plain follows;
    follows.animate(follows.ball).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {2, {1, 0, 0}}});
    follows.shot.camera.look_at = NodeReference{"stage/Ball", {}};
    const RequirementSet set = follows.needs();
    ASSERT_TRUE(set.find(Feature::blur_camera));
    EXPECT_EQ(set.find(Feature::blur_camera)->first, "node 'stage/Ball'");
}

TEST(Requirements, OfMaterials) {
    const auto with = [](auto change) {
        Plain stage;
        TextureData& texture = stage.scene.textures.emplace_back();
        texture.width = texture.height = 1;
        texture.format = kernels::TexelFormat::rgba8_linear;
        texture.texels = {0, 128, 0, 255};
        change(stage.material());
        return stage.more();
    };
    const std::string paint = "material 'paint'";
    EXPECT_EQ(with([](kernels::Material& m) { m.roughness = 0.03f; }), (Entries{{Feature::mirror, paint}}));
    EXPECT_THAT(with([](kernels::Material& m) { m.roughness = 0.033f; }), IsEmpty());
    EXPECT_EQ(with([](kernels::Material& m) { m.dielectric_f0 = 0.1f; }), (Entries{{Feature::index_of_refraction, paint}}));
    EXPECT_EQ(with([](kernels::Material& m) {
                  m.roughness = 0.06f;  // half of it: the texture's
                  m.metallic_roughness_texture.texture = 0;
              }),
              (Entries{{Feature::dielectric, paint}, {Feature::mirror, paint}, {Feature::texture_metallic_roughness, paint}}));
    EXPECT_EQ(with([](kernels::Material& m) { m.metallic = 0.5f; }), (Entries{{Feature::dielectric, paint}}));
    EXPECT_EQ(with([](kernels::Material& m) { m.alpha_mode = kernels::AlphaMode::mask; }), (Entries{{Feature::alpha_mask, paint}}));
    EXPECT_EQ(with([](kernels::Material& m) { m.alpha_mode = kernels::AlphaMode::blend; }), (Entries{{Feature::alpha_blend, paint}}));
    EXPECT_EQ(with([](kernels::Material& m) { m.unlit = true; }), (Entries{{Feature::unlit, paint}}));
    EXPECT_EQ(with([](kernels::Material& m) { m.base_color_texture.texture = 0; }), (Entries{{Feature::texture_base_color, paint}}));
    EXPECT_EQ(with([](kernels::Material& m) { m.normal_texture.texture = 0; }), (Entries{{Feature::texture_normal, paint}}));
    EXPECT_EQ(with([](kernels::Material& m) { m.metallic_roughness_texture.texture = 0; }),
              (Entries{{Feature::dielectric, paint}, {Feature::texture_metallic_roughness, paint}}));
    EXPECT_THAT(with([](kernels::Material& m) { m.emissive_texture.texture = 0; }), IsEmpty()) << "it is multiplied by nothing";
    EXPECT_THAT(with([](kernels::Material& m) { m.occlusion_texture.texture = 0; }), IsEmpty()) << "both integrators trace what it imitates";
    EXPECT_EQ(with([](kernels::Material& m) {
                  m.emission = {1, 1, 1};
                  m.emissive_texture.texture = 0;
              }),
              (Entries{{Feature::texture_emissive, paint}, {Feature::light_mesh, paint}}));
}

TEST(Requirements, OfMaterialsOnWhatIsNeverShownAreNone) {
    Plain stage;
    stage.material().alpha_mode = kernels::AlphaMode::blend;
    stage.shot.scenes[0].visible = track<double>({{0, 0}, {10, 1}}, Interpolation::step);
    EXPECT_FALSE(stage.needs().needs(Feature::alpha_blend)) << "it comes after the last frame";
    stage.shot.timing.frames = {0, 10};
    EXPECT_TRUE(stage.needs().needs(Feature::alpha_blend));
    EXPECT_TRUE(stage.needs().needs(Feature::switches_instances));
}

TEST(Requirements, OfMaterialsThatTheShotChanges) {
    Plain stage;
    MaterialSpec change;
    change.name = "paint";
    change.metallic = track<double>({{0, 1}, {1, 0}});
    stage.shot.scenes[0].materials.push_back(change);
    stage.scene.files[0].material_count = 1;
    EXPECT_EQ(stage.more(), (Entries{{Feature::dielectric, "material 'paint'"}}));
}

TEST(Requirements, OfLights) {
    const auto with = [](LightKind kind, auto change) {
        Plain stage;
        LightSpec light;
        light.id = "key";
        light.kind = kind;
        change(light);
        stage.shot.lights.push_back(light);
        return stage.more();
    };
    const auto as_it_is = [](LightSpec&) {};
    const std::string key = "light 'key'";
    EXPECT_EQ(with(LightKind::directional, as_it_is), (Entries{{Feature::light_directional, key}}));
    EXPECT_EQ(with(LightKind::directional, [](LightSpec& light) { light.angular_diameter_rad = 0.01; }), (Entries{{Feature::light_sun, key}}));
    EXPECT_EQ(with(LightKind::point, as_it_is), (Entries{{Feature::light_point, key}}));
    EXPECT_EQ(with(LightKind::point, [](LightSpec& light) { light.radius_m = 0.1; }), (Entries{{Feature::light_sphere, key}}));
    EXPECT_EQ(with(LightKind::spot, as_it_is), (Entries{{Feature::light_spot, key}}));
    EXPECT_EQ(with(LightKind::area, as_it_is), (Entries{{Feature::light_area, key}}));
    EXPECT_THAT(with(LightKind::area, [](LightSpec& light) { light.visible = 0.0; }), IsEmpty());
    EXPECT_EQ(with(LightKind::point, [](LightSpec& light) { light.strength = track<double>({{0, 1}, {1, 2}}); }),
              (Entries{{Feature::blur_lights, key}, {Feature::light_point, key}}));
}

TEST(Requirements, OfEnvironmentLayersAndShutter) {
    Plain stage;
    stage.shot.environment.color = glm::dvec3(1);
    stage.shot.environment.visible = false;
    stage.shot.output.aovs = {Aov::depth, Aov::motion};
    stage.shot.shutter.rolling = {RollingShutter::Direction::down, 0.01};
    EXPECT_EQ(stage.more(), (Entries{{Feature::shutter_rolling, "shutter.rolling"},
                                     {Feature::environment_color, "environment.color"},
                                     {Feature::transparent_background, "environment.visible"},
                                     {Feature::layer_depth, "output.aovs"},
                                     {Feature::layer_motion, "output.aovs"}}));
}

TEST(Requirements, OfBendingMeshes) {
    Plain stage;
    GeometryData& geometry = stage.scene.geometries[0];
    geometry.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    geometry.indices = {0, 1, 2};
    geometry.targets.push_back({{0}, {{0, 0, 1}}, {}, {}});
    stage.node(stage.ball).weights = {0.5};
    EXPECT_EQ(stage.more(), (Entries{{Feature::morph_targets, "node 'stage/Ball'"}})) << "it is bent, but keeps its shape";
    stage.animate(stage.ball).weights = {track<double>({{0, 0}, {2, 1}})};
    EXPECT_EQ(stage.more(), (Entries{{Feature::blur_vertices, "node 'stage/Ball'"}, {Feature::morph_targets, "node 'stage/Ball'"}}));
}

TEST(Requirements, OfLongShotsCountWhatMayMove) {
    Plain stage;
    for (int frame = 2; frame < 2 * static_cast<int>(kMostFramesLookedAt); ++frame) stage.shot.timing.frames.push_back(frame);
    stage.animate(stage.ball).translation = track<glm::dvec3>({{3.1, {0, 0, 0}}, {3.2, {1, 0, 0}}});
    EXPECT_TRUE(stage.needs().needs(Feature::blur_instances)) << "a move of a tenth of a second, between the frames that are looked at";
    LightSpec light;
    light.id = "key";
    light.look_at = NodeReference{"stage", {}};
    stage.shot.lights.push_back(light);
    stage.node(stage.add_node("Bent")).weights = {0.5};
    stage.scene.geometries[0].targets.push_back({{0}, {{0, 0, 1}}, {}, {}});
    stage.scene.geometries[0].positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    stage.scene.geometries[0].indices = {0, 1, 2};
    for (const Feature still : {Feature::blur_camera, Feature::blur_lights, Feature::blur_vertices}) EXPECT_FALSE(stage.needs().needs(still)) << info_of(still).name;
}

}  // namespace
}  // namespace kadr
