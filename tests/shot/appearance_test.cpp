// materials, variant and visible of a scene entry.
#include "shot/shot_fixture.h"
#include "shot/shot_hash.h"

namespace kadr {
namespace {

using Appearance = ShotTest;

SceneSpec only_scene(const Shot& shot) { return shot.scenes.at(0); }

TEST_F(Appearance, ReadsMaterialsByName) {
    const SceneSpec scene = only_scene(parse_scene(
        "{ gltf: a.glb, materials: { Paint: { base_color: { keys: { 0 s: [1, 0, 0], 2 s: [0, 0, 1] } }, roughness: 0.25 }, "
        "\"Tail light\": { emissive: [1, 0.1, 0], emissive_strength: 20 nt, alpha: 0.5, alpha_cutoff: 0.75, metallic: 1, normal_scale: 2, ior: 1.33 } } }"));
    ASSERT_EQ(scene.materials.size(), 2u);
    const MaterialSpec &paint = scene.materials[0], &tail = scene.materials[1];
    EXPECT_EQ(paint.name, "Paint");
    EXPECT_EQ(evaluate(*paint.base_color, 1), glm::dvec3(0.5, 0, 0.5));
    EXPECT_EQ(evaluate(*paint.roughness, 0), 0.25);
    EXPECT_FALSE(paint.metallic || paint.emissive || paint.alpha);
    EXPECT_EQ(tail.name, "Tail light");
    EXPECT_EQ(evaluate(*tail.emissive, 0), glm::dvec3(1, 0.1, 0));
    EXPECT_EQ(evaluate(*tail.emissive_strength, 0), 20);
    EXPECT_EQ(evaluate(*tail.alpha, 0), 0.5);
    EXPECT_EQ(evaluate(*tail.alpha_cutoff, 0), 0.75);
    EXPECT_EQ(evaluate(*tail.metallic, 0), 1);
    EXPECT_EQ(evaluate(*tail.normal_scale, 0), 2);
    EXPECT_EQ(evaluate(*tail.ior, 0), 1.33);
}

TEST_F(Appearance, SwitchesJump) {
    const SceneSpec scene = only_scene(parse_scene("{ gltf: a.glb, visible: { keys: { 0 s: false, 1 s: true } } }"));
    EXPECT_FALSE(is_on(scene.visible, 0.999));
    EXPECT_TRUE(is_on(scene.visible, 1));
    EXPECT_TRUE(is_on(only_scene(parse_scene("{ gltf: a.glb }")).visible, 0));
    EXPECT_FALSE(is_on(only_scene(parse_scene("{ gltf: a.glb, visible: false }")).visible, 0));
}

TEST_F(Appearance, NodesHaveSwitches) {
    const SceneSpec scene = only_scene(parse_scene("{ gltf: a.glb, nodes: { Roof: { visible: { keys: { 0 s: true, 1 s: false } } }, Door: { scale: 2 } } }"));
    EXPECT_FALSE(is_on(scene.nodes.at(0).visible.value(), 1));
    EXPECT_EQ(scene.nodes.at(1).visible, std::nullopt);
}

TEST_F(Appearance, NamesAVariant) {
    EXPECT_EQ(only_scene(parse_scene("{ gltf: a.glb, variant: Midnight }")).variant, "Midnight");
    EXPECT_EQ(only_scene(parse_scene("{ gltf: a.glb, variant: null }")).variant, std::nullopt);
}

TEST_F(Appearance, Messages) {
    const auto error_of = [](const std::string& scene) { return errors_of("kadr: 1\ncamera: {}\nscenes:\n- { gltf: a.glb, " + scene + " }\n"); };
    EXPECT_EQ(error_of("visible: 1"), R"(shot.yaml:4:27: error: scenes.0.visible is 1
    - { gltf: a.glb, visible: 1 }
                              ^
  expected true or false)");
    EXPECT_EQ(error_of("visible: { keys: { 0 s: true }, interpolate: linear }"), R"(shot.yaml:4:63: error: scenes.0.visible.interpolate is 'linear'
    - { gltf: a.glb, visible: { keys: { 0 s: true }, interpolate: linear } }
                                                                  ^~~~~~
  expected step: what is true or false only jumps; remove the key)");
    EXPECT_EQ(error_of("materials: red"), R"(shot.yaml:4:29: error: scenes.0.materials is 'red'
    - { gltf: a.glb, materials: red }
                                ^~~
  expected a map of names to maps of base_color, metallic, roughness, ior, emissive, emissive_strength, alpha, alpha_cutoff, normal_scale; for example materials: { Paint: { base_color: [0.8, 0.1, 0.1] } })");
    EXPECT_EQ(error_of("materials: { Paint: red }"), R"(shot.yaml:4:38: error: scenes.0.materials.Paint is 'red'
    - { gltf: a.glb, materials: { Paint: red } }
                                         ^~~
  expected a map such as { base_color: [0.8, 0.1, 0.1], roughness: 0.3 })");
    EXPECT_EQ(error_of("materials: { Paint: { color: red } }"), R"(shot.yaml:4:40: error: unknown key 'color' in scenes.0.materials.Paint
    - { gltf: a.glb, materials: { Paint: { color: red } } }
                                           ^~~~~
  expected one of base_color, metallic, roughness, ior, emissive, emissive_strength, alpha, alpha_cutoff, normal_scale)");
    EXPECT_EQ(error_of("materials: { Paint: { ior: 0.9 } }"), R"(shot.yaml:4:45: error: scenes.0.materials.Paint.ior is 0.9
    - { gltf: a.glb, materials: { Paint: { ior: 0.9 } } }
                                                ^~~
  expected at least 1)");
    EXPECT_EQ(error_of("materials: { Paint: { base_color: [1, 0, 2] } }"), R"(shot.yaml:4:59: error: scenes.0.materials.Paint.base_color[2] is 2
    - { gltf: a.glb, materials: { Paint: { base_color: [1, 0, 2] } } }
                                                              ^
  expected [x, y, z], each 0 to 1)");
}

TEST_F(Appearance, LightsTakeTracks) {
    const LightSpec sun = parse("lights: [ { type: directional, angular_diameter: { keys: { 0 s: 0 deg, 1 s: 2 deg } }, visible: { keys: { 0 s: true, 1 s: false } } } ]").lights.at(0);
    EXPECT_DOUBLE_EQ(evaluate(sun.angular_diameter_rad, 0.5), glm::radians(1.0));
    EXPECT_FALSE(is_on(sun.visible, 1));
    const LightSpec bulb = parse("lights: [ { type: point, range: { keys: { 0 s: 2 m, 1 s: 50 cm } } } ]").lights.at(0);
    EXPECT_DOUBLE_EQ(evaluate(bulb.range_m, 1), 0.5);
    EXPECT_EQ(errors_of(std::string(kBase) + "lights: [ { type: point, range: { keys: { 0 s: 2 m, 1 s: infinite } } } ]\n"),
              R"(shot.yaml:4:58: error: lights.0.range is infinite at a key
    lights: [ { type: point, range: { keys: { 0 s: 2 m, 1 s: infinite } } } ]
                                                             ^~~~~~~~
  expected a distance: nothing lies between it and infinity; key a large one, such as 1000 m)");
}

TEST_F(Appearance, ExposureTakesATrackOfStops) {
    const ViewSpec view = parse("view: { exposure: { keys: { 0 s: -2, 1 s: 2 } } }").view;
    EXPECT_EQ(view_at(view, 0.75).exposure_stops, 1);
    EXPECT_EQ(view_at(view, 0.75).exposure_keys, std::nullopt);
    EXPECT_FALSE(view.automatic);
    EXPECT_EQ(view_at(parse("view: { exposure: 3 }").view, 0.75).exposure_stops, 3);
    EXPECT_EQ(errors_of(std::string(kBase) + "view: { exposure: { keys: { 0 s: auto } } }\n"), R"(shot.yaml:4:34: error: view.exposure is 'auto'
    view: { exposure: { keys: { 0 s: auto } } }
                                     ^~~~
  expected -200 to 200 stops or auto or a map of ev100, iso, time, f_stop)");
}

TEST_F(Appearance, BelongsToTheHash) {
    const auto hash_of = [](const std::string& scene) {
        Hasher hasher;
        hash_shot(parse_scene("{ gltf: a.glb" + scene + " }"), hasher);
        return hasher.finish().hex();
    };
    const std::string plain = hash_of("");
    EXPECT_NE(hash_of(", visible: false"), plain);
    EXPECT_NE(hash_of(", variant: Blue"), plain);
    EXPECT_NE(hash_of(", materials: { Paint: { roughness: 0.5 } }"), plain);
    const auto view_hash_of = [](const std::string& exposure) {
        Hasher hasher;
        hash_view(parse("view: { exposure: " + exposure + " }"), hasher);
        return hasher.finish().hex();
    };
    EXPECT_NE(view_hash_of("{ keys: { 0 s: 1 } }"), view_hash_of("{ keys: { 0 s: 2 } }"));
    EXPECT_NE(hash_of(", materials: { Paint: { roughness: 0.5 } }"), hash_of(", materials: { Paint: { metallic: 0.5 } }"));
}

}  // namespace
}  // namespace kadr
