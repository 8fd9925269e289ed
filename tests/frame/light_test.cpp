#include "frame/light_keys.h"

#include <gtest/gtest.h>

#include "stage.h"

namespace kadr {
namespace {

using test::message_of;
using test::Stage;
using test::track;

LightSpec point_light() {
    LightSpec light;
    light.id = "bulb";
    light.where = {"stage.yaml", 20, 3};
    light.strength = Track<double>(10.0);
    light.color = Track<glm::dvec3>(glm::dvec3(1, 0.5, 0.25));
    light.position = Track<glm::dvec3>(glm::dvec3(1, 2, 3));
    return light;
}

TEST(Lights, AreColourTimesStrength) {
    Stage stage;
    stage.shot.lights.push_back(point_light());
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.light_keys.size(), 1u);
    EXPECT_FLOAT_EQ(snapshot.light_keys[0].radiance.y, 5);
    EXPECT_FLOAT_EQ(snapshot.light_keys[0].position.z, 3);
    EXPECT_EQ(snapshot.lights[0].count, 1u);
}

TEST(Lights, DimLinearlyWithTwoKeys) {
    Stage stage;
    stage.shot.lights.push_back(point_light());
    stage.shot.lights[0].strength = track<double>({{-1, 0}, {2, 30}});
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.lights[0].count, 2u);
    EXPECT_FLOAT_EQ(snapshot.light_keys[0].radiance.x, 10);
    EXPECT_FLOAT_EQ(snapshot.light_keys[1].radiance.x, 20);
}

TEST(Lights, HaveAKeyWhereTheTrackHasOne) {
    Stage stage;
    stage.shot.lights.push_back(point_light());
    stage.shot.lights[0].strength = track<double>({{0, 0}, {0.25, 30}, {1, 0}});
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.lights[0].count, 5u);
    EXPECT_FLOAT_EQ(snapshot.light_keys[1].radiance.x, 30);
}

TEST(Lights, HaveAtMostThirtyThreeKeys) {
    Stage stage;
    stage.shot.lights.push_back(point_light());
    std::vector<std::pair<double, double>> flicker;
    for (int i = 0; i < 200; ++i) flicker.emplace_back(i * 0.00713, i % 2);
    stage.shot.lights[0].strength = track<double>(flicker);
    stage.shot.render.samples = 1;  // with more the shutter would be split
    EXPECT_EQ(stage.snapshot().lights[0].count, 33u);
}

TEST(Lights, AreasFaceTheirTarget) {
    Stage stage;
    LightSpec panel = point_light();
    panel.kind = LightKind::area;
    panel.position = Track<glm::dvec3>(glm::dvec3(0, 4, 4));
    panel.look_at = Track<glm::dvec3>(glm::dvec3(0, 0, 0));
    panel.size_m = Track<glm::dvec2>(glm::dvec2(2, 1));
    stage.shot.lights.push_back(panel);
    const SceneSnapshot snapshot = stage.snapshot();
    const kernels::Light& light = snapshot.light_keys[0];
    const float s = std::sqrt(0.5f);
    EXPECT_NEAR(light.direction.y, -s, 1e-6);
    EXPECT_NEAR(light.direction.z, -s, 1e-6);
    EXPECT_NEAR(std::abs(light.axis_u.x), 1, 1e-6);  // half of 2 m
    EXPECT_NEAR(dot(light.axis_v, light.axis_v), 0.25, 1e-6);
    EXPECT_NEAR(dot(light.axis_v, light.direction), 0, 1e-6);
}

TEST(Lights, OfTheSceneShineAlongTheirNode) {
    Stage stage;
    SceneLight spot;
    spot.kind = kernels::LightKind::spot;
    spot.intensity = 7;
    spot.inner_rad = 0.2;
    spot.outer_rad = 0.4;
    stage.scene.lights.push_back(spot);
    const int node = stage.add_node("lamp", -1, false);
    stage.node(node).light = 0;
    stage.node(node).translation = {0, 3, 0};
    stage.node(node).rotation = test::turn(-90, {1, 0, 0});
    stage.node(node).scale = {2, 2, 2};
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.light_keys.size(), 1u);
    EXPECT_NEAR(snapshot.light_keys[0].direction.y, -1, 1e-6);
    EXPECT_FLOAT_EQ(snapshot.light_keys[0].radiance.x, 7);
    EXPECT_FLOAT_EQ(snapshot.light_keys[0].cos_outer, std::cos(0.4f));
    EXPECT_EQ(snapshot.environment.radiance.x, 0);  // a light: the default environment is black
    stage.shot.use_scene_lights = false;
    EXPECT_TRUE(stage.snapshot().light_keys.empty());
}

TEST(Lights, SayWhenTheyHaveNoDirection) {
    Stage stage;
    LightSpec sun = point_light();
    sun.kind = LightKind::directional;
    sun.direction = Track<glm::dvec3>(glm::dvec3(0));
    stage.shot.lights.push_back(sun);
    EXPECT_EQ(message_of([&] { stage.snapshot(); }),
              "stage.yaml:20:3: error: light 'bulb' has no direction at 0 s\n"
              "  expected a direction other than [0, 0, 0]");
}

/// Lengths count in the frame's unit, and with them what is measured at a metre.
TEST(LightKeys, CountLengthsInTheUnitOfTheFrame) {
    Stage stage;
    stage.add_node("Cube");
    stage.shot.camera.position = glm::dvec3(0, 0, 0.01);  // shows 5 mm: the unit is 2^-8 m
    LightSpec point, panel, sun;
    point.kind = LightKind::point;
    point.strength = Track<double>(3.0);
    point.position = glm::dvec3(0, 1, 0);
    point.radius_m = Track<double>(0.5);
    point.range_m = Track<double>(2.0);
    panel = point;
    panel.kind = LightKind::area;
    panel.direction = Track<glm::dvec3>(glm::dvec3(0, -1, 0));
    panel.size_m = Track<glm::dvec2>(glm::dvec2(4, 4));
    sun = point;
    sun.kind = LightKind::directional;
    sun.direction = Track<glm::dvec3>(glm::dvec3(0, -1, 0));
    stage.shot.lights = {point, panel, sun};
    const SceneSnapshot snapshot = stage.snapshot();
    const double units = 1 / snapshot.unit_m;  // of a metre
    ASSERT_GT(units, 1);
    const kernels::Light &p = snapshot.light_keys[0], &a = snapshot.light_keys[1], &s = snapshot.light_keys[2];
    EXPECT_EQ(p.position.y, 1 * units);
    EXPECT_EQ(p.radius, 0.5 * units);
    EXPECT_EQ(p.range, 2 * units);
    EXPECT_EQ(p.radiance.x, 3 * units * units);  // candela: lux at one unit
    EXPECT_EQ(length(a.axis_u), 2 * units);
    EXPECT_EQ(a.radiance.x, 3);  // nit
    EXPECT_EQ(s.radiance.x, 3);  // lux
}

}  // namespace
}  // namespace kadr
