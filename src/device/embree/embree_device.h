#pragma once

#include <memory>

#include "device/device.h"

namespace kadr {

/// Embree on the CPU. What the environment says is read by the factory.
/// @param threads  0: all
/// @param width    lanes
std::unique_ptr<Device> make_embree_device(int threads, int width, KernelChoice kernels = KernelChoice::needed);

/// "8 lanes (AVX2)" and the like, for `kadr devices`.
int best_width();

}  // namespace kadr
