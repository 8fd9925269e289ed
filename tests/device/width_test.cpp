// One lane and eight lanes: the same pixels, for everything that a scene can hold.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "device/embree/embree_device.h"
#include "device/small_scene.h"

namespace kadr::test {
namespace {

kernels::Light sun() {
    kernels::Light light;
    light.kind = kernels::LightKind::directional;
    light.radiance = {2, 2, 2};
    light.direction = {-0.3f, -0.5f, -0.8124f};
    return light;
}

SmallScene base(kernels::IntegratorKind integrator) {
    SmallScene s;
    s.snapshot.settings.integrator = integrator;
    s.snapshot.settings.max_bounces = s.snapshot.settings.max_diffuse = s.snapshot.settings.max_glossy = 4;
    s.camera({0, 1, 6}, {0, 0, 0}, 0.4);
    s.add_light(sun());
    return s;
}

void add_floor(SmallScene& s, bool fixed) {
    s.add_instance(s.add_mesh(unit_square()), material({0.7f, 0.7f, 0.6f}, 0, 0.5f),
                   glm::rotate(place({0, -1, 0}, 4), -kPi / 2, glm::dvec3(1, 0, 0)), fixed);
}

void add_bent(SmallScene& s, unsigned keys, const kernels::Material& m) {
    const GeometryData g = unit_sphere(16);
    const unsigned geometry = s.add_mesh(g);
    s.add_instance(geometry, m, glm::dmat4(1), false);
    s.snapshot.instances.edit_back().deformed = 0;
    auto mesh = std::make_shared<DeformedMesh>();
    mesh->geometry = geometry;
    mesh->key_count = keys;
    mesh->version = 1;
    for (unsigned k = 0; k < keys; ++k)
        for (std::size_t v = 0; v < g.positions.size(); ++v) {
            const kernels::Vec3f p = g.positions[v];
            const float c = std::cos(0.3f * static_cast<float>(k) * p.y),
                        n = std::sin(0.3f * static_cast<float>(k) * p.y);
            const kernels::Vec3f turned{p.x * c + p.z * n, p.y, p.z * c - p.x * n};
            mesh->vertices.push_back({turned, turned, {p.x, p.y}});
        }
    s.snapshot.deformed.push_back(mesh);
}

struct Content {
    std::string name;
    std::function<void(SmallScene&)> add;
};

const std::vector<Content>& contents() {
    static const kernels::Material shiny = material({0.7f, 0.5f, 0.3f}, 0.5f, 0.3f);
    static const auto half = [] {
        kernels::Material m = material({0.7f, 0.5f, 0.3f}, 0, 0.6f);
        m.alpha_mode = kernels::AlphaMode::blend;
        m.alpha = 0.5f;
        return m;
    }();
    static const std::vector<Content> all{
        {"rigid",
         [](SmallScene& s) {
             s.add_instance(s.add_mesh(unit_sphere(16)), shiny, glm::dmat4(1));
             add_floor(s, true);
         }},
        {"instanced",
         [](SmallScene& s) {
             const unsigned mesh = s.add_mesh(unit_sphere(16));
             for (int i = -1; i <= 1; ++i) s.add_instance(mesh, shiny, place({1.5 * i, 0.2 * i, -0.5 * i}, 0.7), false);
             add_floor(s, false);
         }},
        {"bending",
         [](SmallScene& s) {
             add_bent(s, 1, shiny);
             add_floor(s, true);
         }},
        {"bending and blurred",
         [](SmallScene& s) {
             add_bent(s, 5, shiny);
             add_floor(s, true);
         }},
        {"bending, blurred and half there",
         [](SmallScene& s) {
             add_bent(s, 3, half);
             add_floor(s, true);
         }},
        {"moving",
         [](SmallScene& s) {
             s.add_moving(
                 s.add_mesh(unit_sphere(16)), shiny,
                 {place({-1, 0, 0}), glm::rotate(place({0, 0, 0}), 0.6, glm::dvec3(0, 1, 0)), place({1, 0, 0})});
             add_floor(s, false);
         }},
    };
    return all;
}

std::string name_of(int width) {
    DeviceRequest request;
    request.name = "cpu";
    request.threads = 1;
    request.width = width;
    return make_device(request).device->name();
}

TEST(Width, EveryPixelIsTheSameInOneLaneAndInEight) {
    if (best_width() < 8) GTEST_SKIP() << "this processor has no AVX2";
    ASSERT_NE(name_of(1).find("1 lane,"), std::string::npos);
    ASSERT_NE(name_of(8).find("8 lanes,"), std::string::npos);
    FilmLayers layers;
    layers.depth = layers.normal = layers.albedo = true;
    for (const auto integrator : {kernels::IntegratorKind::direct, kernels::IntegratorKind::path})
        for (const Content& content : contents()) {
            SmallScene s = base(integrator);
            content.add(s);
            const SmallScene::Result one = s.render(16, 1, 1, layers);
            // No tolerance: both forms are one source without contraction to fused operations, the order of additions
            // to a path is fixed, and Embree's packets meet what its single rays meet.
            EXPECT_EQ(one.image.pixels, s.render(16, 1, 8, layers).image.pixels) << content.name;
            EXPECT_GT(one.mean(), 0.05) << content.name;
        }
}

}  // namespace
}  // namespace kadr::test
