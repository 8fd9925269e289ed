// The GPU's driver: one thread takes the samples of one pixel, one after another, a ray at a time. It adds to a sample
// in the order in which the processor's driver does in its portable form, so that with the same tracer both give the
// same film to the last bit.
//
// A tracer is what meets the scene:
//     bool closest(const PathState<T>& path, Hit<T>& hit);  // false: the ray could not be followed to its end
//     bool shadow(const ShadowRay<T>& ray, T time, float& transmittance);  // 0: something is in between
#pragma once

#include "kernels/gpu/film_sums.h"
#include "kernels/integrator/camera_path.h"
#include "kernels/integrator/direct.h"
#include "kernels/integrator/surface_layers.h"

namespace kadr::kernels {

/// The samples of one pixel.
/// @tparam T  float; double for the reference on the host (device/exact)
template <class T, unsigned R, IntegratorKind kIntegrator, class Tracer>
class PixelDriver {
public:
    SHARED_FN PixelDriver(const LaunchParamsOf<T>& params, Tracer& tracer, int x, int y)
        : params_(params), tracer_(tracer), x_(x), y_(y) {}

    /// One loop over rays, not one over samples around one over bounces: threads of a group whose paths end early begin
    /// their next samples while the others still bounce.
    SHARED_FN void render(LaunchCounters& counters) {
        const unsigned long pixel = static_cast<unsigned long>(y_) * params_.scene.settings.width + x_;
        int sample = params_.first_sample;
        const int end = sample + params_.sample_count;
        bool alive = start(sample);
        while (true) {
            if (alive) {
                alive = advance(counters);
                continue;
            }
            ++(add_sample(params_.film, pixel, result_) ? counters.samples : counters.dropped);
            if (++sample >= end) return;
            alive = start(sample);
        }
    }

private:
    /// @return whether there is a ray to trace
    SHARED_FN bool start(int sample) {
        const CameraSample<T> begin =
            start_path<T>(params_.scene, *params_.filter, *params_.shutter, params_.seed, params_.centred, x_, y_,
                              static_cast<unsigned>(sample));
        result_ = SampleResult<T>{};
        result_.weight = begin.weight;
        result_.light = begin.light;
        result_.alpha = params_.scene.lights.environment_visible ? 1.0f : 0.0f;
        path_ = begin.path;
        return begin.light > 0.0f;
    }

    SHARED_FN void drop() { result_.radiance.x = as_float(0x7fc00000u); }
    SHARED_FN void add(Vec3<T> L) { result_.radiance = result_.radiance + L; }

    /// Traces the path's ray and shades what it meets. @return whether the path goes on
    SHARED_FN bool advance(LaunchCounters& counters) {
        const SceneViewOf<T>& scene = params_.scene;
        if (!(is_finite(path_.origin) && is_finite(path_.direction) && is_finite(path_.beta))) {
            drop();
            return false;
        }
        ++counters.rays;
        Hit<T> hit{0, 0, 0.0f, 0.0f, kInfinity};
        if (!tracer_.closest(path_, hit)) {
            drop();
            return false;
        }
        if constexpr (kIntegrator == IntegratorKind::path && (R & requirement::kEmitters) != 0) add_visible_lights(hit);
        if (!(hit.distance < kInfinity)) {
            add(shade_miss<T, R>(scene, path_, true));
            return false;
        }
        if constexpr (kIntegrator == IntegratorKind::path)
            return shade_path_vertex(hit, counters);
        else
            return shade_direct_vertex(hit, counters);
    }

    SHARED_FN void add_visible_lights(const Hit<T>& hit) {
        if (params_.scene.lights.visible_count == 0) return;
        const Vec3<T> L = visible_lights(params_.scene, path_, hit.distance, true);
        if (max_component(L) > 0.0f)
            add(clamp_contribution<T>(params_.scene.settings, (path_.bounces & 0xffu) < 2u, L * path_.beta));
    }

    SHARED_FN bool shade_path_vertex(const Hit<T>& hit, LaunchCounters& counters) {
        const VertexResult<T> vertex = shade_hit<T, R>(params_.scene, path_, hit, true);
        if (max_component(vertex.emitted) > 0.0f) add(vertex.emitted);
        if (path_.bounces == 0u) add_layers(hit, vertex.albedo, vertex.normal);
        if (vertex.shadow.active) trace_shadow(vertex.shadow, counters);
        path_ = vertex.next;
        return vertex.alive;
    }

    SHARED_FN bool shade_direct_vertex(const Hit<T>& hit, LaunchCounters& counters) {
        const DirectResult<T> vertex = shade_direct<T, R>(
            params_.scene, path_, hit, true, [&](Vec3<T> L) { add(L); },
            [&](const ShadowRay<T>& ray) { trace_shadow(ray, counters); });
        if (path_.bounces == 0u) add_layers(hit, vertex.albedo, vertex.normal);
        path_ = vertex.next;
        return vertex.alive;
    }

    /// Adds what arrives along a shadow ray.
    SHARED_FN void trace_shadow(const ShadowRay<T>& ray, LaunchCounters& counters) {
        if (!(is_finite(ray.origin) && is_finite(ray.direction) && is_finite(ray.radiance))) return drop();
        ++counters.rays;
        float transmittance = 1.0f;
        if (!tracer_.shadow(ray, path_.time, transmittance)) return drop();
        if (transmittance > 0.0f) add(ray.radiance * T(transmittance));
    }

    /// Coverage and data layers of the first hit.
    SHARED_FN void add_layers(const Hit<T>& hit, Vec3<T> albedo, Vec3<T> normal) {
        result_.alpha = 1.0f;
        if (!has_layers(params_.film)) return;
        result_.met_surface = true;
        result_.albedo = albedo;
        result_.normal = normal;
        result_.depth = view_depth(params_.scene.camera, path_.time, path_.direction, hit.distance);
        if (params_.scene.previous_matrices)
            result_.motion = motion_of_point(params_.scene, static_cast<unsigned>(hit.instance),
                                             static_cast<unsigned>(hit.primitive), hit.u, hit.v);
    }

    const LaunchParamsOf<T>& params_;
    Tracer& tracer_;
    int x_, y_;
    PathState<T> path_;
    SampleResult<T> result_;
};

/// Whether the launch asks for a pixel.
template <class T>
SHARED_FN bool is_wanted(const LaunchParamsOf<T>& params, int x, int y) {
    if (x >= params.x1 || y >= params.y1 || params.sample_count <= 0) return false;
    return !params.active || params.active[static_cast<unsigned long>(y) * params.scene.settings.width + x] != 0;
}

}  // namespace kadr::kernels
