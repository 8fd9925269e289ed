#pragma once

#include "device/probe.h"
#include "kernels/gpu/probe.h"

namespace kadr {

template <class T>
SurfaceHit surface_hit_of(const kernels::ProbeHitOf<T>& hit) {
    return {hit.instance, hit.primitive, hit.u, hit.v, hit.distance, kernels::splat<double>(hit.position), kernels::splat<double>(hit.normal)};
}

/// A shadow ray from a surface. Distance and direction are still to be set.
template <class T>
kernels::ProbeShadowOf<T> probe_shadow_from(const SurfaceHit& from, kernels::Vec3f to_viewer) {
    return {from.instance, from.primitive, static_cast<T>(from.u), static_cast<T>(from.v), kernels::splat<T>(to_viewer), {0, 0, 0}, 0};
}

template <class T>
kernels::ProbeShadowOf<T> probe_shadow_of(const SurfaceRay& ray) {
    kernels::ProbeShadowOf<T> shadow = probe_shadow_from<T>(ray.from, ray.to_viewer);
    shadow.direction = kernels::splat<T>(ray.direction);
    shadow.distance = ray.distance_m;
    return shadow;
}

/// What a probe asks of a scene on the host, in the numbers of its kernels. @tparam T  float or double
template <class T>
class SceneProbe {
public:
    explicit SceneProbe(const kernels::SceneViewOf<T>& scene) : scene_(scene) {}

    /// @param tracer  in the sense of kernels/gpu/render_pixel.h
    template <class Tracer>
    SurfaceHit look(Tracer&& tracer, kernels::Vec2f film_px, double time) const {
        return surface_hit_of(kernels::look<T, kSet>(scene_, tracer, film_px, static_cast<T>(time)));
    }

    template <class Tracer>
    bool occluded(Tracer&& tracer, const SurfaceRay& ray, double time) const {
        return kernels::is_occluded<T, kSet>(scene_, tracer, probe_shadow_of<T>(ray), static_cast<T>(time));
    }

    int light_count() const { return scene_.lights.count + (scene_.lights.triangle_count > 0 ? 1 : 0); }

    template <class Tracer>
    LightSight towards_light(Tracer&& tracer, const LightRay& ray, double time) const {
        const T at = static_cast<T>(time);
        kernels::ProbeShadowOf<T> shadow = probe_shadow_from<T>(ray.from, ray.to_viewer);
        const kernels::Interaction<T> from = kernels::surface_of<T, kSet>(scene_, shadow, at);
        const kernels::LightSample<T> light = sample_light(ray, from.origin, at);
        if (!(light.pdf > 0) || !(max_component(light.radiance) > 0) || !(dot(light.direction, from.geometric_normal) > 0)) return LightSight::not_towards;
        shadow.direction = light.direction;
        shadow.distance = kernels::min(kernels::shadow_distance(light.distance), T(kernels::kInfinity));
        return kernels::is_occluded<T, kSet>(scene_, tracer, shadow, at) ? LightSight::hidden : LightSight::seen;
    }

private:
    static constexpr unsigned kSet = kernels::requirement::kAll;

    kernels::LightSample<T> sample_light(const LightRay& ray, kernels::Vec3<T> from, T time) const {
        const kernels::LightSetOf<T>& lights = scene_.lights;
        const kernels::Vec2<T> u{ray.u.x, ray.u.y};
        if (ray.light == lights.count) return kernels::sample_emitters<T>(scene_, from, time, ray.u.z, u, true);
        return kernels::sample_light<T>(lights.keys + lights.first[ray.light], lights.key_count[ray.light], time, from, u);
    }

    const kernels::SceneViewOf<T>& scene_;
};

}  // namespace kadr
