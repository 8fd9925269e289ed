#pragma once

#include <vector>

#include "frame/snapshot.h"

namespace kadr {

/// The environment at a time: what stands for a part of the shutter.
EnvironmentSnapshot environment_at(const BoundShot& shot, double time_s);

/// Whether the middle of an interval cannot stand for all of it: radiance bends by more than a thousandth, or an image
/// turns by more than half a degree (the sun's width).
bool environment_changes_fast(const BoundShot& shot, double begin_s, double end_s);

std::vector<double> environment_discontinuities(const EnvironmentSpec& environment, double begin_s, double end_s);

}  // namespace kadr
