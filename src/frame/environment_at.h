#pragma once

#include <vector>

#include "frame/snapshot.h"

namespace kadr {

/// The environment over a part of the shutter: the mean of its radiance, and its image as it lies in the middle.
EnvironmentSnapshot environment_over(const BoundShot& shot, double begin_s, double end_s);

/// Whether the middle of an interval cannot stand for all of it: radiance bends by more than a thousandth, or an image
/// turns by more than half a degree (the sun's width).
bool environment_changes_fast(const BoundShot& shot, double begin_s, double end_s);

std::vector<double> environment_discontinuities(const EnvironmentSpec& environment, double begin_s, double end_s);

}  // namespace kadr
