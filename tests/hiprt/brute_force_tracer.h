#pragma once

#include <cmath>
#include <cstring>
#include <vector>

#include <glm/glm.hpp>

#include "fake_hiprt.h"
#include "frame/decompose.h"
#include "kernels/gpu/moving_triangle.h"
#include "kernels/gpu/render_pixel.h"
#include "kernels/integrator/coverage.h"

namespace kadr::test {

/// Traces what HIPRT was given, in the place of HIPRT: instances by their headers, frames and masks, meshes by their
/// build inputs, every triangle. A tracer in the sense of kernels/gpu/render_pixel.h.
class BruteForceTracer {
public:
    BruteForceTracer(const FakeHiprt& hiprt, const kernels::LaunchParams& params, bool keep_blend)
        : params_(params), keep_blend_(keep_blend) {
        if (!params.top) return;
        scene_ = &hiprt.scenes.at(static_cast<hiprt::Scene>(const_cast<void*>(params.top)));
        for (const hiprt::Instance& instance : scene_->instances)
            inputs_.push_back(&hiprt.geometries.at(instance.geometry).input);
    }

    bool closest(const kernels::PathState<float>& path, kernels::Hit<float>& hit) {
        kernels::CoverageRay coverage;
        coverage.key = kernels::coverage_key(path.sampler_key, path.sample, path.bounces);
        coverage.keep_blend = keep_blend_;
        for (std::size_t i = 0; i < inputs_.size(); ++i)
            meet(
                i, path.origin, path.direction, path.time, coverage,
                [&](unsigned primitive, const kernels::TriangleHit& found) {
                    hit.instance = static_cast<int>(params_.instance_of[i]);
                    hit.primitive = static_cast<int>(primitive);
                    hit.u = found.u;
                    hit.v = found.v;
                    hit.distance = found.distance;
                    return false;
                },
                [&] { return hit.distance; });
        return true;
    }

    bool shadow(const kernels::ShadowRay<float>& ray, float time, float& transmittance) {
        kernels::CoverageRay coverage;
        coverage.shadow = true;
        bool stopped = false;
        for (std::size_t i = 0; i < inputs_.size() && !stopped; ++i)
            meet(
                i, ray.origin, ray.direction, time, coverage,
                [&](unsigned, const kernels::TriangleHit&) { return stopped = true; }, [&] { return ray.distance; });
        transmittance = stopped ? 0 : coverage.transmittance;
        return true;
    }

private:
    static Decomposition parts_of(const kernels::FrameSrt& f) {
        Decomposition d;
        const glm::dvec3 axis(f.axis[0], f.axis[1], f.axis[2]);
        if (glm::length(axis) > 0) d.rotation = glm::angleAxis(static_cast<double>(f.angle), glm::normalize(axis));
        d.scale = {f.scale[0], f.scale[1], f.scale[2]};
        d.translation = {f.translation[0], f.translation[1], f.translation[2]};
        return d;
    }
    static Decomposition parts_of(const kernels::FrameMatrix& f) {
        glm::dmat4 m(1);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) m[column][row] = f.matrix[row][column];
        return decompose(m);
    }

    /// HIPRT's rule: between two frames all parts linearly, rotations by slerp.
    template <class Frame>
    glm::dmat4 between(const std::vector<Frame>& frames, const kernels::TransformHeader& header, float time) const {
        unsigned k = 0;
        while (k + 2 < header.frame_count && frames[header.first_frame + k + 1].time <= time) ++k;
        const Frame& a = frames[header.first_frame + k];
        if (header.frame_count == 1) return compose(parts_of(a));
        const Frame& b = frames[header.first_frame + k + 1];
        return compose(interpolate(parts_of(a), parts_of(b), (time - a.time) / (b.time - a.time)));
    }

    glm::dmat4 world_from_object(std::size_t i, float time) const {
        return scene_->srt.empty() ? between(scene_->matrices, scene_->headers[i], time)
                                   : between(scene_->srt, scene_->headers[i], time);
    }

    void corners(const hiprt::GeometryBuildInput& input, std::size_t i, unsigned t, float time,
                 kernels::Vec3f (&p)[3]) const {
        if (input.type == hiprt::PrimitiveType::aabb_list) {
            const kernels::SceneView& view = params_.scene;
            return kernels::corners_at(view.geometries[view.instances[params_.instance_of[i]].geometry], t, time, p);
        }
        const auto* indices = static_cast<const std::uint32_t*>(input.mesh.indices) + std::size_t{3} * t;
        for (int c = 0; c < 3; ++c)
            std::memcpy(
                &p[c],
                static_cast<const std::byte*>(input.mesh.vertices) + std::size_t{indices[c]} * input.mesh.vertex_stride,
                12);
    }

    /// @param found      called with a primitive and a hit where the ray stops; true: look no further
    /// @param max_distance  of hits from now on
    template <class Found, class Distance>
    void meet(std::size_t i, kernels::Vec3f origin, kernels::Vec3f direction, float time,
              kernels::CoverageRay& coverage, const Found& found, const Distance& max_distance) const {
        if ((scene_->masks[i] & params_.ray_mask) == 0) return;
        const glm::dmat4 inverse = glm::inverse(world_from_object(i, time));
        const glm::dvec3 o(inverse * glm::dvec4(origin.x, origin.y, origin.z, 1)),
            d(inverse * glm::dvec4(direction.x, direction.y, direction.z, 0));
        const auto to_float = [](const glm::dvec3& v) {
            return kernels::Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
        };
        const hiprt::GeometryBuildInput& input = *inputs_[i];
        const bool boxes = input.type == hiprt::PrimitiveType::aabb_list;
        for (unsigned t = 0; t < (boxes ? input.list.box_count : input.mesh.triangle_count); ++t) {
            kernels::Vec3f p[3];
            corners(input, i, t, time, p);
            kernels::TriangleHit hit;
            if (!kernels::intersect_triangle(to_float(o), to_float(d), p, 0.0f, max_distance(), hit)) continue;
            if (boxes && !in_box(input.list, t, o + d * static_cast<double>(hit.distance))) continue;
            if (input.geometry_type != hiprt::kInvalidValue && !stops(i, t, hit, p, to_float(d), coverage)) continue;
            if (found(t, hit)) return;
        }
    }

    /// Beyond its box nothing would look for a triangle.
    static bool in_box(const hiprt::AabbList& list, unsigned t, const glm::dvec3& p) {
        const auto* box = reinterpret_cast<const float*>(static_cast<const std::byte*>(list.boxes) +
                                                         std::size_t{t} * list.box_stride);
        const float* high = box + list.box_stride / 8;
        for (int c = 0; c < 3; ++c)
            if (p[c] < box[c] || p[c] > high[c]) return false;
        return true;
    }

    bool stops(std::size_t i, unsigned t, const kernels::TriangleHit& hit, const kernels::Vec3f (&p)[3],
               kernels::Vec3f d, kernels::CoverageRay& coverage) const {
        const kernels::SceneView& view = params_.scene;
        const kernels::Instance& instance = view.instances[params_.instance_of[i]];
        const float facing = dot(cross(p[1] - p[0], p[2] - p[0]), d);
        return kernels::stops_at(view, instance.geometry, instance.material, t, hit.u, hit.v,
                                 view.settings.cull_backfaces, facing, coverage);
    }

    const kernels::LaunchParams& params_;
    bool keep_blend_;
    const FakeHiprt::SceneRecord* scene_ = nullptr;
    std::vector<const hiprt::GeometryBuildInput*> inputs_;  ///< [instance of HIPRT]
};

}  // namespace kadr::test
