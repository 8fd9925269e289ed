// Values over several lanes. Kernels are templates over F: `float` (the GPU, the portable form) or `Wide<N>` (N lanes by
// compiler vector extensions). Both forms do the same IEEE operations in the same order, so they agree to the last bit
// wherever -ffp-contract=off holds. `double` is the third form: what the other two are held against (device/exact).
//
// Control flow is by masks: Mask<F>, select(mask, a, b), any(mask).
#pragma once

#include "kernels/math/scalar.h"
#include "kernels/math/vec.h"
#if !KADR_DEVICE_CODE
#include "kernels/math/double.h"
#include "kernels/math/lanes.h"
#endif

namespace kadr::kernels {

template <class F> SHARED_FN Vec3<F> select(Mask<F> m, Vec3<F> a, Vec3<F> b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// kLanes<F> consecutive values. The address is aligned to their size (4 * lanes bytes).
template <class F> struct Memory {
    SHARED_FN static F load(const float* p) { return *reinterpret_cast<const F*>(p); }
    SHARED_FN static void store(float* p, F x) { *reinterpret_cast<F*>(p) = x; }
};

/// Eight values from each of kLanes<F> places: out[k] of lane i is rows[i][k].
template <class F, class T>
SHARED_FN void load_rows(const T* const* rows, F* out) {
#if defined(__AVX__) && !KADR_DEVICE_CODE
    if constexpr (kLanes<F> == 8) {  // eight loads and an 8x8 transposition
        __m256 r[8], t[8];
        for (int i = 0; i < 8; ++i) r[i] = _mm256_loadu_ps(rows[i]);
        for (int i = 0; i < 8; i += 2) {
            t[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
            t[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
        }
        for (int i = 0; i < 8; i += 4) {
            r[i] = _mm256_shuffle_ps(t[i], t[i + 2], 0x44);
            r[i + 1] = _mm256_shuffle_ps(t[i], t[i + 2], 0xee);
            r[i + 2] = _mm256_shuffle_ps(t[i + 1], t[i + 3], 0x44);
            r[i + 3] = _mm256_shuffle_ps(t[i + 1], t[i + 3], 0xee);
        }
        for (int i = 0; i < 4; ++i) {
            out[i].v = (typename F::V)_mm256_permute2f128_ps(r[i], r[i + 4], 0x20);
            out[i + 4].v = (typename F::V)_mm256_permute2f128_ps(r[i], r[i + 4], 0x31);
        }
        return;
    }
#endif
    for (int k = 0; k < 8; ++k)
        for (int i = 0; i < kLanes<F>; ++i) set_lane(out[k], i, static_cast<Real<F>>(rows[i][k]));
}

// ------------------------------------------------------------------------------------------------------ functions

template <class F> SHARED_FN F clamp(F a, F low, F high) { return min(max(a, low), high); }
template <class F> SHARED_FN F saturate(F a) { return min(max(a, F(0.0f)), F(1.0f)); }
template <class F> SHARED_FN F lerp(F a, F b, F t) { return a + (b - a) * t; }
template <class F> SHARED_FN Vec3<F> lerp(Vec3<F> a, Vec3<F> b, F t) { return a + (b - a) * t; }
template <class F> SHARED_FN F square(F a) { return a * a; }
template <class F> SHARED_FN F safe_sqrt(F a) { return sqrt(max(a, F(0.0f))); }
/// a with the sign of s (a >= 0).
template <class F> SHARED_FN F copy_sign(F a, F s) { return as_float(as_uint(a) | (as_uint(s) & UInt<F>(0x80000000u))); }
template <class F> SHARED_FN F max_component(Vec3<F> a) { return max(a.x, max(a.y, a.z)); }
template <class F> SHARED_FN F length(Vec3<F> a) { return sqrt(dot(a, a)); }
template <class F> SHARED_FN Vec3<F> normalize(Vec3<F> a) { return a * (F(1.0f) / sqrt(dot(a, a))); }
/// Finite: neither infinite nor NaN.
template <class F> SHARED_FN Mask<F> is_finite(F a) { return abs(a) < F(3.0e38f); }
template <class F> SHARED_FN Mask<F> is_finite(Vec3<F> a) { return is_finite(abs(a.x) + abs(a.y) + abs(a.z)); }
template <class F, class T> SHARED_FN Vec3<F> splat(Vec3<T> a) { return {F(a.x), F(a.y), F(a.z)}; }

/// What keeps a divisor off zero, or an overflow away: `in_float` where lanes hold floats, far below in double.
template <class F>
SHARED_FN F least_divisor(float in_float) {
    if constexpr (sizeof(Real<F>) == 8) return F(1e-290);
    return F(in_float);
}

/// How far rounding may displace the end of a shadow ray, as a part of its length and of the coordinates about it: eight units
/// in the last place.
template <class F>
SHARED_FN F end_rounding() {
    if constexpr (sizeof(Real<F>) == 8) return F(0x1p-50);
    return F(0x1p-21f);
}

inline constexpr float kPi = 3.14159265358979f;
inline constexpr float kInvPi = 0.318309886183791f;
/// Largest float below 1: what a random number in [0, 1) may be.
inline constexpr float kOneMinusEpsilon = 0.99999994f;

/// sin(2 pi u) and cos(2 pi u) for u in [-2, 2]; error below 4e-7. Reduced to an eighth of a turn, then Taylor series.
template <class F>
SHARED_FN void sincos_2pi(F u, F& s, F& c) {
    const F quadrant = floor(u * F(4.0f) + F(0.5f));       // nearest multiple of a quarter turn
    const F x = (u - quadrant * F(0.25f)) * F(2.0f * kPi);  // in [-pi/4, pi/4]
    const F x2 = x * x;
    const F sx = x * (F(1.0f) + x2 * (F(-1.0f / 6) + x2 * (F(1.0f / 120) + x2 * F(-1.0f / 5040))));
    const F cx = F(1.0f) + x2 * (F(-0.5f) + x2 * (F(1.0f / 24) + x2 * (F(-1.0f / 720) + x2 * F(1.0f / 40320))));
    const Int<F> q = truncate(quadrant + F(16.0f)) & Int<F>(3);
    const Mask<F> swap = (q & Int<F>(1)) == Int<F>(1);
    s = select(swap, cx, sx);
    c = select(swap, sx, cx);
    s = select(q >= Int<F>(2), -s, s);
    c = select((q == Int<F>(1)) | (q == Int<F>(2)), -c, c);
}

/// arccos for a in [-1, 1]; error below 4e-7 in float.  Source: Abramowitz & Stegun 4.4.46.
template <class F>
SHARED_FN F acos(F a) {
    const F x = abs(a);
    F p = F(-0.0012624911f);
    p = p * x + F(0.0066700901f);
    p = p * x + F(-0.0170881256f);
    p = p * x + F(0.0308918810f);
    p = p * x + F(-0.0501743046f);
    p = p * x + F(0.0889789874f);
    p = p * x + F(-0.2145988016f);
    p = p * x + F(1.5707963050f);
    const F r = p * safe_sqrt(F(1.0f) - x);
    return select(a < F(0.0f), F(kPi) - r, r);
}

/// Orthonormal tangents of a unit normal.  Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
template <class F>
SHARED_FN void basis(Vec3<F> n, Vec3<F>& t, Vec3<F>& b) {
    const F sign = copy_sign(F(1.0f), n.z);
    const F a = F(-1.0f) / (sign + n.z);
    const F c = n.x * n.y * a;
    t = {F(1.0f) + sign * n.x * n.x * a, sign * c, -sign * n.x};
    b = {c, sign + n.y * n.y * a, -n.y};
}

/// Coordinates of a vector in an orthonormal frame, and back.
template <class F>
struct Frame {
    Vec3<F> t, b, n;
    SHARED_FN explicit Frame(Vec3<F> normal) : n(normal) { basis(normal, t, b); }
    SHARED_FN Vec3<F> to_local(Vec3<F> v) const { return {dot(v, t), dot(v, b), dot(v, n)}; }
    SHARED_FN Vec3<F> to_world(Vec3<F> v) const { return t * v.x + b * v.y + n * v.z; }
};

}  // namespace kadr::kernels
