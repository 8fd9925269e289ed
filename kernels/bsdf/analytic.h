// The analytic model of the `direct` integrator: single-scattering GGX over Lambert.
#pragma once

#include "kernels/bsdf/fresnel.h"
#include "kernels/bsdf/ggx.h"
#include "kernels/scene/requirement.h"

namespace kadr::kernels {

/// f_r = k_d c / pi + D G F / (4 (n.o)(n.i)), without the cosine.
///
/// D: GGX with alpha = max(roughness^2, 1e-3); G: product of Schlick's G1 with k = alpha / 2; F: Schlick over o.h with
/// f0 = lerp(dielectric_f0, base colour, metallic), or for the dielectric part Fresnel's equations; k_d = (1 - F)(1 - metallic). Smoother surfaces than alpha allows are
/// drawn with that alpha: a preview shows the highlight of a lamp on a mirror, where `path` shows the lamp.
///
/// @tparam R  requirements: with kFresnel, exact_fresnel is asked
/// @param dielectric_f0  Fresnel reflectance at normal incidence; 0.04 where the material names no index of refraction
/// @param n   unit, turned to the viewer
/// @param wo  unit, to the viewer;  wi  unit, to the light.  Zero when the light is behind the surface.
template <unsigned R = 0, class F>
SHARED_FN Vec3<F> analytic_brdf(Vec3<F> base_color, F metallic, F roughness, F dielectric_f0, Vec3<F> n, Vec3<F> wo, Vec3<F> wi,
                                bool exact_fresnel = false) {
    const F one(1.0f), zero(0.0f);
    const F n_o = max(dot(n, wo), zero);
    const F n_i = dot(n, wi);
    const Vec3<F> sum = wo + wi;
    const F sum2 = max(dot(sum, sum), least_divisor<F>(1e-20f));
    const F h_o = F(0.5f) * sqrt(sum2);
    const F n_sum = dot(n, sum);
    const Vec3<F> n_cross_sum = cross(n, sum);
    const F inverse = one / sum2;
    const F alpha = ggx_alpha(roughness);
    const F d = ggx_d(dot(n_cross_sum, n_cross_sum) * inverse, n_sum * n_sum * inverse, alpha * alpha);
    // G / (4 (n.o)(n.i)): the cosines of G1 = n.v / (n.v (1 - k) + k) cancel.
    const F k = alpha * F(0.5f);
    const F lobe = F(0.25f) * d / ((n_o * (one - k) + k) * (max(n_i, zero) * (one - k) + k));
    const F fresnel = schlick_weight(h_o);
    const Vec3<F> white{one, one, one};
    Vec3<F> reflectance = lerp(lerp(Vec3<F>{dielectric_f0, dielectric_f0, dielectric_f0}, base_color, metallic), white, fresnel);
    if constexpr ((R & requirement::kFresnel) != 0) {
        if (exact_fresnel) {
            const F excess = (one - metallic) * fresnel_excess(min(h_o, one), sqrt(dielectric_f0));
            reflectance = reflectance + Vec3<F>{excess, excess, excess};
        }
    }
    const Vec3<F> value = (white - reflectance) * base_color * ((one - metallic) * F(kInvPi)) + reflectance * lobe;
    return select(Mask<F>(n_i > zero), value, Vec3<F>{zero, zero, zero});
}

}  // namespace kadr::kernels
