// Several lanes by compiler vector extensions: the processor's form of F. A GPU's compiler never reads this file.
#pragma once

#include "kernels/math/scalar.h"

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace kadr::kernels {

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

template <int N> struct Traits<Wide<N>> {
    static constexpr int kLanes = N;
    using Real = float;
    using Mask = WideMask<N>;
    using Int = WideInt<N>;
    using UInt = WideUInt<N>;
};

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
template <int N> SHARED_FN Wide<N> select(WideMask<N> m, Wide<N> a, Wide<N> b) { return Wide<N>(m.v ? a.v : b.v); }
template <int N> SHARED_FN Wide<N> select(WideMask<N> m, Wide<N> a, float b) { return select(m, a, Wide<N>(b)); }
template <int N> SHARED_FN Wide<N> select(WideMask<N> m, float a, Wide<N> b) { return select(m, Wide<N>(a), b); }
template <int N> SHARED_FN WideInt<N> select(WideMask<N> m, WideInt<N> a, WideInt<N> b) { return WideInt<N>(m.v ? a.v : b.v); }
template <int N> SHARED_FN WideUInt<N> select(WideMask<N> m, WideUInt<N> a, WideUInt<N> b) { return WideUInt<N>(m.v ? a.v : b.v); }
template <int N> SHARED_FN WideMask<N> select(WideMask<N> m, WideMask<N> a, WideMask<N> b) { return WideMask<N>((m.v & a.v) | (~m.v & b.v)); }

// ------------------------------------------------------------------------------------------------- lane by lane

template <int N> SHARED_FN float lane(const Wide<N>& a, int i) { return a.v[i]; }
template <int N> SHARED_FN int lane(const WideInt<N>& a, int i) { return a.v[i]; }
template <int N> SHARED_FN unsigned lane(const WideUInt<N>& a, int i) { return a.v[i]; }
template <int N> SHARED_FN bool lane(const WideMask<N>& a, int i) { return a.v[i] != 0; }
template <int N> SHARED_FN void set_lane(Wide<N>& a, int i, float x) { a.v[i] = x; }
template <int N> SHARED_FN void set_lane(WideInt<N>& a, int i, int x) { a.v[i] = x; }
template <int N> SHARED_FN void set_lane(WideUInt<N>& a, int i, unsigned x) { a.v[i] = x; }
template <int N> SHARED_FN void set_lane(WideMask<N>& a, int i, bool x) { a.v[i] = x ? -1 : 0; }

// ------------------------------------------------------------------------------------------------------ functions

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

}  // namespace kadr::kernels
