#pragma once

#include "device/probe.h"
#include "kernels/camera/camera.h"
#include "kernels/integrator/interaction.h"
#include "kernels/integrator/path.h"

namespace kadr {

/// What a probe asks of a scene on the host, in the numbers of its kernels. @tparam T  float or double
template <class T>
class SceneProbe {
public:
    explicit SceneProbe(const kernels::SceneViewOf<T>& scene) : scene_(scene) {}

    /// @param tracer  in the sense of kernels/gpu/render_pixel.h
    template <class Tracer>
    SurfaceHit look(Tracer&& tracer, kernels::Vec2f film_px, double time) const {
        kernels::PathState<T> path{};
        path.time = static_cast<T>(time);
        const kernels::Settings& s = scene_.settings;
        kernels::CameraOf<T> pinhole = scene_.camera;
        kernels::CameraKeyOf<T> key = camera_key(path.time);
        pinhole.keys = &key;
        pinhole.key_count = 1;
        kernels::camera_ray<T>(pinhole, s.width, s.height, {T(film_px.x), T(film_px.y)}, path.time, {T(0.5), T(0.5)}, path.origin, path.direction);
        // Renderers drop such samples: here nothing is met.
        if (!kernels::is_finite(path.origin) || !kernels::is_finite(path.direction)) return {};
        kernels::Hit<T> hit{0, 0, 0, 0, T(kernels::kInfinity)};
        tracer.closest(path, hit);
        if (!(hit.distance < T(kernels::kInfinity))) return {};
        const kernels::Interaction<T> at = interaction(hit, path.time, -path.direction);
        return {hit.instance, hit.primitive, hit.u, hit.v, hit.distance, kernels::splat<double>(at.position), kernels::splat<double>(at.geometric_normal)};
    }

    template <class Tracer>
    bool occluded(Tracer&& tracer, const SurfaceRay& ray, double time) const {
        kernels::ShadowRay<T> shadow{};
        shadow.origin = interaction(hit_of(ray.from), static_cast<T>(time), kernels::splat<T>(ray.to_viewer)).origin;
        shadow.direction = kernels::splat<T>(ray.direction);
        shadow.distance = ray.distance_m;
        return stopped(tracer, shadow, static_cast<T>(time));
    }

    int light_count() const { return scene_.lights.count + (scene_.lights.triangle_count > 0 ? 1 : 0); }

    template <class Tracer>
    LightSight towards_light(Tracer&& tracer, const LightRay& ray, double time) const {
        const T at = static_cast<T>(time);
        const kernels::Interaction<T> from = interaction(hit_of(ray.from), at, kernels::splat<T>(ray.to_viewer));
        const kernels::LightSample<T> light = sample_light(ray, from.origin, at);
        if (!(light.pdf > 0) || !(max_component(light.radiance) > 0) || !(dot(light.direction, from.geometric_normal) > 0)) return LightSight::not_towards;
        kernels::ShadowRay<T> shadow{};
        shadow.origin = from.origin;
        shadow.direction = light.direction;
        shadow.distance = kernels::min(kernels::shadow_distance(light.distance), T(kernels::kInfinity));
        return stopped(tracer, shadow, at) ? LightSight::hidden : LightSight::seen;
    }

private:
    template <class Tracer>
    static bool stopped(Tracer&& tracer, const kernels::ShadowRay<T>& shadow, T time) {
        if (!kernels::is_finite(shadow.origin) || !kernels::is_finite(shadow.direction)) return true;
        float transmittance = 1;
        tracer.shadow(shadow, time, transmittance);
        return !(transmittance > 0);
    }

    static kernels::Hit<T> hit_of(const SurfaceHit& from) {
        return {from.instance, from.primitive, static_cast<T>(from.u), static_cast<T>(from.v), static_cast<T>(from.distance_m)};
    }

    kernels::LightSample<T> sample_light(const LightRay& ray, kernels::Vec3<T> from, T time) const {
        const kernels::LightSetOf<T>& lights = scene_.lights;
        const kernels::Vec2<T> u{ray.u.x, ray.u.y};
        if (ray.light == lights.count) return kernels::sample_emitters<T>(scene_, from, time, ray.u.z, u, true);
        return kernels::sample_light<T>(lights.keys + lights.first[ray.light], lights.key_count[ray.light], time, from, u);
    }

    static constexpr unsigned kSet = kernels::requirement::kAll;

    kernels::Interaction<T> interaction(const kernels::Hit<T>& hit, T time, kernels::Vec3<T> to_viewer) const {
        return kernels::make_interaction<T, kSet>(scene_, hit, time, to_viewer, true);
    }

    /// The camera at a time, without its lens.
    kernels::CameraKeyOf<T> camera_key(T time) const {
        const kernels::CameraPose<T> pose = kernels::camera_at<T>(scene_.camera, time);
        return {pose.position, {pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w}, pose.tan_half_width, pose.tan_half_height, 0, 1, pose.start};
    }

    const kernels::SceneViewOf<T>& scene_;
};

}  // namespace kadr
