#pragma once

#include "frame/snapshot.h"

namespace kadr {

/// Fills snapshot.shutter and snapshot.weight of the part of a frame's shutter that the snapshot stands for: its open_s
/// and close_s are set already.
void set_shutter(const BoundShot& shot, const FrameTime& frame, SceneSnapshot& snapshot);

}  // namespace kadr
