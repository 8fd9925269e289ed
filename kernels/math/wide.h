// Values over several lanes. Kernels are templates over F: `float` (the GPU, the portable form) or `Wide<N>` (N lanes by
// compiler vector extensions). Both forms do the same IEEE operations in the same order, so they agree to the last bit
// wherever -ffp-contract=off holds.
//
// Control flow is by masks: Mask<F>, select(mask, a, b), any(mask).
#pragma once

#include "kernels/math/vec.h"

#if defined(__AVX__) && !defined(__CUDACC__) && !defined(__HIPCC__)
#include <immintrin.h>
#endif

namespace kadr::kernels {

// ---------------------------------------------------------------------------------------------------- several lanes

template <int N> struct WideMask;
template <int N> struct WideUInt;

/// The compiler's vector types, spelled out by width (a dependent vector_size does not overload in GCC).
template <int N> struct VectorTypes;
template <> struct VectorTypes<4> {
    typedef float Float __attribute__((vector_size(16)));
    typedef int Int __attribute__((vector_size(16)));
    typedef unsigned UInt __attribute__((vector_size(16)));
};
template <> struct VectorTypes<8> {
    typedef float Float __attribute__((vector_size(32)));
    typedef int Int __attribute__((vector_size(32)));
    typedef unsigned UInt __attribute__((vector_size(32)));
};
template <> struct VectorTypes<16> {
    typedef float Float __attribute__((vector_size(64)));
    typedef int Int __attribute__((vector_size(64)));
    typedef unsigned UInt __attribute__((vector_size(64)));
};

template <int N>
struct WideInt {
    using V = typename VectorTypes<N>::Int;
    V v;
    WideInt() = default;
    SHARED_FN WideInt(int s) : v(V{} + s) {}
    SHARED_FN explicit WideInt(V vector) : v(vector) {}
    SHARED_FN explicit WideInt(WideUInt<N> u);
};

template <int N>
struct WideUInt {
    using V = typename VectorTypes<N>::UInt;
    V v;
    WideUInt() = default;
    SHARED_FN WideUInt(unsigned s) : v(V{} + s) {}
    SHARED_FN explicit WideUInt(V vector) : v(vector) {}
    SHARED_FN explicit WideUInt(WideInt<N> i) : v((V)i.v) {}
};

template <int N> SHARED_FN WideInt<N>::WideInt(WideUInt<N> u) : v((V)u.v) {}

/// All bits of a lane set (true) or none (false).
template <int N>
struct WideMask {
    using V = typename VectorTypes<N>::Int;
    V v;
    WideMask() = default;
    SHARED_FN WideMask(bool s) : v(V{} - static_cast<int>(s)) {}
    SHARED_FN explicit WideMask(V vector) : v(vector) {}
};

template <int N>
struct Wide {
    using V = typename VectorTypes<N>::Float;
    V v;
    Wide() = default;
    SHARED_FN Wide(float s) : v(V{} + s) {}
    SHARED_FN explicit Wide(V vector) : v(vector) {}
    SHARED_FN explicit Wide(WideInt<N> i) : v(__builtin_convertvector(i.v, V)) {}
    SHARED_FN explicit Wide(WideUInt<N> u) : v(__builtin_convertvector(u.v, V)) {}
};

// ------------------------------------------------------------------------------------------------------- the traits

template <class F> struct Traits;
template <> struct Traits<float> {
    static constexpr int kLanes = 1;
    using Mask = bool;
    using Int = int;
    using UInt = unsigned;
};
template <int N> struct Traits<Wide<N>> {
    static constexpr int kLanes = N;
    using Mask = WideMask<N>;
    using Int = WideInt<N>;
    using UInt = WideUInt<N>;
};
template <class F> inline constexpr int kLanes = Traits<F>::kLanes;
template <class F> using Mask = typename Traits<F>::Mask;
template <class F> using Int = typename Traits<F>::Int;
template <class F> using UInt = typename Traits<F>::UInt;

// ------------------------------------------------------------------------------------------------------- arithmetic

template <int N> SHARED_FN Wide<N> operator+(Wide<N> a, Wide<N> b) { return Wide<N>(a.v + b.v); }
template <int N> SHARED_FN Wide<N> operator-(Wide<N> a, Wide<N> b) { return Wide<N>(a.v - b.v); }
template <int N> SHARED_FN Wide<N> operator*(Wide<N> a, Wide<N> b) { return Wide<N>(a.v * b.v); }
template <int N> SHARED_FN Wide<N> operator/(Wide<N> a, Wide<N> b) { return Wide<N>(a.v / b.v); }
template <int N> SHARED_FN Wide<N> operator+(Wide<N> a, float b) { return a + Wide<N>(b); }
template <int N> SHARED_FN Wide<N> operator-(Wide<N> a, float b) { return a - Wide<N>(b); }
template <int N> SHARED_FN Wide<N> operator*(Wide<N> a, float b) { return a * Wide<N>(b); }
template <int N> SHARED_FN Wide<N> operator/(Wide<N> a, float b) { return a / Wide<N>(b); }
template <int N> SHARED_FN Wide<N> operator+(float a, Wide<N> b) { return Wide<N>(a) + b; }
template <int N> SHARED_FN Wide<N> operator-(float a, Wide<N> b) { return Wide<N>(a) - b; }
template <int N> SHARED_FN Wide<N> operator*(float a, Wide<N> b) { return Wide<N>(a) * b; }
template <int N> SHARED_FN Wide<N> operator/(float a, Wide<N> b) { return Wide<N>(a) / b; }
template <int N> SHARED_FN Wide<N> operator-(Wide<N> a) { return Wide<N>(-a.v); }
template <int N> SHARED_FN Wide<N>& operator+=(Wide<N>& a, Wide<N> b) { return a = a + b; }
template <int N> SHARED_FN Wide<N>& operator*=(Wide<N>& a, Wide<N> b) { return a = a * b; }

template <int N> SHARED_FN WideMask<N> operator<(Wide<N> a, Wide<N> b) { return WideMask<N>(a.v < b.v); }
template <int N> SHARED_FN WideMask<N> operator>(Wide<N> a, Wide<N> b) { return WideMask<N>(a.v > b.v); }
template <int N> SHARED_FN WideMask<N> operator<=(Wide<N> a, Wide<N> b) { return WideMask<N>(a.v <= b.v); }
template <int N> SHARED_FN WideMask<N> operator>=(Wide<N> a, Wide<N> b) { return WideMask<N>(a.v >= b.v); }
template <int N> SHARED_FN WideMask<N> operator==(Wide<N> a, Wide<N> b) { return WideMask<N>(a.v == b.v); }
template <int N> SHARED_FN WideMask<N> operator!=(Wide<N> a, Wide<N> b) { return WideMask<N>(a.v != b.v); }

#define KADR_WIDE_INTEGER(T)                                                                  \
    template <int N> SHARED_FN T<N> operator+(T<N> a, T<N> b) { return T<N>(a.v + b.v); }      \
    template <int N> SHARED_FN T<N> operator-(T<N> a, T<N> b) { return T<N>(a.v - b.v); }      \
    template <int N> SHARED_FN T<N> operator*(T<N> a, T<N> b) { return T<N>(a.v * b.v); }      \
    template <int N> SHARED_FN T<N> operator&(T<N> a, T<N> b) { return T<N>(a.v & b.v); }      \
    template <int N> SHARED_FN T<N> operator|(T<N> a, T<N> b) { return T<N>(a.v | b.v); }      \
    template <int N> SHARED_FN T<N> operator^(T<N> a, T<N> b) { return T<N>(a.v ^ b.v); }      \
    template <int N> SHARED_FN T<N> operator<<(T<N> a, int s) { return T<N>(a.v << s); }       \
    template <int N> SHARED_FN T<N> operator>>(T<N> a, int s) { return T<N>(a.v >> s); }       \
    template <int N> SHARED_FN WideMask<N> operator==(T<N> a, T<N> b) { return WideMask<N>((typename WideMask<N>::V)(a.v == b.v)); } \
    template <int N> SHARED_FN WideMask<N> operator!=(T<N> a, T<N> b) { return WideMask<N>((typename WideMask<N>::V)(a.v != b.v)); } \
    template <int N> SHARED_FN WideMask<N> operator<(T<N> a, T<N> b) { return WideMask<N>((typename WideMask<N>::V)(a.v < b.v)); }   \
    template <int N> SHARED_FN WideMask<N> operator>=(T<N> a, T<N> b) { return WideMask<N>((typename WideMask<N>::V)(a.v >= b.v)); }
KADR_WIDE_INTEGER(WideInt)
KADR_WIDE_INTEGER(WideUInt)
#undef KADR_WIDE_INTEGER

template <int N> SHARED_FN WideMask<N> operator&(WideMask<N> a, WideMask<N> b) { return WideMask<N>(a.v & b.v); }
template <int N> SHARED_FN WideMask<N> operator|(WideMask<N> a, WideMask<N> b) { return WideMask<N>(a.v | b.v); }
template <int N> SHARED_FN WideMask<N> operator!(WideMask<N> a) { return WideMask<N>(~a.v); }

// ---------------------------------------------------------------------------------------------- masks and selection

SHARED_FN bool any(bool m) { return m; }
SHARED_FN bool all(bool m) { return m; }
/// Bit i is lane i.
SHARED_FN unsigned bits(bool m) { return m ? 1u : 0u; }

template <int N>
SHARED_FN unsigned bits(WideMask<N> m) {
#if defined(__AVX__)
    if constexpr (N == 8) return static_cast<unsigned>(_mm256_movemask_ps((__m256)m.v));
#endif
    unsigned result = 0;
    for (int i = 0; i < N; ++i) result |= (m.v[i] ? 1u : 0u) << i;
    return result;
}
template <int N> SHARED_FN bool any(WideMask<N> m) { return bits(m) != 0; }
template <int N> SHARED_FN bool all(WideMask<N> m) { return bits(m) == (1u << N) - 1u; }

SHARED_FN float select(bool m, float a, float b) { return m ? a : b; }
SHARED_FN int select(bool m, int a, int b) { return m ? a : b; }
SHARED_FN unsigned select(bool m, unsigned a, unsigned b) { return m ? a : b; }
SHARED_FN bool select(bool m, bool a, bool b) { return m ? a : b; }
template <int N> SHARED_FN Wide<N> select(WideMask<N> m, Wide<N> a, Wide<N> b) { return Wide<N>(m.v ? a.v : b.v); }
template <int N> SHARED_FN Wide<N> select(WideMask<N> m, Wide<N> a, float b) { return select(m, a, Wide<N>(b)); }
template <int N> SHARED_FN Wide<N> select(WideMask<N> m, float a, Wide<N> b) { return select(m, Wide<N>(a), b); }
template <int N> SHARED_FN WideInt<N> select(WideMask<N> m, WideInt<N> a, WideInt<N> b) { return WideInt<N>(m.v ? a.v : b.v); }
template <int N> SHARED_FN WideUInt<N> select(WideMask<N> m, WideUInt<N> a, WideUInt<N> b) { return WideUInt<N>(m.v ? a.v : b.v); }
template <int N> SHARED_FN WideMask<N> select(WideMask<N> m, WideMask<N> a, WideMask<N> b) { return WideMask<N>((m.v & a.v) | (~m.v & b.v)); }
template <class F> SHARED_FN Vec3<F> select(Mask<F> m, Vec3<F> a, Vec3<F> b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

// ------------------------------------------------------------------------------------------------- lane by lane

SHARED_FN float lane(float a, int) { return a; }
SHARED_FN int lane(int a, int) { return a; }
SHARED_FN unsigned lane(unsigned a, int) { return a; }
SHARED_FN bool lane(bool a, int) { return a; }
SHARED_FN void set_lane(float& a, int, float x) { a = x; }
SHARED_FN void set_lane(int& a, int, int x) { a = x; }
SHARED_FN void set_lane(unsigned& a, int, unsigned x) { a = x; }
SHARED_FN void set_lane(bool& a, int, bool x) { a = x; }
template <int N> SHARED_FN float lane(const Wide<N>& a, int i) { return a.v[i]; }
template <int N> SHARED_FN int lane(const WideInt<N>& a, int i) { return a.v[i]; }
template <int N> SHARED_FN unsigned lane(const WideUInt<N>& a, int i) { return a.v[i]; }
template <int N> SHARED_FN bool lane(const WideMask<N>& a, int i) { return a.v[i] != 0; }
template <int N> SHARED_FN void set_lane(Wide<N>& a, int i, float x) { a.v[i] = x; }
template <int N> SHARED_FN void set_lane(WideInt<N>& a, int i, int x) { a.v[i] = x; }
template <int N> SHARED_FN void set_lane(WideUInt<N>& a, int i, unsigned x) { a.v[i] = x; }
template <int N> SHARED_FN void set_lane(WideMask<N>& a, int i, bool x) { a.v[i] = x ? -1 : 0; }

/// kLanes<F> consecutive values. The address is aligned to their size (4 * lanes bytes).
template <class F> struct Memory {
    SHARED_FN static F load(const float* p) { return *reinterpret_cast<const F*>(p); }
    SHARED_FN static void store(float* p, F x) { *reinterpret_cast<F*>(p) = x; }
};

/// Eight values from each of kLanes<F> places: out[k] of lane i is rows[i][k].
template <class F>
SHARED_FN void load_rows(const float* const* rows, F* out) {
#if defined(__AVX__) && !defined(__CUDACC__) && !defined(__HIPCC__)
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
        for (int i = 0; i < kLanes<F>; ++i) set_lane(out[k], i, rows[i][k]);
}

// ------------------------------------------------------------------------------------------------------ functions

SHARED_FN float min(float a, float b) { return a < b ? a : b; }  // b where either is NaN, as the vector instruction
SHARED_FN float max(float a, float b) { return a > b ? a : b; }
SHARED_FN float sqrt(float a) { return __builtin_sqrtf(a); }
SHARED_FN float floor(float a) { return __builtin_floorf(a); }
SHARED_FN float abs(float a) { return __builtin_fabsf(a); }
SHARED_FN int truncate(float a) { return static_cast<int>(a); }
SHARED_FN unsigned as_uint(float a) { unsigned u; __builtin_memcpy(&u, &a, 4); return u; }
SHARED_FN float as_float(unsigned u) { float a; __builtin_memcpy(&a, &u, 4); return a; }

template <int N> SHARED_FN Wide<N> min(Wide<N> a, Wide<N> b) {
#if defined(__AVX__)
    if constexpr (N == 8) return Wide<N>((typename Wide<N>::V)_mm256_min_ps((__m256)a.v, (__m256)b.v));
#endif
    return Wide<N>(a.v < b.v ? a.v : b.v);
}
template <int N> SHARED_FN Wide<N> max(Wide<N> a, Wide<N> b) {
#if defined(__AVX__)
    if constexpr (N == 8) return Wide<N>((typename Wide<N>::V)_mm256_max_ps((__m256)a.v, (__m256)b.v));
#endif
    return Wide<N>(a.v > b.v ? a.v : b.v);
}
template <int N> SHARED_FN Wide<N> min(Wide<N> a, float b) { return min(a, Wide<N>(b)); }
template <int N> SHARED_FN Wide<N> max(Wide<N> a, float b) { return max(a, Wide<N>(b)); }
template <int N> SHARED_FN Wide<N> sqrt(Wide<N> a) {
#if defined(__AVX__)
    if constexpr (N == 8) return Wide<N>((typename Wide<N>::V)_mm256_sqrt_ps((__m256)a.v));
#endif
    Wide<N> r;
    for (int i = 0; i < N; ++i) r.v[i] = __builtin_sqrtf(a.v[i]);
    return r;
}
template <int N> SHARED_FN Wide<N> floor(Wide<N> a) {
#if defined(__AVX__)
    if constexpr (N == 8) return Wide<N>((typename Wide<N>::V)_mm256_floor_ps((__m256)a.v));
#endif
    Wide<N> r;
    for (int i = 0; i < N; ++i) r.v[i] = __builtin_floorf(a.v[i]);
    return r;
}
template <int N> SHARED_FN Wide<N> abs(Wide<N> a) {
    return Wide<N>((typename Wide<N>::V)((typename WideInt<N>::V)a.v & 0x7fffffff));
}
template <int N> SHARED_FN WideInt<N> truncate(Wide<N> a) { return WideInt<N>(__builtin_convertvector(a.v, typename WideInt<N>::V)); }
template <int N> SHARED_FN WideUInt<N> as_uint(Wide<N> a) { return WideUInt<N>((typename WideUInt<N>::V)a.v); }
template <int N> SHARED_FN Wide<N> as_float(WideUInt<N> a) { return Wide<N>((typename Wide<N>::V)a.v); }

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
template <class F> SHARED_FN Vec3<F> splat(Vec3f a) { return {F(a.x), F(a.y), F(a.z)}; }

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
