#pragma once

#include <vector>

#include "stress/axis.h"

namespace kadr::stress {

/// Where things are, how large, and through what lens.
std::vector<Axis> place_axes();
/// Triangles, surfaces that nearly touch, and what they are made of.
std::vector<Axis> surface_axes();
std::vector<Axis> light_axes();
/// Movement, time, copies and pictures.
std::vector<Axis> motion_axes();

}  // namespace kadr::stress
