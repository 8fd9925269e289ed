// The GPU's driver: one thread takes the samples of one pixel, one after another, a ray at a time. It adds to a sample
// in the order in which the processor's driver does in its portable form, so that with the same tracer both give the
// same film to the last bit.
//
// A tracer is what meets the scene:
//     bool closest(const PathState<float>& path, Hit<float>& hit);  // false: the ray could not be followed to its end
//     bool shadow(const ShadowRay<float>& ray, float time, float& transmittance);  // 0: something is in between
#pragma once

#include "kernels/gpu/film_sums.h"
#include "kernels/integrator/camera_path.h"
#include "kernels/integrator/direct.h"
#include "kernels/integrator/surface_layers.h"

namespace kadr::kernels {

/// The samples of one pixel.
template <unsigned R, IntegratorKind kIntegrator, class Tracer>
class PixelDriver {
public:
    SHARED_FN PixelDriver(const LaunchParams& params, Tracer& tracer, int x, int y)
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
        const CameraSample<float> begin =
            start_path<float>(params_.scene, *params_.filter, *params_.shutter, params_.seed, params_.centred, x_, y_,
                              static_cast<unsigned>(sample));
        result_ = SampleResult{};
        result_.weight = begin.weight;
        result_.light = begin.light;
        result_.alpha = params_.scene.lights.environment_visible ? 1.0f : 0.0f;
        path_ = begin.path;
        return begin.light > 0.0f;
    }

    SHARED_FN void drop() { result_.radiance.x = as_float(0x7fc00000u); }
    SHARED_FN void add(Vec3f L) { result_.radiance = result_.radiance + L; }

    /// Traces the path's ray and shades what it meets. @return whether the path goes on
    SHARED_FN bool advance(LaunchCounters& counters) {
        const SceneView& scene = params_.scene;
        if (!(is_finite(path_.origin) && is_finite(path_.direction) && is_finite(path_.beta))) {
            drop();
            return false;
        }
        ++counters.rays;
        Hit<float> hit{0, 0, 0.0f, 0.0f, kInfinity};
        if (!tracer_.closest(path_, hit)) {
            drop();
            return false;
        }
        if constexpr (kIntegrator == IntegratorKind::path && (R & requirement::kEmitters) != 0) add_visible_lights(hit);
        if (!(hit.distance < kInfinity)) {
            add(shade_miss<float, R>(scene, path_, true));
            return false;
        }
        if constexpr (kIntegrator == IntegratorKind::path)
            return shade_path_vertex(hit, counters);
        else
            return shade_direct_vertex(hit, counters);
    }

    SHARED_FN void add_visible_lights(const Hit<float>& hit) {
        if (params_.scene.lights.visible_count == 0) return;
        const Vec3f L = visible_lights(params_.scene, path_, hit.distance, true);
        if (max_component(L) > 0.0f)
            add(clamp_contribution(params_.scene.settings, (path_.bounces & 0xffu) < 2u, L * path_.beta));
    }

    SHARED_FN bool shade_path_vertex(const Hit<float>& hit, LaunchCounters& counters) {
        const VertexResult<float> vertex = shade_hit<float, R>(params_.scene, path_, hit, true);
        if (max_component(vertex.emitted) > 0.0f) add(vertex.emitted);
        if (path_.bounces == 0u) add_layers(hit, vertex.albedo, vertex.normal);
        if (vertex.shadow.active) trace_shadow(vertex.shadow, counters);
        path_ = vertex.next;
        return vertex.alive;
    }

    SHARED_FN bool shade_direct_vertex(const Hit<float>& hit, LaunchCounters& counters) {
        const DirectResult<float> vertex = shade_direct<float, R>(
            params_.scene, path_, hit, true, [&](Vec3f L) { add(L); },
            [&](const ShadowRay<float>& ray) { trace_shadow(ray, counters); });
        if (path_.bounces == 0u) add_layers(hit, vertex.albedo, vertex.normal);
        path_ = vertex.next;
        return vertex.alive;
    }

    /// Adds what arrives along a shadow ray.
    SHARED_FN void trace_shadow(const ShadowRay<float>& ray, LaunchCounters& counters) {
        if (!(is_finite(ray.origin) && is_finite(ray.direction) && is_finite(ray.radiance))) return drop();
        ++counters.rays;
        float transmittance = 1.0f;
        if (!tracer_.shadow(ray, path_.time, transmittance)) return drop();
        if (transmittance > 0.0f) add(ray.radiance * transmittance);
    }

    /// Coverage and data layers of the first hit.
    SHARED_FN void add_layers(const Hit<float>& hit, Vec3f albedo, Vec3f normal) {
        result_.alpha = 1.0f;
        if (!params_.film.surface) return;
        result_.met_surface = true;
        result_.albedo = albedo;
        result_.normal = normal;
        result_.depth = hit.distance * view_cosine(params_.scene.camera, path_.time, path_.direction);
        if (params_.scene.previous_matrices)
            result_.motion = motion_of_point(params_.scene, static_cast<unsigned>(hit.instance),
                                             static_cast<unsigned>(hit.primitive), hit.u, hit.v);
    }

    const LaunchParams& params_;
    Tracer& tracer_;
    int x_, y_;
    PathState<float> path_;
    SampleResult result_;
};

/// Whether the launch asks for a pixel.
SHARED_FN bool is_wanted(const LaunchParams& params, int x, int y) {
    if (x >= params.x1 || y >= params.y1 || params.sample_count <= 0) return false;
    return !params.active || params.active[static_cast<unsigned long>(y) * params.scene.settings.width + x] != 0;
}

}  // namespace kadr::kernels
