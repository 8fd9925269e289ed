#pragma once

#include <vector>

#include "frame/layered_track.h"

namespace kadr {

/// Times of the shot inside the windows at which the mean of the rotations that are mixed jumps although none of them does:
/// one passes half a turn from their middle (of two: from the other), and its arc changes sides. To the last places of a
/// double. Rotations within 120 degrees of one another never do that; among others a flip there and back within an eighth of
/// the window, or an eighth of a turn, is looked for where one comes near.
///
/// @param windows  parallel to the layers, at least one
void add_flips(const LayeredTrack<glm::dquat>& track, Layers layers, LayerWindows windows, double clip_offset_s, std::vector<double>& times);

}  // namespace kadr
