// Maps from the unit square that more than one folder uses.
#pragma once

#include "kernels/math/wide.h"

namespace kadr::kernels {

/// Polar coordinates of the concentric map: radius in [-1, 1] and angle in turns.
/// Source: Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square".
template <class F>
SHARED_FN void concentric_polar(Vec2<F> u, F& radius, F& turns) {
    const F a = u.x * F(2.0f) - F(1.0f);
    const F b = u.y * F(2.0f) - F(1.0f);
    const Mask<F> wide = abs(a) > abs(b);
    radius = select(wide, a, b);
    const F other = select(wide, b, a);
    const F eighth = F(0.125f) * (other / select(Mask<F>(radius == F(0.0f)), F(1.0f), radius));
    turns = select(wide, eighth, F(0.25f) - eighth);
}

/// Uniform on the unit disk.
template <class F>
SHARED_FN Vec2<F> sample_disk(Vec2<F> u) {
    F radius, turns, s, c;
    concentric_polar(u, radius, turns);
    sincos_2pi(turns, s, c);
    return {radius * c, radius * s};
}

/// Uniform on the regular polygon of `corners` >= 3 corners on the unit circle, the first at +x.
template <class F>
SHARED_FN Vec2<F> sample_polygon(int corners, Vec2<F> u) {
    const F scaled = u.x * F(static_cast<float>(corners));
    const F wedge = min(floor(scaled), F(static_cast<float>(corners - 1)));
    const F from_centre = safe_sqrt(scaled - wedge);
    const float turn = 1.0f / static_cast<float>(corners);
    float wedge_s, wedge_c;
    sincos_2pi(turn, wedge_s, wedge_c);
    // The wedge between the corners at angle 0 and at 1/corners, then turned to its place.
    const F x = from_centre * (F(1.0f) + u.y * F(wedge_c - 1.0f));
    const F y = from_centre * (u.y * F(wedge_s));
    F s, c;
    sincos_2pi(wedge * F(turn), s, c);
    return {x * c - y * s, x * s + y * c};
}

/// Direction in the cone around +z whose half-angle has 1 - cos = `one_minus_cos`; pdf 1 / (2 pi one_minus_cos).
/// Takes 1 - cos, not cos: narrow cones keep their precision.
template <class F>
SHARED_FN Vec3<F> sample_cone(F one_minus_cos, Vec2<F> u) {
    const F x = u.x * one_minus_cos;
    const F radius = safe_sqrt(x * (F(2.0f) - x));
    F s, c;
    sincos_2pi(u.y, s, c);
    return {radius * c, radius * s, F(1.0f) - x};
}

}  // namespace kadr::kernels
