#pragma once

#include <vector>

#include "frame/snapshot.h"

namespace kadr {

/// What SceneSnapshot::light_error may be: of a light's own values, a tenth of a step of 8-bit output.
inline constexpr double kLightTolerance = 1e-3;

/// Fills `lights` and `light_keys` with the shot's lights and those of its glTF files over a part of the shutter,
/// in the snapshot's render space, and `light_error`. One key for a light that does not change, at most 33;
/// none for one that is hidden.
/// @return keys of tracks of lights whose error is above kLightTolerance: good times to split the shutter at
/// @throws InputError  where a light has no direction
std::vector<double> add_light_keys(const BoundShot& shot, double open_s, double close_s, SceneSnapshot& snapshot);

/// The same lights in the same order at one time, unrounded. @param switch_s  when lights are looked at for being on: the
/// middle of the part
std::vector<kernels::LightOf<double>> lights_at(const BoundShot& shot, double time_s, double switch_s, const RenderSpace& space);

std::vector<double> light_discontinuities(const BoundShot& shot, double begin_s, double end_s);

}  // namespace kadr
