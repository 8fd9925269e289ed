#pragma once

#include <optional>

#include "frame/frame_state.h"

namespace kadr {

/// Two surfaces so near to each other that a ray which leaves one may start beyond the other: a plate, or a mesh closely
/// around another.
struct ThinShell {
    int node = -1, inner_node = -1;  ///< of the plate or the outer mesh; of the inner mesh, -1: a plate
    double thickness_m = 0, size_m = 0;
};

/// The thickness of a plate or shell, as a part of its size, from which on rays keep to their side (see `kadr stress`).
inline constexpr double kThinnestShell = 1e-5;

/// The thinnest, where one is thinner than that; found by the boxes of meshes, those of more than 512 by the boxes of the
/// first 512. Layers in one plane are no shell: it does not matter which of them is met.
std::optional<ThinShell> find_thin_shell(const BoundShot& shot, double time_s);

}  // namespace kadr
