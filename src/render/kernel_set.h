#pragma once

#include "device/device.h"
#include "frame/frame_state.h"

namespace kadr {

/// What the frames of a shot ask of a device's kernels, all together, as far as its requirements tell without a device: what a
/// frame turns out to need beyond that gets a kernel of its own.
KernelSet kernel_set_of(const BoundShot& shot);

}  // namespace kadr
