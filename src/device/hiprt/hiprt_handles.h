#pragma once

// What HIPRT lends us, one move-only class a handle. Destructors wait for all work first, report on standard error and
// never throw.

#include <cstddef>
#include <filesystem>
#include <utility>
#include <vector>

#include "device/hiprt/gpu_memory.h"
#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/hiprt_abi.h"

namespace kadr {

/// HIPRT on one GPU. Used by one thread at a time; outlives everything made in it.
class HiprtContext {
public:
    /// @param cache  folder for compiled kernels; empty: HIPRT's own choice
    /// @throws RenderError  when HIPRT refuses, a library of another version among the reasons
    HiprtContext(const hiprt::Api& api, GpuRuntime& runtime, const std::filesystem::path& cache);
    HiprtContext(const HiprtContext&) = delete;
    HiprtContext& operator=(const HiprtContext&) = delete;
    ~HiprtContext();

    const hiprt::Api& api() const { return api_; }
    GpuRuntime& runtime() const { return runtime_; }
    hiprt::Context handle() const { return handle_; }

private:
    const hiprt::Api& api_;
    GpuRuntime& runtime_;
    hiprt::Context handle_ = nullptr;
};

/// The structure of a mesh.
class HiprtGeometry {
public:
    HiprtGeometry() = default;
    /// Takes over what HIPRT made.
    HiprtGeometry(HiprtContext& context, GpuMemory& memory, hiprt::Geometry handle)
        : context_(&context), memory_(&memory), handle_(handle) {}
    HiprtGeometry(HiprtGeometry&& other) noexcept { *this = std::move(other); }
    HiprtGeometry& operator=(HiprtGeometry&& other) noexcept;
    ~HiprtGeometry();

    hiprt::Geometry handle() const { return handle_; }
    void note_bytes(std::size_t bytes);  ///< that it takes, for the ledger
    std::size_t bytes() const { return bytes_; }
    void replace(hiprt::Geometry handle) { handle_ = handle; }  ///< HIPRT has destroyed the one before

private:
    HiprtContext* context_ = nullptr;
    GpuMemory* memory_ = nullptr;
    hiprt::Geometry handle_ = nullptr;
    std::size_t bytes_ = 0;
};

/// The structure over all instances.
class HiprtTopLevel {
public:
    HiprtTopLevel() = default;
    /// @throws GpuOutOfMemory
    HiprtTopLevel(HiprtContext& context, GpuMemory& memory, const hiprt::SceneBuildInput& input,
                  const hiprt::BuildOptions& options);
    HiprtTopLevel(HiprtTopLevel&& other) noexcept { *this = std::move(other); }
    HiprtTopLevel& operator=(HiprtTopLevel&& other) noexcept;
    ~HiprtTopLevel();

    hiprt::Scene handle() const { return handle_; }
    /// Whether it can be built anew from an input, in the memory that it has.
    bool fits(const hiprt::SceneBuildInput& input, const hiprt::BuildOptions& options) const;

private:
    HiprtContext* context_ = nullptr;
    GpuMemory* memory_ = nullptr;
    hiprt::Scene handle_ = nullptr;
    std::size_t bytes_ = 0;
    hiprt::SceneBuildInput made_for_;
    hiprt::BuildOptions options_;
};

/// The table that leads rays to our functions: one row for each kernels::geometry_type, one type of rays.
class HiprtFunctionTable {
public:
    explicit HiprtFunctionTable(HiprtContext& context);
    HiprtFunctionTable(const HiprtFunctionTable&) = delete;
    HiprtFunctionTable& operator=(const HiprtFunctionTable&) = delete;
    ~HiprtFunctionTable();

    hiprt::FunctionTable handle() const { return handle_; }

private:
    HiprtContext& context_;
    hiprt::FunctionTable handle_ = nullptr;
};

/// HIPRT reports an internal error when its own allocation fails, so creating a structure that fails counts as full
/// memory. @throws GpuOutOfMemory, RenderError  unless it is a success
void check_created(hiprt::Error result, const char* what, GpuMemory& memory);

}  // namespace kadr
