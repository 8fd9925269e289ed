// Rays through HIPRT, and the functions that it asks about hits. Read after HIPRT's device headers, by a GPU's
// compiler; tests build it for the host, over a stand-in for that interface.
#pragma once

#include "kernels/gpu/launch_params.h"
#include "kernels/gpu/moving_triangle.h"
#include "kernels/integrator/coverage.h"
#include "kernels/integrator/path.h"

#if KADR_DEVICE_CODE
#define DEVICE_FN __device__
#else
#define DEVICE_FN
#endif

namespace kadr::kernels {

/// HIPRT's box test misses both neighbours of a face that a ray runs along exactly; a hair beside it, it does not.
DEVICE_FN inline float off_axis(float d) { return d == 0.0f ? copy_sign(1e-20f, d) : d; }

/// What the functions that a ray asks get to see.
struct RayPayload {
    const LaunchParams* params;
    float time;
    CoverageRay coverage;
};

/// Traces against the top level; one level of instances, and private stacks of 64 entries, which are counted when they
/// overflow. Normals are never HIPRT's: a hit's is in object space, and its transforms are wrong under shear.
class HiprtTracer {
public:
    DEVICE_FN HiprtTracer(const LaunchParams& params, bool keep_blend, LaunchCounters& counters)
        : params_(params), counters_(counters), keep_blend_(keep_blend) {}

    DEVICE_FN bool closest(const PathState<float>& path, Hit<float>& hit) {
        if (!params_.top) return true;
        RayPayload payload{&params_, path.time, {}};
        payload.coverage.key = coverage_key(path.sampler_key, path.sample, path.bounces);
        payload.coverage.keep_blend = keep_blend_;
        hiprtPrivateStack stack;
        hiprtEmptyInstanceStack instances;
        hiprtSceneTraversalClosestCustomStack<hiprtPrivateStack, hiprtEmptyInstanceStack> traversal(
            top(), ray_of(path.origin, path.direction, kInfinity), stack, instances, params_.ray_mask,
            hiprtTraversalHintDefault, &payload, functions(), 0, path.time);
        const hiprtHit found = traversal.getNextHit();
        if (overflowed(traversal.getCurrentState())) return false;
        if (!found.hasHit()) return true;
        hit.instance = static_cast<int>(params_.instance_of[found.instanceID]);
        hit.primitive = static_cast<int>(found.primID);
        hit.u = found.uv.x;
        hit.v = found.uv.y;
        hit.distance = found.t;
        return true;
    }

    DEVICE_FN bool shadow(const ShadowRay<float>& ray, float time, float& transmittance) {
        if (!params_.top) return true;
        RayPayload payload{&params_, time, {}};
        payload.coverage.shadow = true;
        hiprtPrivateStack stack;
        hiprtEmptyInstanceStack instances;
        hiprtSceneTraversalAnyHitCustomStack<hiprtPrivateStack, hiprtEmptyInstanceStack> traversal(
            top(), ray_of(ray.origin, ray.direction, ray.distance), stack, instances, params_.ray_mask,
            hiprtTraversalHintShadowRays, &payload, functions(), 0, time);
        const hiprtHit found = traversal.getNextHit();
        transmittance = found.hasHit() ? 0.0f : payload.coverage.transmittance;
        return !overflowed(traversal.getCurrentState());
    }

private:
    DEVICE_FN hiprtScene top() const { return static_cast<hiprtScene>(const_cast<void*>(params_.top)); }
    DEVICE_FN hiprtFuncTable functions() const {
        return static_cast<hiprtFuncTable>(const_cast<void*>(params_.functions));
    }

    DEVICE_FN static hiprtRay ray_of(Vec3f origin, Vec3f direction, float distance) {
        hiprtRay ray;
        ray.origin = {origin.x, origin.y, origin.z};
        ray.direction = {off_axis(direction.x), off_axis(direction.y), off_axis(direction.z)};
        ray.minT = 0.0f;
        ray.maxT = distance;
        return ray;
    }

    DEVICE_FN bool overflowed(hiprtTraversalState state) {
        if (state != hiprtTraversalStateStackOverflow) return false;
        ++counters_.stack_overflows;
        return true;
    }

    const LaunchParams& params_;
    LaunchCounters& counters_;
    bool keep_blend_;
};

DEVICE_FN inline const Instance& instance_of(const RayPayload& payload, const hiprtHit& hit) {
    return payload.params->scene.instances[payload.params->instance_of[hit.instanceID]];
}

/// Whether a ray passes a hit: HIPRT's filter function. The ray is in the mesh's space, as the hit's normal is.
DEVICE_FN inline bool passes(const hiprtRay& ray, RayPayload& payload, const hiprtHit& hit) {
    const SceneView& scene = payload.params->scene;
    const Instance& instance = instance_of(payload, hit);
    Vec3f p[3];
    corners_at(scene.geometries[instance.geometry], hit.primID, payload.time, p);
    const float facing = dot(cross(p[1] - p[0], p[2] - p[0]), Vec3f{ray.direction.x, ray.direction.y, ray.direction.z});
    return !stops_at(scene, instance.geometry, instance.material, hit.primID, hit.uv.x, hit.uv.y,
                     scene.settings.cull_backfaces, facing, payload.coverage);
}

/// Whether a ray meets a moving triangle: HIPRT's intersection function.
DEVICE_FN inline bool meets_moving(const hiprtRay& ray, const RayPayload& payload, hiprtHit& hit) {
    Vec3f p[3];
    corners_at(payload.params->scene.geometries[instance_of(payload, hit).geometry], hit.primID, payload.time, p);
    TriangleHit found;
    if (!intersect_triangle({ray.origin.x, ray.origin.y, ray.origin.z},
                            {ray.direction.x, ray.direction.y, ray.direction.z}, p, ray.minT, ray.maxT, found))
        return false;
    const Vec3f normal = cross(p[1] - p[0], p[2] - p[0]);
    hit.uv = {found.u, found.v};
    hit.t = found.distance;
    hit.normal = {normal.x, normal.y, normal.z};
    return true;
}

}  // namespace kadr::kernels
