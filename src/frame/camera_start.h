#pragma once

#include "frame/snapshot.h"

namespace kadr {

/// Where the rays of a long lens may start: metres along the view axis from the camera to a plane before everything that it
/// sees while this part of the shutter is open; 0 for wide lenses (from 3.6 degrees on), and where something is near.
///
/// Floats hold a direction to 6e-8 rad. From a camera that is a thousand times as far away as its picture is high, that is
/// as much as a tenth of what tells a ray from its neighbour; from a plane before the subject it is nothing.
/// @param open_s, close_s  what camera_keys stand for
/// @param snapshot         complete but for its camera_keys' own start
double camera_start_m(const BoundShot& shot, double open_s, double close_s, const SceneSnapshot& snapshot);

}  // namespace kadr
