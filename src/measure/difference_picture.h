#pragma once

#include <string>

#include "measure/frame_difference.h"

namespace kadr {

/// Reference, test and error map side by side, labelled; display-referred R, G, B. Its sides are even, as video wants
/// them.
Image difference_picture(const ShownDifference& shown, const std::string& label);

}  // namespace kadr
