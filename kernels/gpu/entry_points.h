// Which kernel renders what: the host's table of entry points. Holds no device code.
#pragma once

#include "kernels/scene/scene_types.h"

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

/// Decides whether a ray stops at a hit on geometry of type geometry_type::kFiltered: hiprtFuncNameSet::filterFuncName of
/// that type (one ray type).
inline constexpr const char* kFilterFunction = "kadr_alpha_filter";

/// What both run-time compilers are told beside C++17 and the include folders: the processor's arithmetic is neither
/// fused nor does it keep denormals.
inline constexpr const char* kCudaOptions[] = {"--fmad=false", "--ftz=true"};
inline constexpr const char* kHipOptions[] = {"-ffp-contract=off", "-fgpu-flush-denormals-to-zero"};

}  // namespace kadr::kernels
