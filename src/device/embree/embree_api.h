#pragma once

// Embree 3 and 4 differ in header names and in how a ray query takes its context; the rest of the device is one source.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>

namespace kadr {

struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using EmbreeDeviceHandle = std::unique_ptr<RTCDeviceTy, ReleaseDevice>;
using EmbreeSceneHandle = std::unique_ptr<RTCSceneTy, ReleaseScene>;
using EmbreeGeometryHandle = std::unique_ptr<RTCGeometryTy, ReleaseGeometry>;

/// What every query carries: Embree's own context first, then what the alpha filter needs. Embree hands it back as a
/// pointer to its first member.
struct QueryContext {
#if RTC_VERSION_MAJOR >= 4
    RTCRayQueryContext rtc;
    RTCFeatureFlags unused = RTC_FEATURE_FLAG_ALL;
#else
    RTCIntersectContext rtc;
#endif
    unsigned key[8];         ///< hash per lane (ray.id), for stochastic coverage
    float transmittance[8];  ///< per lane, of shadow rays: the product of (1 - coverage)
    bool shadow = false;
    bool keep_blend = false;  ///< closest hits stop at partial coverage (`direct` composites the layers)

    QueryContext() {
#if RTC_VERSION_MAJOR >= 4
        rtcInitRayQueryContext(&rtc);
#else
        rtcInitIntersectContext(&rtc);
#endif
    }
};

inline void intersect1(RTCScene scene, QueryContext& context, RTCRayHit& ray, bool coherent) {
#if RTC_VERSION_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context.rtc;
    arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect1(scene, &ray, &arguments);
#else
    context.rtc.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect1(scene, &context.rtc, &ray);
#endif
}

inline void intersect8(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& ray, bool coherent) {
#if RTC_VERSION_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context.rtc;
    arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect8(valid, scene, &ray, &arguments);
#else
    context.rtc.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect8(valid, scene, &context.rtc, &ray);
#endif
}

inline void occluded1(RTCScene scene, QueryContext& context, RTCRay& ray) {
#if RTC_VERSION_MAJOR >= 4
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context.rtc;
    rtcOccluded1(scene, &ray, &arguments);
#else
    context.rtc.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcOccluded1(scene, &context.rtc, &ray);
#endif
}

inline void occluded8(const int* valid, RTCScene scene, QueryContext& context, RTCRay8& ray) {
#if RTC_VERSION_MAJOR >= 4
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context.rtc;
    rtcOccluded8(valid, scene, &ray, &arguments);
#else
    context.rtc.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcOccluded8(valid, scene, &context.rtc, &ray);
#endif
}

}  // namespace kadr
