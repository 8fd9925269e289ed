#pragma once

#include "frame/camera_keys.h"

namespace kadr {

/// How far away what a camera shows is, to a factor: the scale for "precise enough". What the shot's camera looks at; of an
/// authored camera, which looks at nothing by name, its own hint, unless its view is narrower than a degree, or the nearest
/// thing in it is more than eight times nearer or a thousand times farther: then the distance of that.
double seen_distance(const BoundShot& shot, const CameraState& camera, double time_s);

}  // namespace kadr
