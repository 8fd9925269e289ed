#include "device/embree/alpha_filter.h"

#include "kernels/integrator/coverage.h"

namespace kadr {
namespace {

/// Whether the hit stops the ray.
bool stops(const GeometryUser& user, QueryContext& context, unsigned lane, unsigned primitive, float u, float v,
           float facing) {
    kernels::CoverageRay ray{context.key[lane], context.transmittance[lane], context.shadow, context.keep_blend};
    const bool stopped = kernels::stops_at(*user.view, user.geometry, user.material, primitive, u, v, user.cull, facing, ray);
    context.transmittance[lane] = ray.transmittance;
    return stopped;
}

}  // namespace

void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
    const GeometryUser& user = *static_cast<const GeometryUser*>(arguments->geometryUserPtr);
    QueryContext& context = *reinterpret_cast<QueryContext*>(arguments->context);
    const unsigned n = arguments->N;
    for (unsigned i = 0; i < n; ++i) {
        if (arguments->valid[i] == 0) continue;
        const unsigned lane = RTCRayN_id(arguments->ray, n, i) & 7u;
        const float facing = RTCHitN_Ng_x(arguments->hit, n, i) * RTCRayN_dir_x(arguments->ray, n, i) +
                             RTCHitN_Ng_y(arguments->hit, n, i) * RTCRayN_dir_y(arguments->ray, n, i) +
                             RTCHitN_Ng_z(arguments->hit, n, i) * RTCRayN_dir_z(arguments->ray, n, i);
        if (!stops(user, context, lane, RTCHitN_primID(arguments->hit, n, i), RTCHitN_u(arguments->hit, n, i),
                   RTCHitN_v(arguments->hit, n, i), facing))
            arguments->valid[i] = 0;
    }
}

}  // namespace kadr
