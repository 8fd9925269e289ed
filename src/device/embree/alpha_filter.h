#pragma once

#include "device/embree/embree_api.h"
#include "device/embree/geometry_user.h"

namespace kadr {

/// Lets rays pass where a surface does not cover them: `mask` by its cutoff; `blend` by a hash of the path for closest
/// hits and by multiplying the transmittance for shadow rays (order does not matter there, so shadows stay free of
/// noise).
void alpha_filter(const RTCFilterFunctionNArguments* arguments);

}  // namespace kadr
