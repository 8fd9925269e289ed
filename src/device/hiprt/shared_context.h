#pragma once

#include <filesystem>
#include <memory>
#include <utility>

#include "device/hiprt/hiprt_handles.h"

namespace kadr {

/// A GPU's runtime with HIPRT on it, for several owners: who compiles in the background may need it longer than the device
/// does.
struct SharedContext {
    SharedContext(std::shared_ptr<GpuRuntime> gpu, const hiprt::Api& functions, const std::filesystem::path& cache)
        : runtime(std::move(gpu)), api(functions), context(api, *runtime, cache) {}

    std::shared_ptr<GpuRuntime> runtime;
    hiprt::Api api;
    HiprtContext context;
};

}  // namespace kadr
