#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "device/hiprt/hiprt_handles.h"
#include "kernels/gpu/entry_points.h"

namespace kadr {

/// Which kernel a frame needs.
struct KernelNeed {
    kernels::Kernel kernel = kernels::Kernel::path;
    unsigned requirements = 0;  ///< set of kernels::requirement bits: exactly these are compiled
    bool functions = false;     ///< rays ask our functions about some geometry
    auto operator<=>(const KernelNeed&) const = default;
};

/// What HIPRT is given to compile a kernel.
struct KernelSource {
    std::string text, module, function;
    std::vector<std::string> options;
};

/// Of all files of kernels/: their paths and what they hold. @param folder  holds kernels/
std::string hash_of_kernels(const std::filesystem::path& folder);

/// Kernels, compiled by HIPRT when first needed, from our sources on the user's machine. HIPRT keeps what it compiled
/// in its cache folder and, by the module's name alone, in memory: so the name holds a hash of all our sources and
/// options.
class TraceKernels {
public:
    /// @param folder  holds kernels/
    TraceKernels(HiprtContext& context, std::filesystem::path folder) : context_(context), folder_(std::move(folder)) {}

    /// @throws RenderError  when it does not compile; HIPRT has printed why
    hiprt::Function get(const KernelNeed& need);
    /// What get() hands to HIPRT.
    KernelSource source_of(const KernelNeed& need);

private:
    HiprtContext& context_;
    std::filesystem::path folder_;
    std::string hash_;  ///< of all files of kernels/; empty: not read yet
    std::map<KernelNeed, hiprt::Function> compiled_;
};

}  // namespace kadr
