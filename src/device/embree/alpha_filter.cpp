#include "device/embree/alpha_filter.h"

#include <cstddef>

#include "kernels/integrator/interaction.h"
#include "kernels/texture/texture.h"

namespace kadr {
namespace {

/// Coverage at a hit: factor, texture and vertex colour.
float coverage(const GeometryUser& user, unsigned primitive, float u, float v) {
    const kernels::Material& material = user.view->materials[user.material];
    const kernels::Geometry& geometry = user.view->geometries[user.geometry];
    const unsigned* index = geometry.indices + 3 * static_cast<std::size_t>(primitive);
    const float w = 1.0f - u - v;
    float alpha = material.alpha;
    if (geometry.colors)
        alpha *= geometry.colors[index[0]].w * w + geometry.colors[index[1]].w * u + geometry.colors[index[2]].w * v;
    if (material.base_color_texture.texture < 0) return alpha;
    const kernels::Vec2f at =
        kernels::apply_transform(material.base_color_texture, kernels::uv_at(geometry, index, 0, u, v),
                                 kernels::uv_at(geometry, index, 1, u, v));
    return alpha * kernels::sample_texture<float>(user.view->textures, material.base_color_texture.texture, at, true).w;
}

/// Uniform in [0, 1) from the path's key and the place of the hit.
float hash_unit(unsigned key, unsigned primitive, unsigned geometry) {
    unsigned h = key ^ (primitive * 0x9E3779B9u) ^ (geometry * 0x85EBCA6Bu);
    h ^= h >> 16;
    h *= 0x7FEB352Du;
    h ^= h >> 15;
    h *= 0x846CA68Bu;
    h ^= h >> 16;
    return static_cast<float>(h >> 8) * 0x1p-24f;
}

/// Whether the hit stops the ray.
bool stops(const GeometryUser& user, QueryContext& context, unsigned lane, unsigned primitive, float u, float v,
           float facing) {
    const kernels::Material& material = user.view->materials[user.material];
    if (user.cull && !material.double_sided && facing > 0) return false;
    if (material.alpha_mode == kernels::AlphaMode::opaque) return true;
    const float alpha = coverage(user, primitive, u, v);
    if (material.alpha_mode == kernels::AlphaMode::mask) return alpha >= material.alpha_cutoff;
    if (context.shadow) {
        context.transmittance[lane] *= 1.0f - kernels::saturate(alpha);
        return !(context.transmittance[lane] > 0.0f);
    }
    if (context.keep_blend) return alpha > 0.0f;
    return hash_unit(context.key[lane], primitive, user.geometry) < alpha;
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
