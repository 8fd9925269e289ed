// Table look-ups with an index per lane.
#pragma once

#include "kernels/math/wide.h"

namespace kadr::kernels {

/// table[index] of every lane. All indices must be inside the table, those of idle lanes too.
SHARED_FN float gather(const float* table, int index) { return table[index]; }
SHARED_FN double gather(const double* table, int index) { return table[index]; }

#if !KADR_DEVICE_CODE
template <int N>
SHARED_FN Wide<N> gather(const float* table, WideInt<N> index) {
#if defined(__AVX2__)
    if constexpr (N == 8) return Wide<N>((typename Wide<N>::V)_mm256_i32gather_ps(table, (__m256i)index.v, 4));
#endif
    Wide<N> result;
    for (int i = 0; i < N; ++i) result.v[i] = table[index.v[i]];
    return result;
}
#endif

/// Three consecutive numbers from table[index].
template <class F, class T>
SHARED_FN Vec3<F> gather_vec3(const T* table, Int<F> index) {
    return {gather(table, index), gather(table + 1, index), gather(table + 2, index)};
}

/// Bilinear look-up in rows of `width` entries: `at` is the lower left entry, fx and fy the place between entries.
template <class F>
SHARED_FN F table_bilinear(const float* table, int width, Int<F> at, F fx, F fy) {
    const F low = lerp<F>(gather(table, at), gather(table + 1, at), fx);
    const F high = lerp<F>(gather(table + width, at), gather(table + width + 1, at), fx);
    return lerp(low, high, fy);
}

/// i limited to [low, high] (wide.h has min and max for floats only).
template <class F>
SHARED_FN Int<F> clamp_index(Int<F> i, int low, int high) {
    const Int<F> raised = select(Mask<F>(i < Int<F>(low)), Int<F>(low), i);
    return select(Mask<F>(raised < Int<F>(high)), raised, Int<F>(high));
}

/// The last entry i of table[first .. first + count) with table[i] <= x, for a table that rises from table[first] <= x.
/// Halving without branches: lanes share the number of steps.
template <class F>
SHARED_FN Int<F> find_interval(const float* table, Int<F> first, int count, F x) {
    Int<F> low = first;
    while (count > 1) {
        const int half = count / 2;
        const Int<F> middle = low + Int<F>(half);
        low = select(Mask<F>(gather(table, middle) <= x), middle, low);
        count -= half;
    }
    return low;
}

}  // namespace kadr::kernels
