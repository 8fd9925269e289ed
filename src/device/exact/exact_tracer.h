#pragma once

#include <algorithm>
#include <vector>

#include "device/exact/exact_scene.h"
#include "kernels/gpu/moving_triangle.h"
#include "kernels/gpu/render_pixel.h"
#include "kernels/integrator/coverage.h"

namespace kadr {

/// Rays through an ExactScene, in double: a tracer in the sense of kernels/gpu/render_pixel.h.
class ExactTracer {
public:
    /// @param keep_blend  closest hits stop at partial coverage (`direct` composites the layers)
    ExactTracer(const ExactScene& scene, bool keep_blend) : scene_(scene), keep_blend_(keep_blend) {}

    bool closest(const kernels::PathState<double>& path, kernels::Hit<double>& hit) const {
        kernels::CoverageRay coverage;
        coverage.key = kernels::coverage_key(path.sampler_key, path.sample, path.bounces);
        coverage.keep_blend = keep_blend_;
        meet(path.origin, path.direction, coverage, hit.distance, [&](unsigned instance, unsigned primitive, const kernels::TriangleHitOf<double>& found) {
            hit = {static_cast<int>(instance), static_cast<int>(primitive), found.u, found.v, found.distance};
            return false;
        });
        return true;
    }

    bool shadow(const kernels::ShadowRay<double>& ray, double, float& transmittance) const {
        kernels::CoverageRay coverage;
        coverage.shadow = true;
        const bool stopped = meet(ray.origin, ray.direction, coverage, ray.distance, [](unsigned, unsigned, const kernels::TriangleHitOf<double>&) { return true; });
        transmittance = stopped ? 0 : coverage.transmittance;
        return true;
    }

private:
    static kernels::Vec3<double> to_vec(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

    /// Calls found(instance, primitive, hit) for every hit before `farthest` at which the ray stops, until it returns true.
    template <class Found>
    bool meet(kernels::Vec3<double> origin, kernels::Vec3<double> direction, kernels::CoverageRay& coverage, const double& farthest, const Found& found) const {
        const glm::dvec3 from(origin.x, origin.y, origin.z), along(direction.x, direction.y, direction.z);
        return scene_.tree().visit({from, along}, farthest, [&](std::uint32_t i) {
            const ExactScene::Placed& placed = scene_.placed()[i];
            if (!placed.shown) return false;
            const ExactRay ray{glm::dvec3(placed.object_from_world * glm::dvec4(from, 1)), glm::dvec3(placed.object_from_world * glm::dvec4(along, 0))};
            return meet_mesh(i, ray, coverage, farthest, found);
        });
    }

    template <class Found>
    bool meet_mesh(unsigned i, const ExactRay& ray, kernels::CoverageRay& coverage, const double& farthest, const Found& found) const {
        const kernels::SceneViewOf<double>& view = scene_.view();
        const kernels::Instance& instance = view.instances[i];
        const kernels::Geometry& mesh = view.geometries[instance.geometry];
        const kernels::Vec3<double> origin = to_vec(ray.origin), direction = to_vec(ray.direction);
        const TriangleTree& tree = scene_.meshes().trees[instance.geometry];
        std::vector<unsigned> passed;  // a triangle may have several boxes, and lets a ray pass once
        return tree.tree.visit(ray, farthest, [&](std::uint32_t box) {
            const unsigned t = tree.triangle_of[box];
            kernels::Vec3<double> p[3];
            for (int c = 0; c < 3; ++c) p[c] = kernels::splat<double>(mesh.vertices[mesh.indices[3 * std::size_t{t} + static_cast<std::size_t>(c)]].position);
            kernels::TriangleHitOf<double> hit{};
            if (!kernels::intersect_triangle(origin, direction, p, 0.0, farthest, hit) || std::find(passed.begin(), passed.end(), t) != passed.end()) return false;
            const double facing = dot(cross(p[1] - p[0], p[2] - p[0]), direction);
            const bool stops = kernels::stops_at(view, instance.geometry, instance.material, t, static_cast<float>(hit.u), static_cast<float>(hit.v),
                                                 view.settings.cull_backfaces, facing > 0 ? 1.0f : -1.0f, coverage);
            if (!stops) passed.push_back(t);
            return stops && found(i, t, hit);
        });
    }

    const ExactScene& scene_;
    bool keep_blend_;
};

}  // namespace kadr
