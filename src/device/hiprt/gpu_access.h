#pragma once

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

/// A GPU, or in one sentence why it cannot be had. @param number  from 0
Found<std::unique_ptr<Device>> try_gpu(int number, KernelChoice kernels);

}  // namespace kadr
