#pragma once

#include <vector>

#include "base/error.h"
#include "frame/frame_state.h"

namespace kadr {

/// What a shot asks of numbers beyond where they are safe (see `kadr stress`), said before the first ray: which camera,
/// node, mesh or light it is, and by how much. Looks at the first, the middle and the last frame.
std::vector<Diagnostic> precision_warnings(const BoundShot& shot);

}  // namespace kadr
