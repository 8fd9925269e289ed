// What the entry points share: the thread's pixel, the tracer, the counters.
#pragma once

#ifndef KADR_REQUIREMENTS
#error "KADR_REQUIREMENTS is not defined; expected the set of requirement:: bits that the kernel is compiled for"
#endif

#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 700
#error "compiled for an NVIDIA architecture before 7.0, which has no __grid_constant__; pass kCudaOptions"
#endif

#include <hiprt/hiprt_device.h>

#include "kernels/gpu/hiprt_tracer.h"
#include "kernels/gpu/render_pixel.h"

/// A kernel's argument that threads may point into without each copying it first.
#if defined(__CUDACC__)
#define KADR_KERNEL_ARGUMENT const __grid_constant__
#else
#define KADR_KERNEL_ARGUMENT const
#endif

// The functions of kGeometryFunctions. A set without moving meshes has no scene that asks for theirs.
__device__ bool kadr_alpha_filter(const hiprtRay& ray, const void*, void* payload, const hiprtHit& hit) {
    return kadr::kernels::passes(ray, *static_cast<kadr::kernels::RayPayload*>(payload), hit);
}

__device__ bool kadr_moving_triangle(const hiprtRay& ray, const void*, void* payload, hiprtHit& hit) {
    if constexpr ((KADR_REQUIREMENTS & kadr::kernels::requirement::kDeformation) == 0) return false;
    return kadr::kernels::meets_moving(ray, *static_cast<const kadr::kernels::RayPayload*>(payload), hit);
}

namespace kadr::kernels {

__device__ inline void add_counters(LaunchCounters& sums, const LaunchCounters& mine) {
    atomicAdd(&sums.rays, mine.rays);
    atomicAdd(&sums.samples, mine.samples);
    if (mine.dropped) atomicAdd(&sums.dropped, mine.dropped);
    if (mine.stack_overflows) atomicAdd(&sums.stack_overflows, mine.stack_overflows);
}

/// Renders the thread's pixel.
template <unsigned R, IntegratorKind kIntegrator>
__device__ inline void render_thread(const LaunchParams& params) {
    const int x = params.x0 + static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    const int y = params.y0 + static_cast<int>(blockIdx.y * blockDim.y + threadIdx.y);
    if (!is_wanted(params, x, y)) return;
    LaunchCounters counters{};
    HiprtTracer tracer(params, kIntegrator == IntegratorKind::direct, counters);
    PixelDriver<float, R, kIntegrator, HiprtTracer>(params, tracer, x, y).render(counters);
    add_counters(*params.counters, counters);
}

}  // namespace kadr::kernels
