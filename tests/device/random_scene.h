#pragma once

// Scenes that hold a random part of everything that a scene can hold.

#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "device/varied_scenes.h"

namespace kadr::test {

/// A fixed sequence of choices, the same on every machine (the distributions of the standard library are not).
class Dice {
public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    int below(int count) { return static_cast<int>(engine_() % static_cast<unsigned>(count)); }
    bool chance() { return below(2) == 0; }
    float between(float low, float high) { return low + (high - low) * static_cast<float>(below(1000)) / 999.0f; }
    kernels::Vec3f color(float low = 0.1f, float high = 0.9f) {
        return {between(low, high), between(low, high), between(low, high)};
    }
    glm::dvec3 point(double range) {
        const float r = static_cast<float>(range);
        return {between(-r, r), between(-r, r), between(-r, r)};
    }

private:
    std::mt19937 engine_;
};

/// A scene of a few instances and lights. Each seed allows a random subset of the features, small or large, so that scenes
/// of few requirements come up as scenes of many do.
class RandomScene {
public:
    RandomScene(unsigned seed, kernels::IntegratorKind integrator) : dice_(seed) {
        const int rarity = 3 + dice_.below(20);
        for (const std::string_view feature : kFeatures)
            if (dice_.below(rarity) == 0) features_.push_back(feature);
        scene.snapshot.settings.integrator = integrator;
        add_settings();
        add_camera();
        add_textures();
        for (int i = 2 + dice_.below(3); i > 0; --i) add_object();
        for (int i = dice_.below(3); i >= 0; --i) add_light();
        add_environment();
        add_previous();
        scene.snapshot.geometry_key = 1;
    }

    SmallScene scene;
    /// The features that the seed allows, for messages.
    std::string description() const {
        std::string text;
        for (const std::string_view feature : features_) text += (text.empty() ? "" : ", ") + std::string(feature);
        return text;
    }

private:
    static constexpr std::string_view kFeatures[] = {
        "instances", "mirrored", "linear motion", "turning", "bent", "bending", "flat", "vertex colours", "second set",
        "base texture", "roughness texture", "emission texture", "normal map", "mask", "blend", "unlit", "emission",
        "double sided", "metal", "sun", "wide sun", "point", "sphere", "spot", "area", "moving light", "dark light", "sky image", "hidden sky",
        "lens", "moving camera", "many camera keys", "orthographic", "gaussian", "mitchell", "rolling shutter", "clamp", "culled", "few bounces",
        "previous", "smooth", "ior", "exact Fresnel"};

    bool has(std::string_view feature) const {
        return std::find(features_.begin(), features_.end(), feature) != features_.end();
    }
    /// Whether a feature is allowed and comes up.
    bool draw(std::string_view feature) { return has(feature) && dice_.chance(); }

    void add_settings() {
        kernels::Settings& settings = scene.snapshot.settings;
        settings.width = 16;
        settings.height = 12;
        settings.seed = static_cast<unsigned>(dice_.below(1000));
        settings.max_bounces = settings.max_diffuse = settings.max_glossy = has("few bounces") ? dice_.below(2) : 4;
        if (has("clamp")) settings.clamp_direct = settings.clamp_indirect = 0.5f;
        settings.cull_backfaces = has("culled");
        settings.exact_fresnel = has("exact Fresnel");
        if (has("gaussian")) settings.filter = kernels::FilterKind::gaussian;
        if (has("mitchell")) settings.filter = kernels::FilterKind::mitchell;
        settings.filter_radius = settings.filter == kernels::FilterKind::box ? 0.5f : 1.5f;
        if (!has("rolling shutter")) return;
        kernels::Shutter& shutter = scene.snapshot.shutter;
        shutter.plain = false;
        shutter.direction = kernels::RollingDirection::left;
        shutter.delay = 0.5f;
        shutter.length = 0.5f;
        for (int i = 0; i <= kernels::Shutter::kIntervals; ++i)
            shutter.passed[i] = static_cast<float>(i) / kernels::Shutter::kIntervals;
    }

    void add_camera() {
        scene.camera({0.3, 1, 6}, {0, 0, 0}, 0.4);
        std::vector<kernels::CameraKey>& keys = scene.snapshot.camera_keys;
        if (has("lens")) {
            keys[0].lens_radius = 0.1f;
            keys[0].focus_distance = 5;
            scene.snapshot.camera.blades = dice_.below(7);
        }
        scene.snapshot.camera.orthographic = has("orthographic");
        if (has("orthographic")) keys[0].tan_half_width = keys[0].tan_half_height = 2;
        const int more = has("many camera keys") ? 3 : has("moving camera") ? 1 : 0;
        for (int k = 0; k < more; ++k) {
            keys.push_back(keys.back());
            keys.back().position.x += 0.1f;
        }
        scene.snapshot.camera.key_count = static_cast<int>(keys.size());
    }

    void add_textures() {
        scene.scene.textures.push_back(chequered());
        TextureData data = chequered();  // roughness, metallic, and a normal that leans
        data.format = kernels::TexelFormat::rgba8_linear;
        scene.scene.textures.push_back(data);
    }

    GeometryData mesh() {
        GeometryData g = dice_.chance() ? unit_sphere(6) : unit_square();
        const std::size_t count = g.positions.size();
        if (draw("flat")) g.normals.clear();
        if (g.uv[0].empty())
            for (const kernels::Vec3f& p : g.positions) g.uv[0].push_back({p.x, p.y});
        if (draw("second set"))
            for (const kernels::Vec3f& p : g.positions) g.uv[1].push_back({p.y, p.x});
        if (draw("vertex colours"))
            for (std::size_t i = 0; i < count; ++i) g.colors.push_back({0.5f, 1, dice_.between(0, 1), dice_.between(0, 1)});
        if (has("normal map"))
            for (const kernels::Vec3f& p : g.positions) {
                const float length = std::sqrt(p.x * p.x + p.y * p.y) + 1e-6f;
                g.tangents.push_back({-p.y / length, p.x / length, 0, dice_.chance() ? 1.0f : -1.0f});
            }
        return g;
    }

    kernels::Material material() {
        kernels::Material m = test::material(dice_.color(), has("metal") ? dice_.between(0, 1) : 0.0f, dice_.between(0.1f, 1));
        if (draw("emission")) m.emission = dice_.color(0, 2);
        if (draw("base texture")) m.base_color_texture.texture = 0;
        if (draw("roughness texture")) m.metallic_roughness_texture.texture = 1;
        if (draw("emission texture")) m.emissive_texture.texture = 0;
        if (draw("normal map")) m.normal_texture.texture = 1;
        if (draw("second set")) m.base_color_texture.uv_set = m.normal_texture.uv_set = 1;
        if (draw("mask")) m.alpha_mode = kernels::AlphaMode::mask;
        if (draw("blend")) m.alpha_mode = kernels::AlphaMode::blend;
        if (m.alpha_mode != kernels::AlphaMode::opaque) m.alpha = dice_.between(0.2f, 1);
        m.unlit = draw("unlit");
        if (draw("smooth")) m.roughness = dice_.chance() ? 0.0f : dice_.between(0, 0.03f);
        if (draw("ior")) m.dielectric_f0 = dice_.between(0, 0.5f);
        m.double_sided = draw("double sided");
        return m;
    }

    glm::dmat4 somewhere() {
        const glm::dmat4 at = glm::rotate(place(dice_.point(1.2), dice_.between(0.4f, 1.2f)), static_cast<double>(dice_.between(-3, 3)),
                                          glm::normalize(dice_.point(1) + glm::dvec3(0, 0, 1e-3)));
        return draw("mirrored") ? glm::scale(at, glm::dvec3(-1, 1, 0.5)) : at;
    }

    void add_object() {
        const kernels::Material m = material();
        if (draw("bent")) return add_bent(scene, 1, m);
        if (draw("bending")) return add_bent(scene, 3, m);
        const unsigned geometry = scene.add_mesh(mesh());
        // Many scenes are looked at along their axes: coordinates of zero, of either sign.
        const glm::dmat4 at = dice_.below(4) == 0 ? place({0, 0, 0}) : somewhere();
        if (draw("turning"))
            return scene.add_moving(geometry, m, {at, at * glm::rotate(glm::dmat4(1), 0.5, glm::dvec3(0, 1, 0)), at});
        if (draw("linear motion")) {
            scene.add_moving(geometry, m, {at, place({0.5, 0, 0}) * at});
            scene.snapshot.motion.linear.edit_back() = 1;
            return;
        }
        scene.add_instance(geometry, m, at, !draw("instances"));
    }

    void add_light() {
        kernels::Light light;
        light.radiance = has("dark light") && dice_.chance() ? kernels::Vec3f{0, 0, 0} : dice_.color(1, 6);
        light.position = {dice_.between(-2, 2), 3, dice_.between(0, 3)};
        light.direction = {0, -1, 0};
        light.axis_u = {0.5f, 0, 0};
        light.axis_v = {0, 0, 0.5f};
        light.kind = kernels::LightKind::directional;
        if (draw("wide sun")) light.one_minus_cos = 0.01f;
        if (draw("point")) light.kind = kernels::LightKind::point;
        if (draw("spot")) {
            light.kind = kernels::LightKind::spot;
            light.cos_inner = 0.95f;
            light.cos_outer = 0.7f;
            light.inner_rad = std::acos(0.95f);
            light.outer_rad = std::acos(0.7f);
        }
        if (draw("sphere")) light.radius = 0.3f;
        if (draw("area")) light.kind = kernels::LightKind::area;
        scene.add_light(light);
        if (!draw("moving light")) return;
        light.position.x += 0.5f;
        scene.snapshot.light_keys.push_back(light);
        scene.snapshot.lights.back().count = 2;
    }

    void add_environment() {
        scene.snapshot.environment.radiance = dice_.color(0.1f, 0.5f);
        scene.snapshot.environment.visible = !has("hidden sky");
        if (!has("sky image")) return;
        scene.environment.width = 8;
        scene.environment.height = 4;
        scene.environment.channels = {"R", "G", "B"};
        for (int i = 0; i < 3 * 32; ++i) scene.environment.pixels.push_back(dice_.between(0, 2));
    }

    void add_previous() {
        if (!has("previous")) return;
        PreviousPlaces previous;
        previous.camera = scene.snapshot.camera_keys[0];
        previous.space_from_geometry.assign(scene.snapshot.instances.size(), place({0.1, 0, 0}));
        for (const auto& mesh : scene.snapshot.deformed) {
            std::vector<kernels::Vec3f>& earlier = previous.deformed.emplace_back();
            const std::size_t count = mesh->vertices.size() / mesh->key_count;
            for (std::size_t i = 0; i < count; ++i) earlier.push_back(mesh->vertices[i].position);
        }
        scene.snapshot.previous = previous;
    }

    Dice dice_;
    std::vector<std::string_view> features_;
};

}  // namespace kadr::test
