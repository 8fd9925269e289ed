#pragma once

#include <vector>

#include "frame/layered_track.h"

namespace kadr {

/// A switch that layers of clips drive (1 on, 0 off). Switches have no mean: the layer with the greatest weight has its
/// way, of equal ones the later. What the weights leave of 1 is the weight of the switch's own state, which gives way to an
/// equal one.
bool is_on(const LayeredTrack<double>& track, bool own, Layers layers, double time_s, double clip_offset_s);

/// Times of the shot inside (begin, end), to the last places of a double, at which another layer gets the greatest weight
/// and the switch thereby changes. Between two keys of weights that run along curves, a lead that is lost and won back
/// within an eighth of the way is not found.
std::vector<double> handovers(const LayeredTrack<double>& track, bool own, Layers layers, double begin_s, double end_s, double clip_offset_s);

}  // namespace kadr
