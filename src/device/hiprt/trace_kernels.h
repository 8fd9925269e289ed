#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "device/hiprt/hiprt_handles.h"
#include "kernels/gpu/entry_points.h"

namespace kadr {

/// Which kernel a frame needs.
struct KernelNeed {
    kernels::Kernel kernel = kernels::Kernel::path;
    unsigned requirements = 0;  ///< set of kernels::requirement bits: exactly these are compiled
    bool functions = false;     ///< rays ask our functions about some geometry
    bool operator==(const KernelNeed&) const = default;
    /// Whether a kernel for this renders what needs `other`: then both leave the same pixels.
    bool covers(const KernelNeed& other) const {
        return kernel == other.kernel && (other.requirements & ~requirements) == 0 && (functions || !other.functions);
    }
};

/// What HIPRT is given to compile a kernel.
struct KernelSource {
    std::string text, module, function;
    std::vector<std::string> options;
};

/// Of all files of kernels/: their paths and what they hold. @param folder  holds kernels/
std::string hash_of_kernels(const std::filesystem::path& folder);

struct TraceKernel {
    hiprt::Function function = nullptr;
    KernelNeed compiled_for;
};

/// Kernels, compiled by HIPRT from our sources on the user's machine, in threads of their own: it takes up to a minute. HIPRT
/// keeps what it compiled in its cache folder and, by the module's name alone, in memory: so the name holds a hash of all
/// our sources and options.
///
/// HIPRT 3.1 may compile beside other calls on its context: what its compiler holds is behind mutexes (Compiler.cpp,
/// m_moduleMutex through a whole compilation, m_kernelMutex), and it makes the context current in every call. The first
/// build of a structure waits for the same mutex, where nobody could cancel it or say what is going on; so structures are
/// not built before wait() has returned.
///
/// Nothing ends a compilation. Who destroys this does not wait for it: the thread keeps the context that it uses.
class TraceKernels {
public:
    /// Called now and then by the thread that waits, with the seconds since the compilation began; may throw.
    using Waiting = std::function<void(double seconds)>;

    /// @param folder  holds kernels/
    TraceKernels(std::shared_ptr<HiprtContext> context, std::filesystem::path folder) : context_(std::move(context)), folder_(std::move(folder)) {}

    /// Begins to compile, unless what covers it is compiled or on its way.
    void begin(const KernelNeed& need);
    /// Waits until nothing is being compiled. @throws what `waiting` throws
    void wait(const Waiting& waiting) const;
    bool is_compiling() const;
    /// A kernel that covers the need. Begins to compile it, and waits for it, as far as that has not been done.
    /// @throws RenderError  when it does not compile; HIPRT has printed why
    TraceKernel get(const KernelNeed& need, const Waiting& waiting = {});
    /// What is handed to HIPRT.
    KernelSource source_of(const KernelNeed& need);

private:
    struct Compilation;
    std::shared_ptr<Compilation> find(const KernelNeed& need) const;
    static void compile(HiprtContext& context, Compilation& compilation);
    static void wait_for(const Compilation& compilation, const Waiting& waiting);

    std::shared_ptr<HiprtContext> context_;
    std::filesystem::path folder_;
    std::string hash_;  ///< of all files of kernels/; empty: not read yet
    std::vector<std::shared_ptr<Compilation>> compilations_;
};

}  // namespace kadr
