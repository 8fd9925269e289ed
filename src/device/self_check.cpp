#include "device/self_check.h"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"

namespace kadr {
namespace {

constexpr int kSize = 20;      ///< pixels, both sides of the picture
constexpr int kSamples = 16;   ///< of a pixel
constexpr float kApart_px = 0.02f;
/// Between the brightness of both pictures: they draw the same samples, of which a few meet another side of an edge.
constexpr double kMostDifference = 0.01;
constexpr double kWorthKeeping_s = 1;

GeometryData sphere(int rings) {
    GeometryData g;
    g.name = "sphere";
    const int columns = 2 * rings;
    for (int r = 0; r <= rings; ++r)
        for (int c = 0; c <= columns; ++c) {
            const double theta = 3.14159265358979 * r / rings, phi = 2 * 3.14159265358979 * c / columns;
            const glm::dvec3 p(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
            g.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
        }
    g.normals = g.positions;
    for (int r = 0; r < rings; ++r)
        for (int c = 0; c < columns; ++c) {
            const auto a = static_cast<unsigned>(r * (columns + 1) + c), b = a + static_cast<unsigned>(columns) + 1;
            for (const unsigned i : {a, a + 1, b, a + 1, b + 1, b}) g.indices.push_back(i);
        }
    return g;
}

GeometryData square() {
    GeometryData g;
    g.name = "square";
    g.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    g.indices = {0, 1, 2, 0, 2, 3};
    g.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    return g;
}

/// Every other of 4 x 4 texels is a hole.
TextureData holes() {
    TextureData t;
    t.width = t.height = 4;
    t.nearest = true;
    for (int i = 0; i < 16; ++i)
        for (const int value : {200, 160, 60, (i + i / 4) % 2 == 0 ? 255 : 0}) t.texels.push_back(static_cast<std::uint8_t>(value));
    return t;
}

/// Fills a CheckScene.
class Builder {
public:
    explicit Builder(CheckScene& check) : scene_(check.scene), snapshot_(check.snapshot) {}

    void add(unsigned geometry, kernels::Vec3f color, const std::vector<kernels::FrameSrt>& frames) {
        kernels::Material m;
        m.base_color = color;
        m.metallic = 0;
        m.roughness = 0.6f;
        scene_.materials.push_back(m);
        SnapshotInstance instance;
        instance.geometry = geometry;
        instance.material = static_cast<std::uint32_t>(scene_.materials.size() - 1);
        instance.id = static_cast<std::uint32_t>(snapshot_.instances.size());
        snapshot_.instances.push_back(instance);
        MotionFrames& motion = snapshot_.motion;
        motion.types.push_back(FrameType::srt);
        motion.headers.push_back({static_cast<unsigned>(motion.srt.size()), static_cast<unsigned>(frames.size())});
        motion.linear.push_back(0);
        for (const kernels::FrameSrt& frame : frames) motion.srt.push_back(frame);
    }

    static kernels::FrameSrt place(kernels::Vec3f axis, float angle, kernels::Vec3f scale, kernels::Vec3f at, float time = 0) {
        return {{axis.x, axis.y, axis.z}, angle, {scale.x, scale.y, scale.z}, {at.x, at.y, at.z}, time, 0};
    }

    void bend(unsigned geometry) {
        auto mesh = std::make_shared<DeformedMesh>();
        mesh->geometry = geometry;
        mesh->key_count = 3;
        mesh->version = 1;
        for (unsigned k = 0; k < mesh->key_count; ++k)
            for (kernels::Vec3f p : scene_.geometries[geometry].positions) {
                const kernels::Vec3f normal = p;
                p.x += 0.25f * static_cast<float>(k) * p.y * p.y;
                mesh->vertices.push_back({p, normal, {0, 0}});
            }
        snapshot_.instances.edit_back().deformed = static_cast<int>(snapshot_.deformed.size());
        snapshot_.deformed.push_back(std::move(mesh));
    }

    void add_light(kernels::Vec3f position) {
        kernels::Light light;
        light.radiance = {40, 38, 34};
        light.position = position;
        snapshot_.lights.push_back({static_cast<std::uint32_t>(snapshot_.light_keys.size()), 1});
        snapshot_.light_keys.push_back(light);
    }

    void set_camera() {
        kernels::CameraKey key{};
        key.position = {0, 0.5f, 7};
        key.rotation[3] = 1;
        key.tan_half_width = key.tan_half_height = 0.4f;
        key.focus_distance = 1;
        snapshot_.camera_keys = {key};
        snapshot_.camera.key_count = 1;
        snapshot_.camera.far_clip = INFINITY;
        snapshot_.settings.width = snapshot_.settings.height = kSize;
        snapshot_.settings.max_bounces = snapshot_.settings.max_diffuse = snapshot_.settings.max_glossy = 3;
    }

private:
    Scene& scene_;
    SceneSnapshot& snapshot_;
};

/// Camera rays at one time, each with what surrounds it.
constexpr int kBundle = 5;
constexpr float kOffsets[kBundle][2] = {{0, 0}, {kApart_px, 0}, {-kApart_px, 0}, {0, kApart_px}, {0, -kApart_px}};

std::vector<kernels::Vec2f> film_points() {
    std::vector<kernels::Vec2f> points;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) points.push_back({static_cast<float>(x) + 0.437f, static_cast<float>(y) + 0.571f});
    return points;
}

bool same(const SurfaceHit& a, const SurfaceHit& b) { return a.instance == b.instance && (!a.met() || a.primitive == b.primitive); }

/// A hit of the reference whose neighbourhood sees the same triangle.
struct ClearHit {
    std::size_t index;
    SurfaceHit hit;
};

std::vector<ClearHit> clear_hits(Probe& reference, const std::vector<kernels::Vec2f>& points, double time) {
    std::vector<kernels::Vec2f> all;
    for (const kernels::Vec2f& p : points)
        for (const auto& offset : kOffsets) all.push_back({p.x + offset[0], p.y + offset[1]});
    const std::vector<SurfaceHit> hits = reference.look(all, time);
    std::vector<ClearHit> clear;
    for (std::size_t i = 0; i < points.size(); ++i) {
        bool agree = true;
        for (std::size_t k = 1; k < kBundle; ++k) agree = agree && same(hits[i * kBundle], hits[i * kBundle + k]);
        if (agree) clear.push_back({i, hits[i * kBundle]});
    }
    return clear;
}

struct Counted {
    int wrong = 0, of = 0;
};

Counted compare_hits(const std::vector<SurfaceHit>& found, const std::vector<ClearHit>& expected) {
    Counted counted;
    for (const ClearHit& clear : expected) {
        ++counted.of;
        const SurfaceHit &a = found[clear.index], &b = clear.hit;
        // The scene is a few metres deep, and floats leave 1e-6 of that; at grazing angles ten times as much.
        if (!same(a, b) || (b.met() && std::abs(a.distance_m - b.distance_m) > 1e-3)) ++counted.wrong;
    }
    return counted;
}

/// From every surface towards the light, and sideways.
std::vector<SurfaceRay> shadow_rays(const std::vector<ClearHit>& hits) {
    std::vector<SurfaceRay> rays;
    for (const ClearHit& clear : hits)
        if (clear.hit.met())
            rays.push_back({clear.hit, kernels::splat<float>(clear.hit.normal), kernels::normalize(kernels::Vec3f{0.5f, 0.7f, 0.4f}), 1e30f});
    return rays;
}

/// Of shadow rays the reference alone cannot tell which graze an edge, and one in a hundred may.
Counted compare_shadows(Probe& device, Probe& reference, const std::vector<SurfaceRay>& rays, double time) {
    const std::vector<char> found = device.occluded(rays, time), expected = reference.occluded(rays, time);
    Counted counted{0, static_cast<int>(rays.size())};
    for (std::size_t i = 0; i < rays.size(); ++i) counted.wrong += (found[i] != 0) != (expected[i] != 0) ? 1 : 0;
    return counted;
}

double brightness(Device& device) {
    Film film(kSize, kSize, {});
    film.clear();
    Pass pass;
    pass.sample_count = pass.total_samples = kSamples;
    device.begin_film(film);
    device.render(pass, film);
    device.read_film(film);
    double sum = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) sum += film.beauty(x, y).r + film.beauty(x, y).g + film.beauty(x, y).b;
    return sum;
}

void show(Device& device, const CheckScene& check) {
    device.load(check.scene, nullptr);
    device.set_frame(check.snapshot);
}

}  // namespace

CheckScene make_check_scene() {
    CheckScene check;
    check.scene.geometries = {sphere(12), square()};
    check.scene.textures = {holes()};
    Builder builder(check);
    builder.set_camera();
    builder.add(1, {0.7f, 0.7f, 0.6f}, {Builder::place({1, 0, 0}, -1.5707964f, {4, 4, 4}, {0, -1.2f, 0})});
    builder.add(0, {0.2f, 0.5f, 0.9f}, {Builder::place({0, 1, 0}, 0.3f, {0.7f, 0.9f, 0.7f}, {-1.6f, 0, -0.5f})});
    std::vector<kernels::FrameSrt> turning;
    for (const float k : {0.0f, 0.5f, 1.0f}) turning.push_back(Builder::place({0, 0, 1}, 0.34f * k, {0.5f, 0.8f, 0.5f}, {-0.2f + 0.4f * k, 0.8f, 0}, k));
    builder.add(0, {0.9f, 0.3f, 0.2f}, turning);
    builder.add(0, {0.3f, 0.8f, 0.4f}, {Builder::place({0, 1, 0}, 0, {0.7f, 0.7f, 0.7f}, {1.4f, -0.2f, 0})});
    builder.bend(0);
    builder.add(1, {1, 1, 1}, {Builder::place({0, 1, 0}, 0.4f, {0.6f, 0.6f, 0.6f}, {0.3f, -0.4f, 1.5f})});
    kernels::Material& cut = check.scene.materials.back();
    cut.alpha_mode = kernels::AlphaMode::mask;
    cut.base_color_texture.texture = 0;
    builder.add_light({2, 4, 4});
    check.snapshot.close_s = 1;
    check.snapshot.geometry_key = 1;
    return check;
}

std::string find_fault(Device& device, Device& reference) {
    const CheckScene check = make_check_scene();
    show(device, check);
    show(reference, check);
    const std::vector<kernels::Vec2f> points = film_points();
    Counted hits, shadows;
    for (const double time : {0.0, 0.6}) {
        const std::vector<ClearHit> expected = clear_hits(*reference.probe(), points, time);
        const Counted h = compare_hits(device.probe()->look(points, time), expected);
        const Counted s = compare_shadows(*device.probe(), *reference.probe(), shadow_rays(expected), time);
        hits = {hits.wrong + h.wrong, hits.of + h.of};
        shadows = {shadows.wrong + s.wrong, shadows.of + s.of};
    }
    if (hits.wrong > 0) return fmt::format("gave {} wrong hits of {}", hits.wrong, hits.of);
    if (100 * shadows.wrong > shadows.of) return fmt::format("gave {} wrong shadows of {}", shadows.wrong, shadows.of);
    const double seen = brightness(device), expected = brightness(reference);
    if (!(std::abs(seen / expected - 1) <= kMostDifference)) return fmt::format("gave a picture {:.2g} times as bright as the CPU's", seen / expected);
    return "";
}

std::string kept_fault(const std::filesystem::path& file, const std::function<std::string()>& check) {
    if (std::ifstream kept(file, std::ios::binary); !file.empty() && kept) {
        std::ostringstream text;
        text << kept.rdbuf();
        return text.str();
    }
    const auto begin = std::chrono::steady_clock::now();
    std::string fault;
    try {
        fault = check();
    } catch (const InputError& error) {
        return "failed: " + error.diagnostics().front().found;
    } catch (const RenderError& error) {
        return fmt::format("failed: {}", error.what());
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (seconds > kWorthKeeping_s && !file.empty()) {
        // Another process may read it at the same time: it gets the whole outcome or none.
        std::error_code ignored;
        std::filesystem::create_directories(file.parent_path(), ignored);
        const std::filesystem::path part = file.string() + fmt::format(".{}", begin.time_since_epoch().count());
        std::ofstream(part, std::ios::binary) << fault;
        std::filesystem::rename(part, file, ignored);
    }
    return fault;
}

}  // namespace kadr
