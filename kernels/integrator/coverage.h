// Whether a ray stops at a hit: partial coverage (alpha) and culled back faces. What a tracer asks at every candidate
// hit on such a surface.
#pragma once

#include "kernels/integrator/interaction.h"
#include "kernels/texture/texture.h"

namespace kadr::kernels {

/// What a ray carries to its hits on surfaces that may let it pass.
struct CoverageRay {
    unsigned key = 0;         ///< coverage_key of a closest-hit ray: `blend` covers by chance
    float transmittance = 1;  ///< of a shadow ray: the product of (1 - coverage) so far
    bool shadow = false;
    bool keep_blend = false;  ///< closest hits stop at partial coverage (`direct` composites the layers)
};

/// Hash of a path's ray, from which the chance of each hit follows.
SHARED_FN unsigned coverage_key(unsigned sampler_key, unsigned sample, unsigned bounces) {
    return sampler_key ^ (sample * 0x9E3779B9u) ^ (bounces * 0x85EBCA6Bu);
}

/// Coverage at a hit: factor, texture and vertex colour.
template <class T>
SHARED_FN float coverage(const SceneViewOf<T>& scene, const Material& material, const Geometry& geometry,
                         unsigned primitive, float u, float v) {
    const unsigned* index = geometry.indices + 3 * static_cast<unsigned long>(primitive);
    const float w = 1.0f - u - v;
    float alpha = material.alpha;
    if (geometry.colors)
        alpha *= geometry.colors[index[0]].w * w + geometry.colors[index[1]].w * u + geometry.colors[index[2]].w * v;
    if (material.base_color_texture.texture < 0) return alpha;
    const Vec2f at =
        apply_transform(material.base_color_texture, uv_at(geometry, index, 0, u, v), uv_at(geometry, index, 1, u, v));
    return alpha * sample_texture<float>(scene.textures, material.base_color_texture.texture, at, true).w;
}

/// Uniform in [0, 1) from the ray's key and the place of the hit.
SHARED_FN float coverage_chance(unsigned key, unsigned primitive, unsigned geometry) {
    unsigned h = key ^ (primitive * 0x9E3779B9u) ^ (geometry * 0x85EBCA6Bu);
    h ^= h >> 16;
    h *= 0x7FEB352Du;
    h ^= h >> 15;
    h *= 0x846CA68Bu;
    h ^= h >> 16;
    return static_cast<float>(h >> 8) * (1.0f / 16777216.0f);
}

/// Whether a ray stops at a hit. `mask` covers by its cutoff; `blend` by chance for closest hits and by dimming for
/// shadow rays (the order does not matter there, so shadows stay free of noise).
///
/// @param cull    back faces of single-sided materials let rays pass
/// @param facing  dot product of the geometric normal and the ray, of any length: above 0, the back is seen
template <class T>
SHARED_FN bool stops_at(const SceneViewOf<T>& scene, unsigned geometry, unsigned material_index, unsigned primitive, float u,
                        float v, bool cull, float facing, CoverageRay& ray) {
    const Material& material = scene.materials[material_index];
    if (cull && !material.double_sided && facing > 0) return false;
    if (material.alpha_mode == AlphaMode::opaque) return true;
    const float alpha = coverage(scene, material, scene.geometries[geometry], primitive, u, v);
    if (material.alpha_mode == AlphaMode::mask) return alpha >= material.alpha_cutoff;
    if (ray.shadow) {
        ray.transmittance *= 1.0f - saturate(alpha);
        return !(ray.transmittance > 0.0f);
    }
    if (ray.keep_blend) return alpha > 0.0f;
    return coverage_chance(ray.key, primitive, geometry) < alpha;
}

}  // namespace kadr::kernels
