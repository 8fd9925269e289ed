#pragma once

#include <vector>

#include "frame/snapshot.h"

namespace kadr {

/// Fills `lights` and `light_keys` with the shot's lights and those of its glTF files over a part of the shutter,
/// relative to the snapshot's render origin, and `light_error`. One key for a light that does not change, at most 33;
/// none for one that is hidden.
/// @throws InputError  where a light has no direction
void add_light_keys(const BoundShot& shot, double open_s, double close_s, SceneSnapshot& snapshot);

std::vector<double> light_discontinuities(const BoundShot& shot, double begin_s, double end_s);

}  // namespace kadr
