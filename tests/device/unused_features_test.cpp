// What a scene holds but does not show asks for no kernel code, and leaves every pixel alone.
#include <gtest/gtest.h>

#include "device/same_picture.h"
#include "device/varied_scenes.h"

namespace kadr::test {
namespace {

kernels::Material glowing() {
    kernels::Material m = material({0.5f, 0.5f, 0.5f}, 0, 1);
    m.emission = {5, 5, 5};
    return m;
}

GeometryData colored_square() {
    GeometryData g = unit_square();
    g.colors.assign(g.positions.size(), {1, 0, 0, 1});
    return g;
}

/// Something right before the camera's subject that is not there.
void add_hidden(SmallScene& s, GeometryData mesh, const kernels::Material& m, bool moving = false) {
    const unsigned geometry = s.add_mesh(std::move(mesh));
    if (moving)
        s.add_moving(geometry, m, {place({0, 0, 2}), place({1, 0, 2})});
    else
        s.add_instance(geometry, m, place({0, 0, 2}));
    s.snapshot.instances.edit_back().mask = 0;
}

kernels::Light dark(kernels::LightKind kind, float radius) {
    kernels::Light light;
    light.kind = kind;
    light.position = {0, 2, 2};
    light.direction = {0, -1, 0};
    light.axis_u = {1, 0, 0};
    light.axis_v = {0, 0, 1};
    light.radius = radius;
    return light;
}

void add_dark_sky(SmallScene& s) {
    s.environment.width = s.environment.height = 2;
    s.environment.channels = {"R", "G", "B"};
    s.environment.pixels.assign(12, 1.0f);
}

const std::vector<VariedScene>& unused_features() {
    static const std::vector<VariedScene> all{
        {"a material with textures that nothing has",
         [](SmallScene& s) { s.scene.materials.push_back(textured(kernels::AlphaMode::blend)); }},
        {"a hidden mesh with textures", [](SmallScene& s) { add_hidden(s, unit_square(), textured(kernels::AlphaMode::mask)); }},
        {"a mesh with textures that has no triangles",
         [](SmallScene& s) {
             GeometryData empty = unit_square();
             empty.indices.clear();
             s.add_instance(s.add_mesh(empty), textured(kernels::AlphaMode::opaque), place({0, 0, 2}));
         }},
        {"a texture of light that is out",
         [](SmallScene& s) {
             kernels::Material m = material({0.7f, 0.5f, 0.3f}, 0, 0.5f);
             m.emissive_texture.texture = 0;
             s.scene.materials[0] = m;
         }},
        {"a hidden mesh with colours", [](SmallScene& s) { add_hidden(s, colored_square(), glowing()); }},
        {"a hidden mesh that glows", [](SmallScene& s) { add_hidden(s, unit_square(), glowing()); }},
        {"a hidden mesh that moves", [](SmallScene& s) { add_hidden(s, unit_square(), glowing(), true); }},
        {"a hidden mesh that bends",
         [](SmallScene& s) {
             add_bent(s, 3, glowing());
             s.snapshot.instances.edit_back().mask = 0;
         }},
        {"an area light that is out", [](SmallScene& s) { s.add_light(dark(kernels::LightKind::area, 0)); }},
        {"a sphere that is out", [](SmallScene& s) { s.add_light(dark(kernels::LightKind::point, 0.3f)); }},
        {"a lamp that is out", [](SmallScene& s) { s.add_light(dark(kernels::LightKind::spot, 0)); }},
        {"an image of the sky without strength", add_dark_sky},
    };
    return all;
}

/// A dielectric ball on a floor, under a lamp; around it, nothing.
SmallScene plain(kernels::IntegratorKind integrator) {
    SmallScene s = sunlit(integrator);
    s.scene.textures.push_back(chequered());
    s.add_instance(s.add_mesh(unit_sphere(16)), material({0.7f, 0.5f, 0.3f}, 0, 0.5f), glm::dmat4(1));
    add_floor(s, true);
    return s;
}

TEST(UnusedFeature, AsksForNoKernelCodeAndChangesNoPixel) {
    for (const auto integrator : {kernels::IntegratorKind::path, kernels::IntegratorKind::direct}) {
        SmallScene without = plain(integrator);
        const SmallScene::Result expected = without.render(8, 1);
        ASSERT_EQ(expected.statistics.required, 0u);
        for (const VariedScene& feature : unused_features()) {
            SmallScene s = plain(integrator);
            feature.add(s);
            const SmallScene::Result result = s.render(8, 1);
            EXPECT_EQ(result.statistics.required, 0u) << feature.name;
            EXPECT_TRUE(same_bits(result.image, expected.image)) << feature.name;
            EXPECT_EQ(result.statistics.rays, expected.statistics.rays) << feature.name;
        }
    }
}

TEST(UnusedFeature, OneThatIsUsedIsNoneOfThem) {
    for (const VariedScene& feature : unused_features()) {
        SmallScene s = plain(kernels::IntegratorKind::path);
        const std::size_t before = s.snapshot.instances.size(), lights = s.snapshot.lights.size();
        feature.add(s);
        if (s.snapshot.instances.size() > before) s.snapshot.instances.edit_back().mask = 1;
        if (s.snapshot.lights.size() > lights) s.snapshot.light_keys.back().radiance = {1, 1, 1};
        if (s.environment.width > 0) s.snapshot.environment.radiance = {1, 1, 1};
        const kernels::Material first = s.scene.materials[0];
        if (first.emissive_texture.texture >= 0) s.scene.materials[0].emission = {1, 1, 1};
        const bool stays_unused = feature.name.find("nothing has") != std::string::npos || feature.name.find("no triangles") != std::string::npos ||
                                  feature.name == "a lamp that is out";  // every kernel has lamps
        EXPECT_EQ(s.render(1, 1).statistics.required == 0, stays_unused) << feature.name;
    }
}

}  // namespace
}  // namespace kadr::test
