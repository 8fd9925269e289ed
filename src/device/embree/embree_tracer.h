#pragma once

#include "device/embree/embree_scene.h"
#include "kernels/integrator/coverage.h"
#include "kernels/integrator/path.h"

namespace kadr {

/// Single rays through the processor's scene: a tracer in the sense of kernels/gpu/render_pixel.h that asks Embree what
/// the device's portable driver asks.
class EmbreeTracer {
public:
    EmbreeTracer(const EmbreeScene& scene, bool keep_blend) : scene_(scene), keep_blend_(keep_blend) {}

    bool closest(const kernels::PathState<float>& path, kernels::Hit<float>& hit) {
        QueryContext context;
        context.keep_blend = keep_blend_;
        context.key[0] = kernels::coverage_key(path.sampler_key, path.sample, path.bounces);
        for (const RTCScene part : {scene_.flat(), scene_.instanced()})
            if (part) meet(part, path, context, hit);
        return true;
    }

    bool shadow(const kernels::ShadowRay<float>& shadow, float time, float& transmittance) {
        QueryContext context;
        context.shadow = true;
        context.transmittance[0] = 1;
        for (const RTCScene part : {scene_.flat(), scene_.instanced()}) {
            if (!part || transmittance == 0) continue;
            RTCRay ray = ray_of(shadow.origin, shadow.direction, time, shadow.distance);
            occluded1(part, context, ray);
            transmittance = ray.tfar < 0 ? 0 : context.transmittance[0];
        }
        return true;
    }

private:
    static RTCRay ray_of(kernels::Vec3f origin, kernels::Vec3f direction, float time, float distance) {
        RTCRay ray{};
        ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
        ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
        ray.time = time;
        ray.tfar = distance;
        ray.mask = 0xffffffffu;
        return ray;
    }

    static void meet(RTCScene part, const kernels::PathState<float>& path, QueryContext& context,
                     kernels::Hit<float>& hit) {
        RTCRayHit ray{};
        ray.ray = ray_of(path.origin, path.direction, path.time, hit.distance);
        ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        intersect1(part, context, ray, path.bounces == 0);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
        // Flat geometry and instances are attached under the index of their instance.
        hit.instance =
            static_cast<int>(ray.hit.instID[0] == RTC_INVALID_GEOMETRY_ID ? ray.hit.geomID : ray.hit.instID[0]);
        hit.primitive = static_cast<int>(ray.hit.primID);
        hit.u = ray.hit.u;
        hit.v = ray.hit.v;
        hit.distance = ray.ray.tfar;
    }

    const EmbreeScene& scene_;
    bool keep_blend_;
};

}  // namespace kadr
