// Which kernel renders what: the host's table of entry points. Holds no device code.
#pragma once

#include "kernels/gpu/launch_params.h"

namespace kadr::kernels {

/// A kernel as the run-time compiler is asked for it: the source text is
///
///     #define KADR_REQUIREMENTS <set of requirement:: bits>u
///     #include "<header>"
///
/// with the folder that holds kernels/ among the include folders.
struct EntryPoint {
    const char* name;    ///< of the extern "C" kernel; its one argument is a LaunchParams
    const char* header;  ///< of its source
};

constexpr EntryPoint entry_point(IntegratorKind integrator) {
    return integrator == IntegratorKind::direct ? EntryPoint{"kadr_direct", "kernels/gpu/direct_entry.h"}
                                                : EntryPoint{"kadr_path", "kernels/gpu/path_entry.h"};
}

/// The set to compile a kernel for, of what a scene requires: all of it, but for `direct`, which has a constant
/// background, meets no lights and has no narrower lobes than kMinAlpha.
constexpr unsigned kernel_requirements(IntegratorKind integrator, unsigned required) {
    return integrator == IntegratorKind::direct ? required & ~(requirement::kEmitters | requirement::kMirrors) : required;
}

/// The functions that rays ask about geometry of a type, by name as in hiprtFuncNameSet; null: none.
struct GeometryFunctions {
    const char* intersect;
    const char* filter;
};

/// [geometry_type], for the one type of rays.
inline constexpr GeometryFunctions kGeometryFunctions[geometry_type::kCount] = {
    {nullptr, "kadr_alpha_filter"},                 // kFiltered
    {"kadr_moving_triangle", "kadr_alpha_filter"},  // kMoving
};

/// What both run-time compilers are told beside C++17 and the include folders: the processor's arithmetic is neither
/// fused nor does it keep denormals. HIPRT names no architecture: hiprtc takes that of the GPU, NVRTC one that is too
/// old for us (5.2, before version 13); what is compiled for 7.5 runs on every later one.
inline constexpr const char* kCudaOptions[] = {"--gpu-architecture=compute_75", "--fmad=false", "--ftz=true"};
inline constexpr const char* kHipOptions[] = {"-ffp-contract=off", "-fgpu-flush-denormals-to-zero"};

}  // namespace kadr::kernels
