#pragma once

#include <functional>
#include <memory>
#include <string>

#include "device/device.h"
#include "device/hiprt/gpu_access.h"

namespace kadr {

/// What the self-check says of a GPU, in a sentence ("the GPU NVIDIA H200 gave 3 wrong hits of 400"); empty: nothing.
/// Against the CPU's portable form, on one thread.
std::string fault_of(const StartedGpu& gpu);

using FaultOf = std::function<std::string(const StartedGpu&)>;

/// `auto`: the GPU where it starts and its self-check finds nothing wrong, else the CPU; and why.
DeviceChoice take_best(Found<StartedGpu> gpu, const FaultOf& fault, const std::function<std::unique_ptr<Device>()>& make_cpu);

/// `hiprt`: the GPU that was asked for, with a warning where its self-check finds something.
/// @param name  as it was asked for  @throws InputError  where there is none, with the reason
DeviceChoice take_gpu(Found<StartedGpu> gpu, const std::string& name, const FaultOf& fault);

}  // namespace kadr
