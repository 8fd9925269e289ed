#pragma once

#include <filesystem>
#include <memory>

#include "device/device.h"
#include "device/hiprt/gpu_runtime.h"
#include "device/hiprt/hiprt_abi.h"

namespace kadr {

/// What a GPU device is made from.
struct HiprtParts {
    std::shared_ptr<GpuRuntime> runtime;
    hiprt::Api api;
    std::filesystem::path kernel_folder;  ///< holds kernels/
    std::filesystem::path cache_folder;   ///< for compiled kernels; empty: HIPRT's own choice
    KernelChoice kernels = KernelChoice::needed;  ///< `needed`: exactly what a frame needs is compiled
};

/// A GPU through HIPRT. What it cannot show it refuses by name when it is given the frame.
/// @throws InputError   for a GPU that is too old for our kernels
/// @throws RenderError  when the GPU or HIPRT does not start
std::unique_ptr<Device> make_hiprt_device(HiprtParts parts);

}  // namespace kadr
