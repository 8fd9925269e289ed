// Light from an image around the scene (latitude-longitude), sampled by its brightness.
//
// Convention: +y is up, row 0 is the zenith; u = 1/2 + atan2(x, -z) / 2 pi, so the centre of the image is seen along -z
// and its right half lies towards +x; v = angle from +y / pi. `rotate_rad` turns the image counter-clockwise about +y
// (seen from above).
#pragma once

#include "kernels/math/gather.h"

namespace kadr::kernels {

struct EnvironmentMap {
    const Vec3f* texels = nullptr;  ///< [height][width] linear radiance before `factor`
    int width = 0, height = 0;
    const float* marginal = nullptr;     ///< [height + 1] cumulative probability of the rows
    const float* conditional = nullptr;  ///< [height][width + 1] cumulative probability within a row
    float rotate_rad = 0;
    Vec3f factor{1, 1, 1};        ///< colour * strength
    float average_luminance = 0;  ///< over the sphere, before `factor`; see environment_tables.h
};

/// arctan(y / x) over all quadrants, in turns (1 is 2 pi), in [-1/2, 1/2]; 0 for (0, 0). Error below 1e-7.
/// Source of the polynomial: Abramowitz & Stegun 4.4.49.
template <class F>
SHARED_FN F atan2_turns(F y, F x) {
    const F ax = abs(x), ay = abs(y);
    const F larger = max(ax, ay);
    const F t = min(ax, ay) / select(Mask<F>(larger > F(0.0f)), larger, F(1.0f));
    const F t2 = t * t;
    F p(0.0028662257f);
    p = p * t2 + F(-0.0161657367f);
    p = p * t2 + F(0.0429096138f);
    p = p * t2 + F(-0.0752896400f);
    p = p * t2 + F(0.1065626393f);
    p = p * t2 + F(-0.1420889944f);
    p = p * t2 + F(0.1999355085f);
    p = p * t2 + F(-0.3333314528f);
    p = p * t2 + F(1.0f);
    F a = p * t * F(0.5f * kInvPi);
    a = select(Mask<F>(ay > ax), F(0.25f) - a, a);
    a = select(Mask<F>(x < F(0.0f)), F(0.5f) - a, a);
    return copy_sign(a, y);
}

#if !KADR_DEVICE_CODE
SHARED_FN double atan2_turns(double y, double x) { return __builtin_atan2(y, x) * 0.159154943091895336; }
#endif

/// Image coordinates in [0, 1) x [0, 1] of a unit direction.
template <class F>
SHARED_FN Vec2<F> environment_uv(const EnvironmentMap& map, Vec3<F> direction) {
    const F azimuth = atan2_turns(direction.x, -direction.z) + F(0.5f + map.rotate_rad * (0.5f * kInvPi));
    // From the sine and the cosine: the inverse cosine alone loses the rows next to the poles.
    const F sine = sqrt(direction.x * direction.x + direction.z * direction.z);
    return {min(azimuth - floor(azimuth), F(kOneMinusEpsilon)), atan2_turns(sine, direction.y) * F(2.0f)};
}

template <class F>
SHARED_FN Vec3<F> texel_at(const EnvironmentMap& map, Int<F> texel) {
    return gather_vec3<F>(&map.texels->x, texel * Int<F>(3));
}

/// Bilinear between the texels' centres; the row wraps around, the columns end at the poles.
template <class F>
SHARED_FN Vec3<F> environment_texel(const EnvironmentMap& map, Vec2<F> uv) {
    const F x = uv.x * F(static_cast<float>(map.width)) - F(0.5f);
    const F y = uv.y * F(static_cast<float>(map.height)) - F(0.5f);
    const F left = floor(x), top = floor(y);
    const F fx = x - left, fy = y - top;
    const Int<F> column = truncate(left), row = truncate(top), last(map.width - 1), one(1);
    const Int<F> x0 = select(Mask<F>(column < Int<F>(0)), last, clamp_index<F>(column, 0, map.width - 1));
    const Int<F> x1 = select(Mask<F>(x0 < last), x0 + one, Int<F>(0));
    const Int<F> y0 = clamp_index<F>(row, 0, map.height - 1);
    const Int<F> y1 = clamp_index<F>(row + one, 0, map.height - 1);
    const Int<F> upper = y0 * Int<F>(map.width), lower = y1 * Int<F>(map.width);
    return lerp(lerp(texel_at<F>(map, upper + x0), texel_at<F>(map, upper + x1), fx),
                lerp(texel_at<F>(map, lower + x0), texel_at<F>(map, lower + x1), fx), fy);
}

/// Radiance from a unit direction.
template <class F>
SHARED_FN Vec3<F> environment_radiance(const EnvironmentMap& map, Vec3<F> direction) {
    return environment_texel(map, environment_uv(map, direction)) * splat<F>(map.factor);
}

/// Density of a texel's directions, per steradian, from the probabilities that the tables really give it.
template <class F>
SHARED_FN F texel_pdf(const EnvironmentMap& map, Int<F> row, Int<F> column, F sine) {
    const F p_row = gather(map.marginal + 1, row) - gather(map.marginal, row);
    const Int<F> at = row * Int<F>(map.width + 1) + column;
    const F p_column = gather(map.conditional + 1, at) - gather(map.conditional, at);
    const float per_steradian =
        static_cast<float>(map.width) * static_cast<float>(map.height) * (0.5f * kInvPi * kInvPi);
    return p_row * p_column * F(per_steradian) / max(sine, least_divisor<F>(1e-7f));
}

/// Density of sample_environment, per steradian; positive wherever the radiance is.
template <class F>
SHARED_FN F environment_pdf(const EnvironmentMap& map, Vec3<F> direction) {
    const Vec2<F> uv = environment_uv(map, direction);
    const Int<F> column = clamp_index<F>(truncate(uv.x * F(static_cast<float>(map.width))), 0, map.width - 1);
    const Int<F> row = clamp_index<F>(truncate(uv.y * F(static_cast<float>(map.height))), 0, map.height - 1);
    return texel_pdf<F>(map, row, column, sqrt(direction.x * direction.x + direction.z * direction.z));
}

/// Where x lies between cdf[i] and cdf[i + 1], in [0, 1].
template <class F>
SHARED_FN F fraction_within(const float* cdf, Int<F> i, F x) {
    const F low = gather(cdf, i);
    const F width = gather(cdf + 1, i) - low;
    return saturate((x - low) / select(Mask<F>(width > F(0.0f)), width, F(1.0f)));
}

/// A direction drawn by brightness.
///
/// @param direction  unit length
/// @param pdf        per steradian; 0: no sample
template <class F>
SHARED_FN void sample_environment(const EnvironmentMap& map, Vec2<F> u, Vec3<F>& direction, Vec3<F>& radiance, F& pdf) {
    const Int<F> row = find_interval<F>(map.marginal, Int<F>(0), map.height, u.y);
    const Int<F> first = row * Int<F>(map.width + 1);
    const Int<F> at = find_interval<F>(map.conditional, first, map.width, u.x);
    const Int<F> column = at - first;
    const F x = (F(column) + fraction_within<F>(map.conditional, at, u.x)) * F(1.0f / static_cast<float>(map.width));
    const F y = (F(row) + fraction_within<F>(map.marginal, row, u.y)) * F(1.0f / static_cast<float>(map.height));
    F sine, cosine, s, c;
    sincos_2pi(y * F(0.5f), sine, cosine);
    sine = abs(sine);
    sincos_2pi(x - F(0.5f), s, c);
    // Azimuth 0 is -z. The image's rotation is undone with a sine and a cosine common to all lanes.
    const float turns = map.rotate_rad * (0.5f * kInvPi);
    float rotate_s, rotate_c;
    sincos_2pi(turns - floor(turns), rotate_s, rotate_c);
    const F sin_azimuth = s * F(rotate_c) - c * F(rotate_s);
    const F cos_azimuth = c * F(rotate_c) + s * F(rotate_s);
    direction = normalize(Vec3<F>{sine * sin_azimuth, cosine, -sine * cos_azimuth});
    radiance = environment_texel(map, Vec2<F>{x, y}) * splat<F>(map.factor);
    pdf = texel_pdf<F>(map, row, column, sine);
}

}  // namespace kadr::kernels
