#pragma once

#include "frame/snapshot.h"

namespace kadr {

/// What a frame asks of the kernels on the CPU, as a set of kernels::requirement bits, before any device has been given it:
/// nothing is built, and textures need no texels.
unsigned kernel_requirements_of(const Scene& scene, const SceneSnapshot& snapshot);

}  // namespace kadr
