#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "device/device.h"
#include "device/hiprt/gpu_runtime.h"
#include "device/hiprt/hiprt_library.h"

namespace kadr {

/// The GPUs that can be rendered on, or in one sentence why there are none.
struct GpuList {
    std::vector<GpuProperties> gpus;
    std::string missing;  ///< empty: there are some
};
GpuList list_gpus();

/// A GPU that started.
struct StartedGpu {
    std::unique_ptr<Device> device;
    std::string name;                  ///< "NVIDIA H200"
    std::filesystem::path check_file;  ///< keeps the outcome of its self-check (self_check.h); empty: nothing does
};
/// A GPU, or in one sentence why it cannot be had. @param number  from 0
Found<StartedGpu> try_gpu(int number, KernelChoice kernels);

}  // namespace kadr
