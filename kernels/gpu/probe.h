// Single rays, answered with what a renderer on this device would take: how devices are compared beneath their pictures
// (src/device/probe.h). One template, for the processor, the reference in double and the GPU's kernel.
#pragma once

#include "kernels/camera/camera.h"
#include "kernels/gpu/launch_params.h"
#include "kernels/integrator/interaction.h"
#include "kernels/integrator/path.h"

namespace kadr::kernels {

/// What a camera ray met. Places are relative to the render origin.
template <class T>
struct ProbeHitOf {
    int instance, primitive;  ///< of the snapshot, of its mesh; instance -1: nothing was met
    T u, v, distance;
    Vec3<T> position, normal;  ///< normal: unit, geometric, on the viewer's side
};
using ProbeHit = ProbeHitOf<float>;

/// A shadow ray from a point that was met.
template <class T>
struct ProbeShadowOf {
    int instance, primitive;  ///< of the point, as its weights `u` and `v`
    T u, v;
    Vec3<T> to_viewer, direction;  ///< unit
    T distance;                    ///< metres
};
using ProbeShadow = ProbeShadowOf<float>;

/// A launch of the kernel: `count` camera rays, or as many shadow rays. Pointers are device addresses.
struct ProbeParams {
    LaunchParams frame;          ///< scene, structures and mask; no film, no samples
    float time;                  ///< in [0, 1] of the shutter, of all rays
    unsigned count;
    const Vec2f* film_px;        ///< [count] x right, y down; null: shadow rays
    ProbeHit* hits;              ///< [count]
    const ProbeShadow* shadows;  ///< [count]
    unsigned char* occluded;     ///< [count] 1: something opaque lies on the ray before its end
};
static_assert(sizeof(ProbeHit) == 44 && sizeof(ProbeShadow) == 44 && sizeof(ProbeParams) == 536, "shared with the host");

/// Threads of a block of the kernel.
inline constexpr unsigned kProbeBlock = 64;

/// A pinhole ray through the film.
/// @tparam R   set of requirement:: bits; of them only those of geometry matter
/// @param tracer  in the sense of kernels/gpu/render_pixel.h
template <class T, unsigned R, class Tracer>
SHARED_FN ProbeHitOf<T> look(const SceneViewOf<T>& scene, Tracer& tracer, Vec2f film_px, T time) {
    const ProbeHitOf<T> nothing{-1, -1, 0, 0, 0, {0, 0, 0}, {0, 0, 0}};
    const CameraPose<T> pose = camera_at<T>(scene.camera, time);
    const CameraKeyOf<T> key{pose.position,
                             {pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w},
                             pose.tan_half_width,
                             pose.tan_half_height,
                             0,
                             1,
                             pose.start};
    CameraOf<T> pinhole = scene.camera;
    pinhole.keys = &key;
    pinhole.key_count = 1;
    PathState<T> path{};
    path.time = time;
    camera_ray<T>(pinhole, scene.settings.width, scene.settings.height, {T(film_px.x), T(film_px.y)}, time,
                  {T(0.5f), T(0.5f)}, path.origin, path.direction);
    // Renderers drop such samples: here nothing is met.
    if (!is_finite(path.origin) || !is_finite(path.direction)) return nothing;
    Hit<T> hit{0, 0, 0, 0, T(kInfinity)};
    if (!tracer.closest(path, hit) || !(hit.distance < T(kInfinity))) return nothing;
    const Interaction<T> at = make_interaction<T, R>(scene, hit, time, -path.direction, true);
    return {hit.instance, hit.primitive, hit.u, hit.v, hit.distance, at.position, at.geometric_normal};
}

/// Where a shadow ray starts.
template <class T, unsigned R>
SHARED_FN Interaction<T> surface_of(const SceneViewOf<T>& scene, const ProbeShadowOf<T>& ray, T time) {
    const Hit<T> from{ray.instance, ray.primitive, ray.u, ray.v, 0};
    return make_interaction<T, R>(scene, from, time, ray.to_viewer, true);
}

/// Whether a shadow ray is stopped; so is one that could not be followed.
template <class T, unsigned R, class Tracer>
SHARED_FN bool is_occluded(const SceneViewOf<T>& scene, Tracer& tracer, const ProbeShadowOf<T>& ray, T time) {
    ShadowRay<T> shadow{};
    shadow.origin = surface_of<T, R>(scene, ray, time).origin;
    shadow.direction = ray.direction;
    shadow.distance = ray.distance;
    if (!is_finite(shadow.origin) || !is_finite(shadow.direction)) return true;
    float transmittance = 1.0f;
    return !tracer.shadow(shadow, time, transmittance) || !(transmittance > 0.0f);
}

/// One ray of a launch.
template <unsigned R, class Tracer>
SHARED_FN void answer_probe(const ProbeParams& params, Tracer& tracer, unsigned i) {
    const SceneView& scene = params.frame.scene;
    if (params.film_px)
        params.hits[i] = look<float, R>(scene, tracer, params.film_px[i], params.time);
    else
        params.occluded[i] = is_occluded<float, R>(scene, tracer, params.shadows[i], params.time) ? 1 : 0;
}

}  // namespace kadr::kernels
