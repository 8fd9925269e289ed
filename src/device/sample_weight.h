#pragma once

#include "device/device.h"

namespace kadr {

/// What a sample of a pass counts for, before its line's share of the light (kernels::Shutter::weight): the light of the
/// part of the shutter over the share of samples that it was dealt. A plain part's light is known; of others the kernels
/// know what each line gets.
/// @param part_weight  SceneSnapshot::weight
inline float sample_weight(const kernels::Shutter& shutter, double part_weight, const Pass& pass) {
    const double dealt = pass.dealt_share > 0 ? pass.dealt_share : part_weight;
    return static_cast<float>((shutter.plain ? part_weight : 1.0) / dealt);
}

}  // namespace kadr
