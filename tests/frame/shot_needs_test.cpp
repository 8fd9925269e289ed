#include "frame/shot_needs.h"

#include <gmock/gmock.h>

#include "stage.h"

namespace kadr {
namespace {

using test::Stage;
using test::track;
using testing::Contains;
using testing::IsEmpty;

/// A node "Ball" whose mesh has everything, and a material with a texture in every role.
struct Full : Stage {
    Full() {
        ball = add_node("Ball");
        scene.material_names = {"paint"};
        scene.material_sources.resize(1);
        scene.files[0].material_count = 1;
        scene.textures.resize(kTextureUses);
        constexpr const char* kNames[] = {"color.png", "metal.png", "normal.png", "glow.png", "shade.png"};
        for (std::size_t i = 0; i < scene.textures.size(); ++i) scene.textures[i].name = kNames[i];
        kernels::Material& m = scene.materials[0];
        kernels::TextureSlot* const slots[] = {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emissive_texture, &m.occlusion_texture};
        for (int i = 0; i < kTextureUses; ++i) slots[i]->texture = i;
        m.normal_texture.uv_set = 1;
        m.emission = {1, 1, 1};
    }
    int ball;
    kernels::Material& material() { return scene.materials[0]; }
    ShotNeeds needs() const { return needs_of(shot, {scene, {{3, 3, true, true, true, true, {true, true}, 1}}}); }
    Unread unread(const char* kind, const char* name, const char* why) const { return {kind, name, why}; }
};

TEST(ShotNeeds, AreAllThatIsShownButOcclusion) {
    const ShotNeeds needs = Full().needs();
    EXPECT_EQ(needs.scene.textures[0], (std::array{true, true, true, true, false}));
    const GeometryNeeds& geometry = needs.scene.geometries[0];
    EXPECT_TRUE(geometry.wanted && geometry.uv[0] && geometry.uv[1] && geometry.tangents && geometry.colors);
    EXPECT_FALSE(geometry.skin) << "the node has none";
    EXPECT_FALSE(geometry.targets) << "their weights are 0";
    EXPECT_EQ(needs.left_out, (std::vector<Unread>{{"attribute", "stage/cube/0: JOINTS and WEIGHTS", "no node shows it with a skin"},
                                                   {"attribute", "stage/cube/0: morph targets", "their weights are 0 at all times"},
                                                   {"image", "stage/shade.png", "baked occlusion imitates what both integrators trace"}}));
}

TEST(ShotNeeds, OfUnlitMaterialsAreTheirColour) {
    Full stage;
    stage.material().unlit = true;
    const ShotNeeds needs = stage.needs();
    EXPECT_EQ(needs.scene.textures[0], (std::array{true, false, false, false, false}));
    EXPECT_FALSE(needs.scene.geometries[0].uv[1]);
    EXPECT_FALSE(needs.scene.geometries[0].tangents);
    EXPECT_THAT(needs.left_out, Contains(stage.unread("image", "stage/normal.png", "its materials are unlit")));
    EXPECT_THAT(needs.left_out, Contains(stage.unread("attribute", "stage/cube/0: TANGENT", "no normal texture is used")));
}

TEST(ShotNeeds, OfEmissionEndWhereNothingEmits) {
    Full stage;
    stage.material().emission = {0, 0, 0};
    EXPECT_FALSE(stage.needs().scene.textures[0][3]);
    EXPECT_THAT(stage.needs().left_out, Contains(stage.unread("image", "stage/glow.png", "its materials never emit")));
    MaterialSpec change;
    change.name = "paint";
    change.emissive_strength = 2.0;
    stage.shot.scenes[0].materials.push_back(change);
    EXPECT_TRUE(stage.needs().scene.textures[0][3]) << "the shot may make it shine";
}

TEST(ShotNeeds, EndWithTheNodesThatAreSeen) {
    Full hidden;
    hidden.shot.scenes[0].hide = {{"Ball", {}}};
    EXPECT_FALSE(hidden.needs().scene.geometries[0].wanted);
    EXPECT_EQ(hidden.needs().scene.textures[0], (std::array{false, false, false, false, false}));
    EXPECT_THAT(hidden.needs().left_out, Contains(hidden.unread("node", "stage/Ball", "hide leaves it out")));
    EXPECT_THAT(hidden.needs().left_out, Contains(hidden.unread("mesh", "stage/cube/0", "no node that is shown has it")));
    EXPECT_THAT(hidden.needs().left_out, Contains(hidden.unread("material", "stage/paint", "nothing that is shown wears it")));
    EXPECT_THAT(hidden.needs().left_out, Contains(hidden.unread("image", "stage/color.png", "its materials are on nothing that is shown")));

    Full outside;
    outside.scene.files[0].roots.clear();
    EXPECT_FALSE(outside.needs().scene.geometries[0].wanted);
    EXPECT_THAT(outside.needs().left_out, Contains(outside.unread("node", "stage/Ball", "it is not in the file's default scene")));

    Full off;
    off.scene.nodes[0].visible = false;
    EXPECT_FALSE(off.needs().scene.geometries[0].wanted);
    EXPECT_THAT(off.needs().left_out, Contains(off.unread("node", "stage/Ball", "it is never visible")));
    NodeOverride again;
    again.name = "Ball";
    again.visible = track<double>({{0, 0}, {1e6, 1}}, Interpolation::step);
    off.shot.scenes[0].nodes.push_back(again);
    EXPECT_TRUE(off.needs().scene.geometries[0].wanted) << "whichever frames are rendered, their inputs are the same";
}

TEST(ShotNeeds, FollowTheVariant) {
    Full stage;
    stage.scene.materials.push_back({});
    stage.scene.material_names.push_back("bare");
    stage.scene.material_sources.resize(2);
    stage.scene.files[0].material_count = 2;
    stage.scene.files[0].variants = {"bare"};
    stage.scene.nodes[0].primitives[0].variants = {{0, 1}};
    EXPECT_TRUE(stage.needs().scene.textures[0][0]);
    stage.shot.scenes[0].variant = "bare";
    EXPECT_FALSE(stage.needs().scene.textures[0][0]);
    EXPECT_FALSE(stage.needs().scene.geometries[0].uv[0]);
}

TEST(ShotNeeds, BringMorphTargetsAndSkinsThatBend) {
    Full stage;
    stage.scene.nodes[0].weights = {0};
    EXPECT_FALSE(stage.needs().scene.geometries[0].targets);
    stage.animate(0).weights = {track<double>({{0, 0}, {1, 1}})};
    EXPECT_TRUE(stage.needs().scene.geometries[0].targets);
    stage.shot.scenes[0].layers.clear();
    EXPECT_FALSE(stage.needs().scene.geometries[0].targets) << "no layer plays the clip";
    stage.scene.nodes[0].weights = {0.5};
    EXPECT_TRUE(stage.needs().scene.geometries[0].targets);

    stage.scene.skins.push_back({"bones", {0}, {}, 0});
    EXPECT_THAT(stage.needs().scene.skins, testing::ElementsAre(false));
    stage.scene.nodes[0].skin = 0;
    EXPECT_TRUE(stage.needs().scene.geometries[0].skin);
    EXPECT_THAT(stage.needs().scene.skins, testing::ElementsAre(true));
}

TEST(ShotNeeds, KeepWhatCopiesAreStrewnOn) {
    Full stage;
    stage.scene.nodes[0].visible = false;
    SceneSpec grass = stage.shot.scenes[0];
    grass.id = "grass";
    grass.instances.emplace();
    grass.instances->scatter = ScatterSpec{"stage/Ball", {}, 3};
    stage.shot.scenes.push_back(grass);
    SceneFile file;
    file.id = "grass";
    file.first_node = 1;
    stage.scene.files.push_back(file);
    const auto needs = stage.needs();
    EXPECT_TRUE(needs.scene.geometries[0].wanted);
    EXPECT_FALSE(needs.scene.geometries[0].uv[0]);
}

TEST(ShotNeeds, AreRefusedWithAllThatIsWrongWithTheNames) {
    Full stage;
    stage.shot.scenes[0].hide = {{"Bal", {"stage.yaml", 5, 1}}};
    stage.shot.camera.look_at = NodeReference{"stag/Ball", {"stage.yaml", 9, 1}};
    EXPECT_EQ(test::message_of([&] { stage.needs(); }),
              "stage.yaml:5:1: error: 'Bal' names no node of scene 'stage'\n"
              "  did you mean 'Ball'?\n"
              "stage.yaml:9:1: error: 'stag/Ball' names no scene\n"
              "  did you mean 'stage'?");
}

}  // namespace
}  // namespace kadr
