// The analytic model: light that arrives straight from punctual lights, hard shadows, no noise with one sample a pixel.
// L = emission + sum over lights of f_r * L_i * max(N . w_i, 0), over a constant background.
#pragma once

#include "kernels/bsdf/analytic.h"
#include "kernels/integrator/interaction.h"
#include "kernels/integrator/path.h"
#include "kernels/light/light.h"

namespace kadr::kernels {

/// Surfaces of partial coverage that a ray passes before it is cut off.
inline constexpr unsigned kMaxLayers = 64;

template <class F>
struct DirectResult {
    PathState<F> next;  ///< straight on, behind a surface of partial coverage
    Mask<F> alive;
    Vec3<F> albedo, normal;
};

/// One hit under every light.
/// @param emitted  called once, with the light that the surface emits towards the viewer
/// @param shadow   called after that with a ShadowRay<F> for every light that can reach some lane
template <class F, unsigned R, class Emitted, class Shadow>
SHARED_FN DirectResult<F> shade_direct(const SceneFor<F>& scene, const PathState<F>& path, const Hit<F>& hit,
                                       Mask<F> active, const Emitted& emitted, const Shadow& shadow) {
    const Vec3<F> zero{F(0.0f), F(0.0f), F(0.0f)};
    const Vec3<F> wo = -path.direction;
    const Interaction<F> it = make_interaction<F, R>(scene, hit, path.time, wo, active);
    const Vec3<F> covered = path.beta * it.alpha;
    DirectResult<F> result;
    emitted(select(active, it.emission * covered, zero));
    result.albedo = it.base_color;
    result.normal = it.shading_normal;
    const Mask<F> lit = active & !it.unlit;
    for (int i = 0; i < scene.lights.count; ++i) {
        const LightOf<Real<F>>* keys = scene.lights.keys + scene.lights.first[i];
        const LightSample<F> light =
            sample_light(keys, scene.lights.key_count[i], path.time, it.origin, Vec2<F>{F(0.5f), F(0.5f)});
        const F cosine = max(dot(it.shading_normal, light.direction), F(0.0f));
        const Vec3<F> f =
            analytic_brdf<R>(it.base_color, it.metallic, it.roughness, it.dielectric_f0, it.shading_normal, wo, light.direction,
                             scene.settings.exact_fresnel);
        ShadowRay<F> ray;
        ray.origin = it.origin;
        ray.direction = light.direction;
        ray.distance = shadow_distance(light.distance);
        ray.radiance = covered * f * light.radiance * cosine;
        ray.active =
            lit & (max_component(ray.radiance) > F(0.0f)) & (dot(light.direction, it.geometric_normal) > F(0.0f));
        if (any(ray.active)) shadow(ray);
    }
    result.alive = active & (it.alpha < F(1.0f)) & (path.bounces < UInt<F>(kMaxLayers));
    result.next = path;
    result.next.origin = it.position + it.position - it.origin;  // the mirror image of the offset: the far side
    result.next.beta = path.beta * (F(1.0f) - it.alpha);
    result.next.bounces = path.bounces + UInt<F>(1u);
    return result;
}

}  // namespace kadr::kernels
