#pragma once

#include <string>

#include "measure/device_comparison.h"

namespace kadr {

/// What a person reads of one frame, several lines.
std::string comparison_text(const ComparedDeviceFrame& frame, const DeviceComparisonOptions& options);

}  // namespace kadr
