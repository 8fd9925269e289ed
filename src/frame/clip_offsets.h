#pragma once

#include <vector>

#include "anim/placement.h"

namespace kadr {

/// [scene entry] the clip offsets of its copies in seconds, each once, ascending; 0 alone where it is not repeated.
using ClipOffsets = std::vector<std::vector<double>>;

/// @param copies  [scene entry]
ClipOffsets clip_offsets_of(const std::vector<std::vector<Placement>>& copies);

}  // namespace kadr
