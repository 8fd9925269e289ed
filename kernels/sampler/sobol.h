// Random numbers: a function of (pixel, sample, dimension, seed) alone.
//
// Padded pairs of the first two Sobol dimensions: each pair shuffles the order of the points and scrambles both
// coordinates by hashing, with seeds of its own.
// Sources: Burley 2020, "Practical Hash-based Owen Scrambling" (JCGT 9-4); Vegdahl 2021, "Building a Better LK Hash".
#pragma once

#include "kernels/math/wide.h"

namespace kadr::kernels {

/// Bit i becomes bit 31 - i.
SHARED_FN unsigned reverse_bits(unsigned x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

#if !KADR_DEVICE_CODE
template <int N>
SHARED_FN WideUInt<N> reverse_bits(WideUInt<N> x) {
    using U = WideUInt<N>;
#if defined(__AVX2__)
    if constexpr (N == 8) {  // nibbles by table, then the bytes of each lane
        const __m256i low_to_high = _mm256_broadcastsi128_si256(
            _mm_setr_epi8(0, -128, 64, -64, 32, -96, 96, -32, 16, -112, 80, -48, 48, -80, 112, -16));
        const __m256i high_to_low =
            _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
        const __m256i swap_bytes =
            _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
        const __m256i nibble = _mm256_set1_epi8(15);
        const __m256i v = (__m256i)x.v;
        const __m256i low = _mm256_shuffle_epi8(low_to_high, _mm256_and_si256(v, nibble));
        const __m256i high = _mm256_shuffle_epi8(high_to_low, _mm256_and_si256(_mm256_srli_epi32(v, 4), nibble));
        return U((typename U::V)_mm256_shuffle_epi8(_mm256_or_si256(low, high), swap_bytes));
    }
#endif
    x = ((x >> 1) & U(0x55555555u)) | ((x & U(0x55555555u)) << 1);
    x = ((x >> 2) & U(0x33333333u)) | ((x & U(0x33333333u)) << 2);
    x = ((x >> 4) & U(0x0f0f0f0fu)) | ((x & U(0x0f0f0f0fu)) << 4);
    x = ((x >> 8) & U(0x00ff00ffu)) | ((x & U(0x00ff00ffu)) << 8);
    return (x >> 16) | (x << 16);
}
#endif

/// A well-mixed permutation of 32 bits.  Source: Wellons 2018, "lowbias32".
template <class U>
SHARED_FN U mix_bits(U x) {
    x = x ^ (x >> 16);
    x = x * U(0x7feb352du);
    x = x ^ (x >> 15);
    x = x * U(0x846ca68bu);
    return x ^ (x >> 16);
}

/// A random permutation whose every bit depends on lower bits only: an Owen scramble of bit-reversed numbers.
template <class U>
SHARED_FN U laine_karras(U x, U seed) {
    x = x ^ (x * U(0x3d20adeau));
    x = x + seed;
    x = x * ((seed >> 16) | U(1u));
    x = x ^ (x * U(0x05526c56u));
    return x ^ (x * U(0x53a22864u));
}

/// Second Sobol dimension of an index, bit-reversed: the Pascal matrix modulo 2, a Kronecker power of [1 1; 0 1],
/// so one masked shift a factor.
template <class U>
SHARED_FN U pascal(U x) {
    x = x ^ ((x >> 1) & U(0x55555555u));
    x = x ^ ((x >> 2) & U(0x33333333u));
    x = x ^ ((x >> 4) & U(0x0f0f0f0fu));
    x = x ^ ((x >> 8) & U(0x00ff00ffu));
    return x ^ ((x >> 16) & U(0x0000ffffu));
}

/// The upper 24 bits as a number in [0, kOneMinusEpsilon], exact.
template <class F>
SHARED_FN F to_unit_interval(UInt<F> bits32) {
    return F(Int<F>(bits32 >> 8)) * F(1.0f / 16777216.0f);
}

/// The numbers of one sample of one pixel.
template <class F>
struct Sampler {
    UInt<F> key;    ///< hash of pixel and seed
    UInt<F> index;  ///< sample of the pixel, from 0

    /// A point of the unit square [0, 1)^2. Different dimensions are independent of each other.
    SHARED_FN Vec2<F> get_2d(UInt<F> dimension) const {
        UInt<F> seed, shuffled;
        shuffle(dimension, seed, shuffled);
        const UInt<F> x = reverse_bits(laine_karras(shuffled, mix_bits(seed ^ UInt<F>(0xe11f1d2bu))));
        const UInt<F> y = reverse_bits(laine_karras(pascal(shuffled), mix_bits(seed ^ UInt<F>(0x5bd1e995u))));
        return {to_unit_interval<F>(x), to_unit_interval<F>(y)};
    }

    /// get_2d(dimension).x, for less work.
    SHARED_FN F get_1d(UInt<F> dimension) const {
        UInt<F> seed, shuffled;
        shuffle(dimension, seed, shuffled);
        return to_unit_interval<F>(reverse_bits(laine_karras(shuffled, mix_bits(seed ^ UInt<F>(0xe11f1d2bu)))));
    }

private:
    SHARED_FN void shuffle(UInt<F> dimension, UInt<F>& seed, UInt<F>& shuffled) const {
        seed = mix_bits(key + dimension * UInt<F>(0x9e3779b9u));
        shuffled = reverse_bits(laine_karras(reverse_bits(index), seed));
    }
};

/// The seed of one half of a film's samples: the same numbers as ever for the first, independent ones for the second.
SHARED_FN unsigned seed_of_half(unsigned seed, int half) {
    return half == 0 ? seed : mix_bits(seed ^ 0x68e31da4u);
}

/// @param sample  index of the sample in its pixel; consecutive ones fill the square evenly
template <class F>
SHARED_FN Sampler<F> make_sampler(Int<F> x, Int<F> y, UInt<F> sample, unsigned seed) {
    const UInt<F> row = mix_bits(UInt<F>(mix_bits(seed ^ 0x2545f491u)) + UInt<F>(y));
    return {mix_bits(row + UInt<F>(x)), sample};
}

}  // namespace kadr::kernels
