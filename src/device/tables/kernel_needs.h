#pragma once

#include "device/tables/material_table.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// What a frame asks of the kernels of any device, as a set of kernels::requirement bits.
/// @param materials  which know what is shown
/// @param instances  whether anything is not flattened
/// @param bends      whether any mesh bends while the shutter is open
unsigned kernel_requirements_of(const MaterialTable& materials, bool instances, bool bends, const kernels::LightSet& lights);

}  // namespace kadr
