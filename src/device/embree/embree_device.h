#pragma once

#include <memory>

#include "device/device.h"

namespace kadr {

/// Embree on the CPU. @param threads 0: all; @param width lanes (0: what the processor has; KADR_WIDTH is read by the
/// factory)
std::unique_ptr<Device> make_embree_device(int threads, int width);

/// "8 lanes (AVX2)" and the like, for `kadr devices`.
int best_width();

}  // namespace kadr
