#pragma once

// Small scenes that hold, between them, everything that a scene can hold: what two ways of rendering the same thing are
// compared on.

#include <functional>
#include <string>

#include "device/small_scene.h"

namespace kadr::test {

inline kernels::Light directional(kernels::Vec3f radiance, kernels::Vec3f direction) {
    kernels::Light light;
    light.kind = kernels::LightKind::directional;
    light.radiance = radiance;
    light.direction = direction;
    return light;
}

inline SmallScene sunlit(kernels::IntegratorKind integrator) {
    SmallScene s;
    s.snapshot.settings.integrator = integrator;
    s.snapshot.settings.max_bounces = s.snapshot.settings.max_diffuse = s.snapshot.settings.max_glossy = 4;
    s.camera({0, 1, 6}, {0, 0, 0}, 0.4);
    s.add_light(directional({2, 2, 2}, {-0.3f, -0.5f, -0.8124f}));
    return s;
}

inline void add_floor(SmallScene& s, bool fixed) {
    s.add_instance(s.add_mesh(unit_square()), material({0.7f, 0.7f, 0.6f}, 0, 0.5f),
                   glm::rotate(place({0, -1, 0}, 4), -kPi / 2, glm::dvec3(1, 0, 0)), fixed);
}

inline void add_bent(SmallScene& s, unsigned keys, const kernels::Material& m) {
    const GeometryData g = unit_sphere(16);
    const unsigned geometry = s.add_mesh(g);
    s.add_instance(geometry, m, glm::dmat4(1), false);
    s.snapshot.instances.edit_back().deformed = static_cast<int>(s.snapshot.deformed.size());
    auto mesh = std::make_shared<DeformedMesh>();
    mesh->geometry = mesh->number = geometry;
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

/// Squares of 4 x 4 texels whose colour and coverage differ.
inline TextureData chequered() {
    TextureData t;
    t.width = t.height = 16;
    for (int y = 0; y < t.height; ++y)
        for (int x = 0; x < t.width; ++x) {
            const bool odd = ((x / 4 + y / 4) & 1) != 0;
            for (const int value : {odd ? 230 : 90, 40 + 10 * x, 60 + 10 * y, odd ? 255 : 60})
                t.texels.push_back(static_cast<std::uint8_t>(value));
        }
    return t;
}

inline kernels::Material half_there() {
    kernels::Material m = material({0.7f, 0.5f, 0.3f}, 0, 0.6f);
    m.alpha_mode = kernels::AlphaMode::blend;
    m.alpha = 0.5f;
    return m;
}

/// Textured everywhere a texture may go but for its normals; covers by `mode`.
inline kernels::Material textured(kernels::AlphaMode mode) {
    kernels::Material m = material({0.9f, 0.8f, 0.7f}, 1, 1);
    m.base_color_texture.texture = m.metallic_roughness_texture.texture = 0;
    m.base_color_texture.m00 = 2;
    m.alpha_mode = mode;
    return m;
}

struct VariedScene {
    std::string name;
    std::function<void(SmallScene&)> add;
};

inline const std::vector<VariedScene>& varied_scenes() {
    static const kernels::Material shiny = material({0.7f, 0.5f, 0.3f}, 0.5f, 0.3f);
    static const auto turned = [](double angle) { return glm::rotate(glm::dmat4(1), angle, glm::dvec3(0, 1, 0)); };
    static const std::vector<VariedScene> all{
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
             add_bent(s, 3, half_there());
             add_floor(s, true);
         }},
        {"moving",
         [](SmallScene& s) {
             s.add_moving(
                 s.add_mesh(unit_sphere(16)), shiny,
                 {place({-1, 0, 0}), glm::rotate(place({0, 0, 0}), 0.6, glm::dvec3(0, 1, 0)), place({1, 0, 0})});
             add_floor(s, false);
         }},
        {"glowing, under several lights, clamped",
         [](SmallScene& s) {
             s.snapshot.settings.clamp_direct = 0.6f;
             s.snapshot.settings.clamp_indirect = 0.2f;
             kernels::Material glow = shiny;
             glow.emission = {0.3f, 0.2f, 0.1f};
             s.add_instance(s.add_mesh(unit_sphere(16)), glow, glm::dmat4(1));
             add_floor(s, true);
             s.add_light(directional({0.7f, 0.3f, 0.1f}, {0.4f, -0.8f, -0.447f}));
             kernels::Light panel;
             panel.kind = kernels::LightKind::area;
             panel.radiance = {3, 4, 5};
             panel.position = {1, 3, 1};
             panel.direction = {0, -1, 0};
             panel.axis_u = {0.7f, 0, 0};
             panel.axis_v = {0, 0, 0.7f};
             s.add_light(panel);
         }},
        {"glowing and moving",
         [](SmallScene& s) {
             kernels::Material glow = shiny;
             glow.emission = {1, 2, 3};
             s.add_moving(s.add_mesh(unit_sphere(16)), glow, {place({-1, 0, 0}), turned(0.5), place({1, 0, 0})});
             add_floor(s, true);
         }},
        {"textured and cut out, under an image of the sky",
         [](SmallScene& s) {
             s.scene.textures.push_back(chequered());
             kernels::Material cut = textured(kernels::AlphaMode::mask);
             s.add_instance(s.add_mesh(unit_square()), cut, place({0, 0, 0.5}));
             s.add_instance(s.add_mesh(unit_square()), textured(kernels::AlphaMode::opaque), place({0.5, 0.3, -1}, 2));
             add_floor(s, true);
             s.environment.width = 8;
             s.environment.height = 4;
             s.environment.channels = {"R", "G", "B"};
             for (int i = 0; i < 3 * 32; ++i) s.environment.pixels.push_back(0.05f * static_cast<float>(1 + i % 7));
             s.snapshot.environment.radiance = {1, 1, 1};
         }},
        {"half there in several layers, turning",
         [](SmallScene& s) {
             s.scene.textures.push_back(chequered());
             const unsigned mesh = s.add_mesh(unit_square());
             s.add_instance(mesh, half_there(), place({0.3, 0.2, 1}), false);
             s.add_moving(mesh, textured(kernels::AlphaMode::blend), {turned(-0.3), turned(0.3)});
             add_floor(s, true);
         }},
        {"mirrors of metal and of glass, a panel in them",
         [](SmallScene& s) {
             kernels::Material glass = material({0.2f, 0.5f, 0.7f}, 0, 0.002f);
             glass.dielectric_f0 = 0.1f;
             s.add_instance(s.add_mesh(unit_sphere(16)), material({0.9f, 0.8f, 0.6f}, 0.8f, 0), place({-1.1, 0, 0}));
             s.add_instance(s.add_mesh(unit_sphere(16)), glass, place({1.1, 0, 0}));
             s.add_instance(s.add_mesh(unit_square()), material({0.9f, 0.9f, 0.9f}, 1, 0.01f), place({0, 0.5, -2}, 2));
             add_floor(s, true);
             kernels::Light panel;
             panel.kind = kernels::LightKind::area;
             panel.radiance = {5, 4, 3};
             panel.position = {0, 2, 3};
             panel.direction = {0, -0.55f, -0.835f};
             panel.axis_u = {0.7f, 0, 0};
             panel.axis_v = {0, 0.584f, -0.385f};
             s.add_light(panel);
         }},
        {"a lens, a rolling shutter and a filter with negative lobes",
         [](SmallScene& s) {
             s.add_moving(s.add_mesh(unit_sphere(16)), shiny, {place({-1, 0, 0}), turned(0.5), place({1, 0, 0})});
             add_floor(s, true);
             s.snapshot.settings.filter = kernels::FilterKind::mitchell;
             s.snapshot.settings.filter_radius = 2;
             s.snapshot.camera_keys[0].lens_radius = 0.2f;
             s.snapshot.camera_keys[0].focus_distance = 5;
             s.snapshot.camera.blades = 5;
             kernels::Shutter& shutter = s.snapshot.shutter;
             shutter.plain = false;
             shutter.direction = kernels::RollingDirection::down;
             shutter.first_open = -0.2f;
             shutter.delay = 1.4f;  // the last lines are closed
             shutter.length = 0.4f;
             for (int i = 0; i <= kernels::Shutter::kIntervals; ++i) {
                 const float x = static_cast<float>(i) / kernels::Shutter::kIntervals;
                 shutter.passed[i] = x * x * (3 - 2 * x);
             }
         }},
        {"dielectrics by Fresnel's equations before an area light",
         [](SmallScene& s) {
             s.snapshot.settings.exact_fresnel = true;
             kernels::Material coat = shiny;
             coat.metallic = 0.3f;
             s.add_instance(s.add_mesh(unit_sphere(16)), coat, place({-0.5, 0, 0}), false);
             add_floor(s, false);
             kernels::Light panel;
             panel.kind = kernels::LightKind::area;
             panel.radiance = {3, 3, 3};
             panel.position = {0, 2, -1};
             panel.direction = {0, -1, 0};
             panel.axis_v = {0, 0, 1};
             s.add_light(panel);
         }},
        {"culled from behind before nothing, with the motion since the frame before",
         [](SmallScene& s) {
             s.snapshot.environment.visible = false;
             s.snapshot.settings.cull_backfaces = true;
             s.add_instance(s.add_mesh(unit_square()), shiny, turned(kPi - 0.4) * place({0.5, 0, 0.5}), false);
             s.add_instance(s.add_mesh(unit_sphere(16)), shiny, place({-0.5, 0, 0}), false);
             add_floor(s, false);
             PreviousPlaces previous;
             previous.camera = s.snapshot.camera_keys[0];
             for (const double x : {0.1, 0.2, 0.0}) previous.space_from_geometry.push_back(place({x, 0, 0}));
             s.snapshot.previous = previous;
         }},
    };
    return all;
}

}  // namespace kadr::test
