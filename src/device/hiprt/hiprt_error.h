#pragma once

#include <source_location>
#include <string_view>

#include "device/hiprt/hiprt_abi.h"

namespace kadr {

/// What an error of HIPRT means, in words.
std::string_view text_of(hiprt::Error error);

/// @param action  reads as the end of "cannot ..."
/// @throws RenderError  with the action and what HIPRT reports, unless it is a success
void check(hiprt::Error result, std::string_view action, std::source_location where = std::source_location::current());

}  // namespace kadr
