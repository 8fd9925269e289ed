// glTF metallic-roughness: a GGX lobe over a diffuse base. The lobe carries the energy of multiple scattering (Turquin
// 2019, "Practical multiple scattering compensation for microfacet models"); the base gets what the dielectric lobe
// lets through. In uniform light a white material reflects all of it, whatever its metallic and roughness.
//
// Not reciprocal: both compensations look at the viewer's side alone.
#pragma once

#include "kernels/bsdf/albedo_tables.h"
#include "kernels/bsdf/ggx.h"
#include "kernels/math/gather.h"
#include "kernels/sampler/warp.h"

namespace kadr::kernels {

/// Fresnel reflectance of a dielectric of index 1.5 at normal incidence.
inline constexpr float kDielectricF0 = 0.04f;

/// A material at one point, seen from one side.
template <class F>
struct Bsdf {
    Vec3<F> f0;              ///< Fresnel reflectance at normal incidence
    Vec3<F> diffuse;         ///< albedo of the base as seen through the lobe
    Vec3<F> specular_scale;  ///< makes the lobe's albedo that of all scattering orders; >= 1
    F alpha;                 ///< GGX width
    F specular_probability;  ///< share of the samples that go to the lobe
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
    F pdf;
    Mask<F> glossy;  ///< drawn from the lobe
};

/// Albedos of the lobe: `white` with a Fresnel term of 1, `schlick` with (1 - h.o)^5.
template <class F>
SHARED_FN void lobe_albedo(F cos_o, F roughness, F& white, F& schlick) {
    constexpr int n = kAlbedoTableSize;
    const F x = sqrt(sqrt(saturate(cos_o))) * F(static_cast<float>(n - 1));
    const F row = (sqrt(saturate(roughness)) - F(kAlbedoTableStart)) * F((n - 1) / (1.0f - kAlbedoTableStart));
    const F y = max(row, F(0.0f));
    const Int<F> i = clamp_index<F>(truncate(x), 0, n - 2);
    const Int<F> j = clamp_index<F>(truncate(y), 0, n - 2);
    const F fx = x - F(i);
    const F fy = y - F(j);
    const Int<F> at = j * Int<F>(n) + i;
    const auto bilinear = [&](const float* t) {
        const F low = lerp(gather(t, at), gather(t + 1, at), fx);
        const F high = lerp(gather(t + n, at), gather(t + n + 1, at), fx);
        return lerp(low, high, fy);
    };
    white = bilinear(kAlbedoWhite);
    schlick = bilinear(kAlbedoSchlick);
}

/// Albedo of the lobe with all scattering orders, for a Fresnel reflectance f0 = f90 = 1 at most.
template <class F>
SHARED_FN F compensated_albedo(F f0, F white, F schlick, F missing) {
    return (f0 * (white - schlick) + schlick) * (F(1.0f) + f0 * missing);
}

/// @param base_color, metallic, roughness  in [0, 1]
/// @param cos_o  cosine between the shading normal and the viewer, > 0
template <class F>
SHARED_FN Bsdf<F> make_bsdf(Vec3<F> base_color, F metallic, F roughness, F cos_o) {
    const F one(1.0f);
    F white, schlick;
    lobe_albedo(cos_o, roughness, white, schlick);
    const F missing = (one - white) / white;
    const F dielectric = compensated_albedo(F(kDielectricF0), white, schlick, missing);
    // glTF mixes a dielectric and a metal; Schlick's term is linear in f0, so one lobe serves both, scaled to the
    // mixture of their albedos.
    Bsdf<F> b;
    b.alpha = ggx_alpha(roughness);
    const F base_share = (one - metallic) * (one - dielectric);
    b.diffuse = base_color * base_share;
    const auto channel = [&](F color, F& f0, F& scale) {
        f0 = F(kDielectricF0) + (color - F(kDielectricF0)) * metallic;
        const F metal = compensated_albedo(color, white, schlick, missing);
        const F albedo = dielectric + (metal - dielectric) * metallic;
        scale = albedo / max(f0 * (white - schlick) + schlick, F(1e-20f));
        return albedo;
    };
    Vec3<F> specular;
    specular.x = channel(base_color.x, b.f0.x, b.specular_scale.x);
    specular.y = channel(base_color.y, b.f0.y, b.specular_scale.y);
    specular.z = channel(base_color.z, b.f0.z, b.specular_scale.z);
    const F s = luminance(specular);
    const F d = luminance(b.diffuse);
    // Neither lobe below 5 %: a lobe that lights shine into must not be met once in a thousand samples.
    const F share = clamp(s / max(s + d, F(1e-20f)), F(0.05f), F(0.95f));
    b.specular_probability = select(Mask<F>(d > F(0.0f)), share, one);
    return b;
}

/// Value and density of a direction of light. Local frame, wo.z > 0; zero for light from below the horizon.
template <class F>
SHARED_FN BsdfValue<F> evaluate_bsdf(const Bsdf<F>& b, Vec3<F> wo, Vec3<F> wi) {
    const Vec3<F> sum = wo + wi;
    const F sum2 = max(dot(sum, sum), F(1e-20f));
    const F inverse = F(1.0f) / sum2;
    const F cos2_h = sum.z * sum.z * inverse;
    const F sin2_h = (sum.x * sum.x + sum.y * sum.y) * inverse;
    const F h_o = F(0.5f) * sqrt(sum2);  // |wo + wi| = 2 cos of the half angle
    const F alpha2 = b.alpha * b.alpha;
    const F d = ggx_d(sin2_h, cos2_h, alpha2);
    const F root_o = smith_root(wo.z, alpha2);
    const F root_i = smith_root(wi.z, alpha2);
    // D G2 / (4 cos_o) with G2 = 2 cos_o cos_i / (cos_i root_o + cos_o root_i); pdf = G1 D / (4 cos_o).
    const F lobe = F(0.5f) * d * wi.z / max(wi.z * root_o + wo.z * root_i, F(1e-20f));
    const F lobe_pdf = F(0.5f) * d / (wo.z + root_o);
    const F fresnel = schlick_weight(h_o);
    const F base = F(kInvPi) * wi.z;
    const auto channel = [&](F f0, F scale, F diffuse) {
        return (f0 + (F(1.0f) - f0) * fresnel) * scale * lobe + diffuse * base;
    };
    const Mask<F> above = wi.z > F(0.0f);
    const F zero(0.0f);
    const Vec3<F> f_cos{channel(b.f0.x, b.specular_scale.x, b.diffuse.x),
                        channel(b.f0.y, b.specular_scale.y, b.diffuse.y),
                        channel(b.f0.z, b.specular_scale.z, b.diffuse.z)};
    const F pdf = base + (lobe_pdf - base) * b.specular_probability;
    return {select(above, f_cos, Vec3<F>{zero, zero, zero}), select(above, pdf, zero)};
}

/// A direction of light, drawn from one lobe and weighed with the density of both.
///
/// @param u_lobe  chooses the lobe
template <class F>
SHARED_FN BsdfSample<F> sample_bsdf(const Bsdf<F>& b, Vec3<F> wo, Vec2<F> u, F u_lobe) {
    BsdfSample<F> result;
    result.glossy = u_lobe < b.specular_probability;
    F radius, turns, s, c;
    concentric_polar(u, radius, turns);
    sincos_2pi(select(result.glossy, u.x, turns), s, c);
    const Vec3<F> diffuse{radius * c, radius * s, safe_sqrt(F(1.0f) - radius * radius)};
    const Vec3<F> h = sample_visible_normal(wo, b.alpha, s, c, u.y);
    const Vec3<F> reflected = h * (F(2.0f) * dot(h, wo)) - wo;
    result.wi = normalize(select(result.glossy, reflected, diffuse));
    const BsdfValue<F> value = evaluate_bsdf(b, wo, result.wi);
    const Mask<F> valid = value.pdf > F(0.0f);
    const F inverse = select(valid, F(1.0f) / select(valid, value.pdf, F(1.0f)), F(0.0f));
    result.weight = value.f_cos * inverse;
    result.pdf = value.pdf;
    return result;
}

}  // namespace kadr::kernels
