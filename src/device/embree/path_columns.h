#pragma once

// Queues of the CPU's driver: paths, hits and shadow rays as structures of arrays, filled by compressing lanes.

#include "kernels/integrator/path.h"

// As in tile_driver.h: compiled once per instruction set, in a namespace of its own.
namespace kadr::KADR_DRIVER_NAMESPACE {

using namespace kernels;

/// Structure of arrays with room for a packet beyond the end.
template <int kFields, int kCapacity>
struct alignas(64) Columns {
    float data[kFields][kCapacity + 16];
    int count = 0;
};

template <class F>
inline F load(const float* p) {
    F x;
    __builtin_memcpy(&x, p, sizeof(F));
    return x;
}
template <class F>
inline void store(float* p, F x) {
    __builtin_memcpy(p, &x, sizeof(F));
}

#if defined(__AVX2__)
/// For every mask of eight bits, the lanes that are set, in order.
struct CompressTable {
    alignas(32) int lanes[256][8];
    constexpr CompressTable() : lanes() {
        for (int mask = 0; mask < 256; ++mask) {
            int n = 0;
            for (int i = 0; i < 8; ++i)
                if (mask >> i & 1) lanes[mask][n++] = i;
            for (; n < 8; ++n) lanes[mask][n] = 0;
        }
    }
};
inline constexpr CompressTable kCompress{};
#endif

/// Writes the lanes of `mask` one after another.
template <class F>
inline void store_compressed(float* p, F x, unsigned mask) {
#if defined(__AVX2__)
    if constexpr (kernels::kLanes<F> == 8) {
        const __m256i order = _mm256_load_si256(reinterpret_cast<const __m256i*>(kCompress.lanes[mask]));
        _mm256_storeu_ps(p, _mm256_permutevar8x32_ps((__m256)x.v, order));
        return;
    }
#endif
    for (int i = 0; i < kernels::kLanes<F>; ++i)
        if (mask >> i & 1) *p++ = lane(x, i);
}

/// The columns of a path in flight, of a hit (a path and what it met) and of a shadow ray.
enum PathField {
    kOriginX,
    kOriginY,
    kOriginZ,
    kDirectionX,
    kDirectionY,
    kDirectionZ,
    kTime,
    kBetaX,
    kBetaY,
    kBetaZ,
    kPdf,
    kLightWeight,
    kKey,
    kSample,
    kBounces,
    kSlot,
    kPathFields
};
enum HitField { kInstance = kPathFields, kPrimitive, kU, kV, kDistance, kHitFields };
enum ShadowField {
    kShadowOriginX,
    kShadowOriginY,
    kShadowOriginZ,
    kShadowDirectionX,
    kShadowDirectionY,
    kShadowDirectionZ,
    kShadowDistance,
    kShadowTime,
    kShadowX,
    kShadowY,
    kShadowZ,
    kShadowKey,
    kShadowSlot,
    kShadowFields
};

template <class F, class C>
inline PathState<F> load_path(const C& c, int at, UInt<F>& slot) {
    const auto f = [&](int field) { return load<F>(c.data[field] + at); };
    const auto u = [&](int field) { return load<UInt<F>>(c.data[field] + at); };
    PathState<F> p;
    p.origin = {f(kOriginX), f(kOriginY), f(kOriginZ)};
    p.direction = {f(kDirectionX), f(kDirectionY), f(kDirectionZ)};
    p.time = f(kTime);
    p.beta = {f(kBetaX), f(kBetaY), f(kBetaZ)};
    p.bsdf_pdf = f(kPdf);
    p.light_weight = f(kLightWeight);
    p.sampler_key = u(kKey);
    p.sample = u(kSample);
    p.bounces = u(kBounces);
    slot = u(kSlot);
    return p;
}

template <class F, class C>
inline void append_path(C& c, const PathState<F>& p, UInt<F> slot, unsigned mask) {
    if (mask == 0) return;
    const auto f = [&](int field, F x) { store_compressed(c.data[field] + c.count, x, mask); };
    f(kOriginX, p.origin.x);
    f(kOriginY, p.origin.y);
    f(kOriginZ, p.origin.z);
    f(kDirectionX, p.direction.x);
    f(kDirectionY, p.direction.y);
    f(kDirectionZ, p.direction.z);
    f(kTime, p.time);
    f(kBetaX, p.beta.x);
    f(kBetaY, p.beta.y);
    f(kBetaZ, p.beta.z);
    f(kPdf, p.bsdf_pdf);
    f(kLightWeight, p.light_weight);
    f(kKey, as_float(p.sampler_key));
    f(kSample, as_float(p.sample));
    f(kBounces, as_float(p.bounces));
    f(kSlot, as_float(slot));
    c.count += __builtin_popcount(mask);
}

}  // namespace kadr::KADR_DRIVER_NAMESPACE
