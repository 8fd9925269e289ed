#pragma once

#include "device/probe.h"
#include "kernels/gpu/probe.h"

namespace kadr {

template <class T>
SurfaceHit surface_hit_of(const kernels::ProbeHitOf<T>& hit) {
    return {hit.instance, hit.primitive, hit.u, hit.v, hit.distance, kernels::splat<double>(hit.position), kernels::splat<double>(hit.normal)};
}

template <class T>
kernels::ProbeShadowOf<T> probe_shadow_of(const SurfaceRay& ray) {
    return {ray.from.instance, ray.from.primitive, static_cast<T>(ray.from.u), static_cast<T>(ray.from.v), kernels::splat<T>(ray.to_viewer), kernels::splat<T>(ray.direction), ray.distance_m};
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

private:
    static constexpr unsigned kSet = kernels::requirement::kAll;
    const kernels::SceneViewOf<T>& scene_;
};

}  // namespace kadr
