#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "device/hiprt/gpu_runtime.h"
#include "device/hiprt/hiprt_library.h"
#include "device/hiprt/host_system.h"

namespace kadr {

/// One thing that rendering on a GPU needs.
struct GpuNeed {
    std::string name;     ///< "driver"
    std::string found;    ///< what was found; empty: it is missing
    std::string missing;  ///< one sentence: what is missing and what to do; empty: it is there
};

/// What was looked for, in the order in which it is needed: a library is opened only when what it rests on is there,
/// because without a driver or the CUDA runtime HIPRT and Orochi crash instead of reporting an error. Looking ends with
/// the first thing that is missing.
struct GpuProbe {
    std::vector<GpuNeed> needs;
    GpuVendor vendor = GpuVendor::amd;  ///< whose driver is there; NVIDIA's where both are
    std::filesystem::path hiprt_library;
    std::filesystem::path hiprt_headers;  ///< the folder that holds hiprt/hiprt_device.h
    std::filesystem::path kernel_folder;  ///< the folder that holds kernels/gpu

    bool complete() const { return !needs.empty() && needs.back().missing.empty(); }
    const std::string& missing() const { return needs.back().missing; }
};

/// @param has_runtime  whether this program was built with Orochi
GpuProbe probe_gpu(const HostSystem& machine, bool has_runtime);

}  // namespace kadr
