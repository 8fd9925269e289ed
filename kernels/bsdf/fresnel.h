// How much of the light a surface reflects, over the cosine between the direction of light and the microfacet's normal.
//
// Schlick's term f0 + (1 - f0) (1 - x)^5 is what glTF asks for. For an index of 1.5 it is off by up to 0.036 (too bright at
// 84 degrees, too dark at 68); for indices near 1 and of diamond it is far too bright at grazing angles. Fresnel's
// equations are the other choice for dielectrics (render.fresnel); metals keep Schlick's term, because files name their
// colour and no complex index.
#pragma once

#include "kernels/bsdf/fresnel_table.h"
#include "kernels/math/gather.h"
#include "kernels/math/wide.h"

namespace kadr::kernels {

/// (1 - x)^5 of Schlick's Fresnel term.
template <class F>
SHARED_FN F schlick_weight(F x) {
    const F m = saturate(F(1.0f) - x);
    const F m2 = m * m;
    return m2 * m2 * m;
}

/// Reflectance of a dielectric for unpolarised light that comes from the thinner side.
///
/// Source: Fresnel's equations in the form of Cook and Torrance 1982, "A Reflectance Model for Computer Graphics", eq. (13):
/// with g^2 = n^2 - 1 + x^2, F = 1/2 ((g - x) / (g + x))^2 (1 + ((x (g + x) - 1) / (x (g - x) + 1))^2). Here everything is
/// multiplied by k = 1 - sqrt(f0): with n = (1 + sqrt(f0)) / k neither an index of 1 loses digits nor an infinite one
/// divides by zero.
///
/// @param x        cosine, in [0, 1]
/// @param root_f0  square root of the reflectance at normal incidence, in [0, 1]
template <class F>
SHARED_FN F dielectric_fresnel(F x, F root_f0) {
    const F one(1.0f), k = one - root_f0, four_root = F(4.0f) * root_f0;
    const F kx = k * x;
    const F sum = max(sqrt(four_root + kx * kx) + kx, least_divisor<F>(1e-18f));  // k (g + x)
    const F difference = four_root / sum;                                        // k (g - x)
    const F a = difference / sum;
    const F b = (x * sum - k) / max(x * difference + k, least_divisor<F>(1e-18f));
    return saturate(F(0.5f) * a * a * (one + b * b));
}

/// What Fresnel's equations give beyond Schlick's term.
template <class F>
SHARED_FN F fresnel_excess(F x, F root_f0) {
    return dielectric_fresnel(x, root_f0) - lerp(root_f0 * root_f0, F(1.0f), schlick_weight(x));
}

/// The same for a lobe seen under a cosine: the excess over all directions of light, of one order of scattering.
///
/// Between the entries of a table of three axes: within 0.003 of quadrature for indices from 1.07 on, 0.01 for those
/// below; 0.001 on average.
/// @param quarter_alpha  alpha^(1/4) from the table's start on, i.e. the square root of the perceptual roughness
template <class F>
SHARED_FN F lobe_fresnel_excess(F cos_o, F quarter_alpha, F root_f0) {
    constexpr int n = kFresnelTableSize, layers = kFresnelTableLayers;
    const F x = sqrt(sqrt(saturate(cos_o))) * F(static_cast<float>(n - 1));
    const F y = max((quarter_alpha - F(kFresnelTableStart)) * F((n - 1) / (1.0f - kFresnelTableStart)), F(0.0f));
    const F z = sqrt(sqrt(saturate(root_f0))) * F(static_cast<float>(layers - 1));
    const Int<F> i = clamp_index<F>(truncate(x), 0, n - 2);
    const Int<F> j = clamp_index<F>(truncate(y), 0, n - 2);
    const Int<F> layer = clamp_index<F>(truncate(z), 0, layers - 2);
    const F fx = x - F(i), fy = y - F(j);
    const Int<F> at = (layer * Int<F>(n) + j) * Int<F>(n) + i;
    return lerp(table_bilinear<F>(kFresnelExcess, n, at, fx, fy), table_bilinear<F>(kFresnelExcess + n * n, n, at, fx, fy), z - F(layer));
}

}  // namespace kadr::kernels
