// Which kernel renders what: the host's table of entry points. Holds no device code.
#pragma once

#include "kernels/deform/bend.h"
#include "kernels/gpu/launch_params.h"
#include "kernels/gpu/probe.h"

namespace kadr::kernels {

/// What is compiled for a GPU: the integrators, single rays, and what makes the vertices and boxes of meshes that bend.
enum class Kernel : unsigned char { direct, path, probe, bend, boxes };

constexpr Kernel kernel_of(IntegratorKind integrator) {
    return integrator == IntegratorKind::direct ? Kernel::direct : Kernel::path;
}

/// A kernel as the run-time compiler is asked for it: the source text is
///
///     #define KADR_REQUIREMENTS <set of requirement:: bits>u
///     #include "<header>"
///
/// with the folder that holds kernels/ among the include folders.
struct EntryPoint {
    const char* name;         ///< of the extern "C" kernel
    const char* header;       ///< of its source
    unsigned argument_bytes;  ///< of its one argument
};

/// [Kernel]
inline constexpr EntryPoint kEntryPoints[] = {
    {"kadr_direct", "kernels/gpu/direct_entry.h", sizeof(LaunchParams)},
    {"kadr_path", "kernels/gpu/path_entry.h", sizeof(LaunchParams)},
    {"kadr_probe", "kernels/gpu/probe_entry.h", sizeof(ProbeParams)},
    {"kadr_bend", "kernels/gpu/bend_entry.h", sizeof(BendParams)},
    {"kadr_boxes", "kernels/gpu/boxes_entry.h", sizeof(BoxParams)},
};

constexpr const EntryPoint& entry_point(Kernel kernel) { return kEntryPoints[static_cast<unsigned>(kernel)]; }

/// The set to compile a kernel for, of what a scene requires: all of it, but for `direct`, which has a constant
/// background, meets no lights and has no narrower lobes than kMinAlpha, and for single rays, which want to know where
/// surfaces are. What traces no rays has one form.
constexpr unsigned kernel_requirements(Kernel kernel, unsigned required) {
    if (kernel == Kernel::bend || kernel == Kernel::boxes) return 0;
    if (kernel == Kernel::probe) return required & (requirement::kTransforms | requirement::kDeformation);
    return kernel == Kernel::direct ? required & ~(requirement::kEmitters | requirement::kMirrors) : required;
}
constexpr unsigned kernel_requirements(IntegratorKind integrator, unsigned required) {
    return kernel_requirements(kernel_of(integrator), required);
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
