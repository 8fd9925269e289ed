#include "stress/ray_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "device/eye.h"
#include "kernels/sampler/sobol.h"
#include "kernels/sampler/warp.h"

namespace kadr::stress {
namespace {

constexpr int kBundle = 5;
constexpr float kApart_px = 0.1f;
/// The middle of a bundle and what surrounds it.
constexpr float kOffsets[kBundle][2] = {{0, 0}, {kApart_px, 0}, {-kApart_px, 0}, {0, kApart_px}, {0, -kApart_px}};

using Bundle = std::array<SurfaceHit, kBundle>;

glm::dvec3 to_glm(const kernels::Vec3<double>& v) { return {v.x, v.y, v.z}; }
kernels::Vec3f to_float(const glm::dvec3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

/// Off the pixels' centres and edges, where meshes of generated shots have theirs.
std::vector<kernels::Vec2f> film_points(const kernels::Settings& settings, int edge) {
    std::vector<kernels::Vec2f> points;
    for (int y = 0; y < settings.height * edge; ++y)
        for (int x = 0; x < settings.width * edge; ++x)
            points.push_back({(static_cast<float>(x) + 0.437f) / static_cast<float>(edge), (static_cast<float>(y) + 0.571f) / static_cast<float>(edge)});
    return points;
}

std::vector<Bundle> look_in_bundles(Probe& reference, const std::vector<kernels::Vec2f>& points) {
    std::vector<kernels::Vec2f> all;
    for (const kernels::Vec2f& p : points)
        for (const auto& offset : kOffsets) all.push_back({p.x + offset[0], p.y + offset[1]});
    const std::vector<SurfaceHit> hits = reference.look(all, 0);
    std::vector<Bundle> bundles(points.size());
    for (std::size_t i = 0; i < hits.size(); ++i) bundles[i / kBundle][i % kBundle] = hits[i];
    return bundles;
}

/// Whether a value is the same for all members.
template <class Members, class Value>
bool agree(const Members& members, const Value& value) {
    return std::all_of(members.begin(), members.end(), [&](const auto& member) { return value(member) == value(members.front()); });
}

class Comparison {
public:
    Comparison(Device& device, Device& reference, const SceneSnapshot& snapshot, const RayCounts& counts)
        : device_(*device.probe()), reference_(*reference.probe()), snapshot_(snapshot), counts_(counts), eye_(snapshot) {}

    RayFigures run() {
        points_ = film_points(snapshot_.settings, counts_.per_pixel_edge);
        const std::vector<SurfaceHit> seen = device_.look(points_, 0);
        const std::vector<Bundle> truth = look_in_bundles(reference_, points_);
        for (std::size_t i = 0; i < points_.size(); ++i) compare_hit(seen[i], truth[i]);
        send_shadow_rays(seen, truth);
        for (int light = 0; light < reference_.light_count(); ++light) send_light_rays(light, seen, truth);
        return figures_;
    }

private:
    std::uint32_t material_of(const SurfaceHit& hit) const { return snapshot_.instances[static_cast<std::size_t>(hit.instance)].material; }

    void compare_hit(const SurfaceHit& seen, const Bundle& truth) {
        if (!agree(truth, [](const SurfaceHit& hit) { return hit.met(); })) return;
        const bool met = truth[0].met();
        if (met && !agree(truth, [](const SurfaceHit& hit) { return hit.instance; })) return;
        ++figures_.camera_rays;
        if (seen.met() != met) ++figures_.holes;
        if (!met || !seen.met()) return;
        if (material_of(seen) != material_of(truth[0]) && !same_place(seen, truth[0])) ++figures_.wrong_surfaces;
        if (seen.instance == truth[0].instance) note_position(seen, truth[0]);
    }

    /// Surfaces in one place, as far as floats tell distances from where the ray starts apart: which of them is in front, not
    /// even the file says.
    bool same_place(const SurfaceHit& seen, const SurfaceHit& truth) const {
        return std::abs(glm::dot(to_glm(seen.position) - to_glm(truth.position), to_viewer(truth))) <= 8 * 0x1p-23 * seen.distance_m;
    }

    /// Across the ray: along it, nothing moves in the picture.
    void note_position(const SurfaceHit& seen, const SurfaceHit& truth) {
        const glm::dvec3 off = to_glm(seen.position) - to_glm(truth.position);
        const glm::dvec3 along = to_viewer(truth);
        const double across = glm::length(off - along * glm::dot(off, along));
        const glm::dvec3 p = glm::abs(to_glm(truth.position));
        const double largest = std::max({p.x, p.y, p.z, 1e-300});
        figures_.position_error_px = std::max(figures_.position_error_px, across / std::max(eye_.pixel_at(to_glm(truth.position)), 1e-30));
        figures_.position_error_ulp = std::max(figures_.position_error_ulp, glm::length(off) / (largest * 0x1p-23));
    }

    glm::dvec3 to_viewer(const SurfaceHit& hit) const {
        if (eye_.orthographic) return to_glm(hit.normal);
        const glm::dvec3 to_camera = eye_.place - to_glm(hit.position);
        const double distance = glm::length(to_camera);
        return distance > 0 ? to_camera / distance : to_glm(hit.normal);
    }

    /// By cosine about the surface's normal; a function of the point alone.
    static kernels::Vec3f direction_from(const SurfaceHit& hit, std::size_t point, int number) {
        const auto sampler = kernels::make_sampler<double>(static_cast<int>(point), 0, static_cast<unsigned>(number), 1u);
        const kernels::Vec2<double> disk = kernels::sample_disk(sampler.get_2d(0u));
        const double up = std::sqrt(std::max(0.0, 1 - disk.x * disk.x - disk.y * disk.y));
        const kernels::Vec3<double> d = kernels::Frame<double>(hit.normal).to_world({disk.x, disk.y, std::max(up, 1e-3)});
        return to_float(glm::normalize(to_glm(d)));
    }

    void send_shadow_rays(const std::vector<SurfaceHit>& seen, const std::vector<Bundle>& truth) {
        std::vector<SurfaceRay> rays, bundles;
        constexpr float kEndless_m = 1e30f;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Bundle& hits = truth[i];
            if (!seen[i].met() || !agree(hits, [](const SurfaceHit& hit) { return hit.instance; }) || seen[i].instance != hits[0].instance) continue;
            for (int k = 0; k < counts_.directions; ++k) {
                const kernels::Vec3f direction = direction_from(hits[0], i, k);
                rays.push_back({seen[i], to_float(to_viewer(seen[i])), direction, kEndless_m});
                for (const SurfaceHit& hit : hits) bundles.push_back({hit, to_float(to_viewer(hit)), direction, kEndless_m});
            }
        }
        const std::vector<char> found = device_.occluded(rays, 0), exact = reference_.occluded(bundles, 0);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto first = exact.begin() + static_cast<std::ptrdiff_t>(i) * kBundle;
            if (!std::all_of(first, first + kBundle, [&](char answer) { return answer == *first; })) continue;
            ++figures_.shadow_rays;
            if (found[i] && !*first) ++figures_.false_shadows;
            if (!found[i] && *first) ++figures_.leaks;
        }
    }

    /// Random numbers of a point on a light, those of a bundle a little apart: what hides the light may end there.
    static kernels::Vec3f point_on_light(std::size_t point, int number, int member) {
        constexpr float kApart = 1e-3f;
        const auto sampler = kernels::make_sampler<double>(static_cast<int>(point), 1, static_cast<unsigned>(number), 1u);
        const kernels::Vec2<double> u = sampler.get_2d(0u);
        const auto within = [](double x) { return std::clamp(static_cast<float>(x), 0.0f, kernels::kOneMinusEpsilon); };
        return {within(u.x + kApart * kOffsets[member][0] / kApart_px), within(u.y + kApart * kOffsets[member][1] / kApart_px), within(sampler.get_1d(1u))};
    }

    void send_light_rays(int light, const std::vector<SurfaceHit>& seen, const std::vector<Bundle>& truth) {
        std::vector<LightRay> rays, bundles;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Bundle& hits = truth[i];
            if (!seen[i].met() || !agree(hits, [](const SurfaceHit& hit) { return hit.instance; }) || seen[i].instance != hits[0].instance) continue;
            for (int k = 0; k < counts_.directions; ++k) {
                rays.push_back({seen[i], to_float(to_viewer(seen[i])), light, point_on_light(i, k, 0)});
                for (int m = 0; m < kBundle; ++m) bundles.push_back({hits[static_cast<std::size_t>(m)], to_float(to_viewer(hits[static_cast<std::size_t>(m)])), light, point_on_light(i, k, m)});
            }
        }
        const std::vector<LightSight> found = device_.towards_lights(rays, 0), exact = reference_.towards_lights(bundles, 0);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto first = exact.begin() + static_cast<std::ptrdiff_t>(i) * kBundle;
            const bool clear = std::all_of(first, first + kBundle, [&](LightSight sight) { return sight == *first; });
            if (!clear || *first == LightSight::not_towards || found[i] == LightSight::not_towards) continue;
            ++figures_.light_rays;
            if (found[i] == *first) continue;
            ++(found[i] == LightSight::hidden ? figures_.false_shadows : figures_.leaks);
        }
    }

    Probe& device_;
    Probe& reference_;
    const SceneSnapshot& snapshot_;
    const RayCounts& counts_;
    const Eye eye_;
    std::vector<kernels::Vec2f> points_;
    RayFigures figures_;
};

}  // namespace

RayFigures operator+(const RayFigures& a, const RayFigures& b) {
    return {a.camera_rays + b.camera_rays, a.holes + b.holes, a.wrong_surfaces + b.wrong_surfaces,
            std::max(a.position_error_px, b.position_error_px), std::max(a.position_error_ulp, b.position_error_ulp),
            a.shadow_rays + b.shadow_rays, a.light_rays + b.light_rays, a.false_shadows + b.false_shadows, a.leaks + b.leaks};
}

RayFigures compare_rays(Device& device, Device& reference, const SceneSnapshot& snapshot, const RayCounts& counts) {
    return Comparison(device, reference, snapshot, counts).run();
}

}  // namespace kadr::stress
