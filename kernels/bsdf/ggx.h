// The GGX distribution of normals, in the local frame of the shading normal (+z).
#pragma once

#include "kernels/math/wide.h"

namespace kadr::kernels {

/// Smallest alpha (roughness 0.032) of the analytic model, and of kernels without requirement::kMirrors: a lobe of 0.06
/// degrees.
inline constexpr float kMinAlpha = 1e-3f;

/// The lobe of a smaller alpha (roughness 0.0032) is a delta: light leaves in the mirror direction alone. Half of its
/// light lies within 2 alpha, here 2e-5 rad of that direction: less than half a pixel of a picture 16384 pixels wide
/// through a lens of 40 degrees (4.3e-5 rad). Sideways a lobe is as narrow as 2 alpha cos(theta): at the most grazing
/// angle that is shaded (cosine 1e-3) that is 2e-8, below the 6e-8 to which a float knows a direction.
inline constexpr float kDeltaAlpha = 1e-5f;

/// alpha of a perceptual roughness.
/// @tparam kMirrors  down to kDeltaAlpha, and 0 for the delta below; otherwise no less than kMinAlpha
template <bool kMirrors = false, class F>
SHARED_FN F ggx_alpha(F roughness) {
    const F alpha = roughness * roughness;
    if constexpr (kMirrors) return select(alpha < F(kDeltaAlpha), F(0.0f), alpha);
    return max(alpha, F(kMinAlpha));
}

/// Density of microfacet normals, from the sines of h: 1 - cos^2 would lose every digit of a narrow lobe.
template <class F>
SHARED_FN F ggx_d(F sin2_h, F cos2_h, F alpha2) {
    const F t = sin2_h + alpha2 * cos2_h;
    return alpha2 / max(F(kPi) * t * t, least_divisor<F>(1e-30f));
}

/// cos sqrt(1 + alpha^2 tan^2): what Smith's masking is made of.  G1 = 2 cos / (cos + root).
template <class F>
SHARED_FN F smith_root(F cos_v, F alpha2) {
    return sqrt(alpha2 + (F(1.0f) - alpha2) * cos_v * cos_v);
}

/// Normals seen from wo, in proportion to their projected area.
/// Source: Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps". The azimuth comes as its sine and
/// cosine, so that a caller with two lobes computes them once.
template <class F>
SHARED_FN Vec3<F> sample_visible_normal(Vec3<F> wo, F alpha, F sin_phi, F cos_phi, F v) {
    const Vec3<F> o = normalize(Vec3<F>{alpha * wo.x, alpha * wo.y, wo.z});
    const F z = (F(1.0f) - v) * (F(1.0f) + o.z) - o.z;
    const F s = safe_sqrt((F(1.0f) - z) * (F(1.0f) + z));
    const Vec3<F> h{alpha * (s * cos_phi + o.x), alpha * (s * sin_phi + o.y), max(z + o.z, F(1e-7f))};
    return normalize(h);
}

}  // namespace kadr::kernels
