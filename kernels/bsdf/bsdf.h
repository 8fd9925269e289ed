// glTF metallic-roughness: a GGX lobe over a diffuse base. The lobe carries the energy of multiple scattering (Turquin
// 2019, "Practical multiple scattering compensation for microfacet models"); the base gets what the dielectric lobe
// lets through. In uniform light a white material reflects all of it, whatever its metallic and roughness. Fresnel terms
// are Schlick's, with a reflectance of 1 at grazing angles whatever the index of refraction (KHR_materials_ior), or for
// dielectrics Fresnel's equations (fresnel.h).
//
// Not reciprocal: both compensations look at the viewer's side alone.
#pragma once

#include "kernels/bsdf/albedo_tables.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/bsdf/ggx.h"
#include "kernels/math/gather.h"
#include "kernels/sampler/warp.h"
#include "kernels/scene/requirement.h"
#include "kernels/scene/scene_types.h"

namespace kadr::kernels {

/// A material at one point, seen from one side.
template <class F>
struct Bsdf {
    Vec3<F> f0;              ///< Fresnel reflectance at normal incidence
    Vec3<F> diffuse;         ///< albedo of the base as seen through the lobe
    Vec3<F> specular_scale;  ///< makes the lobe's albedo that of all scattering orders; >= 1
    F alpha;                 ///< GGX width; 0: the lobe is a delta in the mirror direction
    F specular_probability;  ///< share of the samples that go to the lobe
    F dielectric;            ///< 1 - metallic, where Fresnel's equations hold for that part of the lobe; 0: Schlick's term
    F root_f0;               ///< square root of that part's f0
};

template <class F>
struct BsdfValue {
    Vec3<F> f_cos;  ///< f * cos(theta_i), per steradian
    F pdf;          ///< of sample_bsdf, per steradian
};

template <class F>
struct BsdfSample {
    Vec3<F> wi;      ///< unit length, local frame
    Vec3<F> weight;  ///< f cos / pdf of the whole mixture; 0: no sample
    F pdf;           ///< 0 in the mirror direction of a delta, which no other way of sampling finds
    Mask<F> glossy;  ///< drawn from the lobe
};

/// Albedos of the lobe: `white` with a Fresnel term of 1, `schlick` with (1 - h.o)^5.
///
/// Lobes narrower than the table's first row mask themselves like it under a cosine that is as much larger as their alpha
/// is smaller: masking depends on alpha tan(theta). h.o exceeds the cosine in proportion to alpha. Within 1e-6 and 2e-3
/// of quadrature; a delta's albedos are 1 and its Fresnel term.
template <bool kMirrors = false, class F>
SHARED_FN void lobe_albedo(F cos_o, F roughness, F& white, F& schlick) {
    constexpr int n = kAlbedoTableSize;
    F cosine = saturate(cos_o), ratio(1.0f);
    [[maybe_unused]] const F alpha = ggx_alpha<kMirrors>(roughness);
    if constexpr (kMirrors) {
        ratio = min(alpha * F(1.0f / kMinAlpha), F(1.0f));
        cosine = select(alpha < F(kMinAlpha), saturate(cos_o / max(ratio, F(1e-10f))), cosine);
    }
    const F x = sqrt(sqrt(cosine)) * F(static_cast<float>(n - 1));
    const F y =
        max((sqrt(saturate(roughness)) - F(kAlbedoTableStart)) * F((n - 1) / (1.0f - kAlbedoTableStart)), F(0.0f));
    const Int<F> i = clamp_index<F>(truncate(x), 0, n - 2);
    const Int<F> j = clamp_index<F>(truncate(y), 0, n - 2);
    const Int<F> at = j * Int<F>(n) + i;
    white = table_bilinear(kAlbedoWhite, n, at, x - F(i), y - F(j));
    schlick = table_bilinear(kAlbedoSchlick, n, at, x - F(i), y - F(j));
    if constexpr (kMirrors) {
        const F excess = (white * schlick_weight(cosine) - schlick) * ratio;
        white = select(alpha > F(0.0f), white, F(1.0f));
        schlick = select(alpha < F(kMinAlpha), white * schlick_weight(cos_o) - excess, schlick);
    }
}

/// Albedos of the lobe for Fresnel reflectances f0 (and f90 = 1), of one scattering order and of all.
template <class F>
SHARED_FN F single_albedo(F f0, F white, F schlick) {
    return f0 * (white - schlick) + schlick;
}
template <class F>
SHARED_FN F compensated_albedo(F f0, F white, F schlick, F missing) {
    return single_albedo(f0, white, schlick) * (F(1.0f) + f0 * missing);
}

/// What Fresnel's equations add to the albedo of a dielectric's lobe, of one scattering order. Lobes narrower than the
/// table's first row are taken for mirrors.
template <bool kMirrors, class F>
SHARED_FN F dielectric_excess(F cos_o, F roughness, F root_f0, F white, F schlick_single) {
    F excess = lobe_fresnel_excess(cos_o, sqrt(saturate(roughness)), root_f0);
    if constexpr (kMirrors)
        excess = select(ggx_alpha<true>(roughness) < F(kMinAlpha), white * fresnel_excess(cos_o, root_f0), excess);
    return max(excess, -schlick_single);  // the table's error must not take more than there is
}

/// @tparam R  requirements. kMirrors: lobes narrower than kMinAlpha are as narrow as they should be. kFresnel: asks
///            `exact_fresnel`. Elsewhere the same to the last bit
/// @param base_color, metallic, roughness  in [0, 1]
/// @param cos_o  cosine between the shading normal and the viewer, > 0
/// @param f0     Fresnel reflectance of the dielectric at normal incidence, in [0, 1]
/// @param exact_fresnel  Fresnel's equations for the dielectric
template <unsigned R = 0, class F>
SHARED_FN Bsdf<F> make_bsdf(Vec3<F> base_color, F metallic, F roughness, F cos_o, F f0 = F(kDielectricF0), bool exact_fresnel = false) {
    constexpr bool kMirrors = (R & requirement::kMirrors) != 0, kFresnel = (R & requirement::kFresnel) != 0;
    const F one(1.0f), tiny = least_divisor<F>(1e-20f);
    F white, schlick;
    lobe_albedo<kMirrors>(cos_o, roughness, white, schlick);
    const F missing = (one - white) / white;
    F single = single_albedo(f0, white, schlick);
    Bsdf<F> b;
    b.alpha = ggx_alpha<kMirrors>(roughness);
    b.dielectric = b.root_f0 = F(0.0f);
    F excess(0.0f);
    if constexpr (kFresnel) {
        if (exact_fresnel) {
            b.dielectric = one - metallic;
            b.root_f0 = sqrt(f0);
            excess = dielectric_excess<kMirrors>(cos_o, roughness, b.root_f0, white, single);
            single = single + excess;
        }
    }
    const F dielectric = single * (one + f0 * missing);
    b.diffuse = base_color * ((one - metallic) * (one - dielectric));
    Vec3<F> specular{dielectric, dielectric, dielectric};
    b.f0 = {f0, f0, f0};
    if (any(metallic > F(0.0f))) {
        // glTF mixes a dielectric and a metal; Schlick's term is linear in f0, so one lobe serves both, scaled to the
        // mixture of their albedos.
        b.f0 = lerp(b.f0, base_color, metallic);
        const Vec3<F> metal{compensated_albedo(base_color.x, white, schlick, missing),
                            compensated_albedo(base_color.y, white, schlick, missing),
                            compensated_albedo(base_color.z, white, schlick, missing)};
        specular = lerp(specular, metal, metallic);
        Vec3<F> mixture{single_albedo(b.f0.x, white, schlick), single_albedo(b.f0.y, white, schlick), single_albedo(b.f0.z, white, schlick)};
        if constexpr (kFresnel) {
            const F more = b.dielectric * excess;
            mixture = mixture + Vec3<F>{more, more, more};
        }
        b.specular_scale = {specular.x / max(mixture.x, tiny), specular.y / max(mixture.y, tiny), specular.z / max(mixture.z, tiny)};
    } else {  // the same to the last bit
        const F scale = dielectric / max(single, tiny);
        b.specular_scale = {scale, scale, scale};
    }
    const F s = luminance(specular);
    const F d = luminance(b.diffuse);
    // Neither lobe below 5 %: a lobe that lights shine into must not be met once in a thousand samples.
    const F share = clamp(s / max(s + d, tiny), F(0.05f), F(0.95f));
    b.specular_probability = select(Mask<F>(d > F(0.0f)), share, one);
    return b;
}

/// Fresnel reflectance of the lobe over the cosine between a direction and the microfacet's normal.
template <unsigned R, class F>
SHARED_FN Vec3<F> lobe_reflectance(const Bsdf<F>& b, F cosine) {
    const F one(1.0f);
    const Vec3<F> reflectance = lerp(b.f0, Vec3<F>{one, one, one}, schlick_weight(cosine));
    if constexpr ((R & requirement::kFresnel) != 0) {
        if (any(b.dielectric > F(0.0f))) {
            const F excess = b.dielectric * fresnel_excess(min(cosine, one), b.root_f0);
            return reflectance + Vec3<F>{excess, excess, excess};
        }
    }
    return reflectance;
}

/// Value and density of a direction of light. Local frame, wo.z > 0; zero for light from below the horizon. A delta has
/// neither: there it is the base alone.
template <unsigned R = 0, class F>
SHARED_FN BsdfValue<F> evaluate_bsdf(const Bsdf<F>& b, Vec3<F> wo, Vec3<F> wi) {
    constexpr bool kMirrors = (R & requirement::kMirrors) != 0;
    const F zero(0.0f), one(1.0f);
    const Vec3<F> sum = wo + wi;
    const F sum2 = max(dot(sum, sum), least_divisor<F>(1e-20f));
    const F alpha2 = b.alpha * b.alpha;
    // D = alpha^2 / (pi t^2); from the sines of h, because 1 - cos^2 would lose every digit of a narrow lobe.
    const F t = (sum.x * sum.x + sum.y * sum.y + alpha2 * sum.z * sum.z) / sum2;
    const F root_o = smith_root(wo.z, alpha2);
    const F root_i = smith_root(wi.z, alpha2);
    // Lobe: D G2 / (4 cos_o) with G2 = 2 cos_o cos_i / (cos_i root_o + cos_o root_i); density: G1 D / (4 cos_o) with
    // G1 = 2 cos_o / (cos_o + root_o). Both over one common denominator.
    const F masking = wi.z * root_o + wo.z * root_i;
    const F visible = wo.z + root_o;
    F least = least_divisor<F>(1e-34f);
    if constexpr (kMirrors) least = select(b.alpha < F(kMinAlpha), least_divisor<F>(1e-37f), least);
    const F common = F(0.5f * kInvPi) * alpha2 / max(t * t * masking * visible, least);
    const F lobe = common * wi.z * visible;
    const F lobe_pdf = common * masking;
    const F base = F(kInvPi) * wi.z;
    const Vec3<F> reflectance = lobe_reflectance<R>(b, F(0.5f) * sqrt(sum2));  // |wo + wi| = 2 cos of the half angle
    const Vec3<F> f_cos = reflectance * b.specular_scale * lobe + b.diffuse * base;
    const F pdf = base * (one - b.specular_probability) + lobe_pdf * b.specular_probability;
    const Mask<F> above = wi.z > zero;
    return {select(above, f_cos, Vec3<F>{zero, zero, zero}), select(above, pdf, zero)};
}

/// A direction of light, drawn from one lobe and weighed with the density of both.
///
/// @param u_lobe  chooses the lobe
template <unsigned R = 0, class F>
SHARED_FN BsdfSample<F> sample_bsdf(const Bsdf<F>& b, Vec3<F> wo, Vec2<F> u, F u_lobe) {
    constexpr bool kMirrors = (R & requirement::kMirrors) != 0;
    BsdfSample<F> result;
    result.glossy = u_lobe < b.specular_probability;
    F radius, turns, s, c;
    concentric_polar(u, radius, turns);
    sincos_2pi(select(result.glossy, u.x, turns), s, c);
    const Vec3<F> diffuse{radius * c, radius * s, safe_sqrt(F(1.0f) - radius * radius)};
    const Vec3<F> h = sample_visible_normal(wo, b.alpha, s, c, u.y);
    const Vec3<F> reflected = h * (F(2.0f) * dot(h, wo)) - wo;
    result.wi = select(result.glossy, reflected, diffuse);
    const BsdfValue<F> value = evaluate_bsdf<R>(b, wo, result.wi);
    const Mask<F> valid = value.pdf > F(0.0f);
    result.weight = value.f_cos * (F(1.0f) / select(valid, value.pdf, F(1.0f)));  // f_cos is 0 where the density is
    result.pdf = value.pdf;
    if constexpr (kMirrors) {
        const Mask<F> mirrored = result.glossy & (b.alpha == F(0.0f));
        const Vec3<F> reflectance = lobe_reflectance<R>(b, wo.z);
        result.wi = select(mirrored, Vec3<F>{-wo.x, -wo.y, wo.z}, result.wi);
        result.weight = select(mirrored, reflectance * b.specular_scale * (F(1.0f) / b.specular_probability), result.weight);
        result.pdf = select(mirrored, F(0.0f), result.pdf);
    }
    return result;
}

}  // namespace kadr::kernels
