#pragma once

#include <memory>

#include "device/hiprt/gpu_runtime.h"

namespace kadr {

/// Whether this program was built with the Orochi library.
bool built_with_orochi();

/// GPUs of a vendor that the driver offers. @pre built_with_orochi(), and the probe found everything
/// @throws RenderError  when the driver cannot be started
int count_gpus(GpuVendor vendor);

/// @param ordinal  from 0, below count_gpus()
/// @throws RenderError  when the GPU cannot be taken
std::unique_ptr<GpuRuntime> make_orochi_runtime(GpuVendor vendor, int ordinal);

}  // namespace kadr
