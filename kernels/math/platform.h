// What differs between the host's compiler and a GPU's: how a shared function and a table are declared, and the few
// operations that have other names there.
#pragma once

/// 1 where a GPU's compiler reads the source: nvcc, hipcc or one of their run-time compilers, which know no system
/// header.
#if defined(__CUDACC__) || defined(__HIPCC__) || defined(__CUDACC_RTC__) || defined(__HIPCC_RTC__)
#define KADR_DEVICE_CODE 1
#else
#define KADR_DEVICE_CODE 0
#endif

#if KADR_DEVICE_CODE
#define SHARED_FN __host__ __device__ inline
/// Constant tables that are indexed at run time. In global memory: lanes read different entries, which constant memory
/// would serve one after another.
#define SHARED_TABLE static __device__ const
#else
/// Functions that both the host and a GPU's run-time compiler build.
#define SHARED_FN inline __attribute__((always_inline))
/// Constant tables that are indexed at run time.
#define SHARED_TABLE inline constexpr
#endif

namespace kadr::kernels {

#if KADR_DEVICE_CODE
SHARED_FN float sqrt(float a) { return ::sqrtf(a); }
SHARED_FN float floor(float a) { return ::floorf(a); }
SHARED_FN float abs(float a) { return ::fabsf(a); }
__device__ inline unsigned as_uint(float a) { return __float_as_uint(a); }
__device__ inline float as_float(unsigned u) { return __uint_as_float(u); }
/// Index of the lowest bit that is set; u != 0.
__device__ inline int lowest_bit(unsigned u) { return __ffs(static_cast<int>(u)) - 1; }
#else
SHARED_FN float sqrt(float a) { return __builtin_sqrtf(a); }
SHARED_FN float floor(float a) { return __builtin_floorf(a); }
SHARED_FN float abs(float a) { return __builtin_fabsf(a); }
SHARED_FN unsigned as_uint(float a) {
    unsigned u;
    __builtin_memcpy(&u, &a, 4);
    return u;
}
SHARED_FN float as_float(unsigned u) {
    float a;
    __builtin_memcpy(&a, &u, 4);
    return a;
}
/// Index of the lowest bit that is set; u != 0.
SHARED_FN int lowest_bit(unsigned u) { return __builtin_ctz(u); }
#endif

}  // namespace kadr::kernels
