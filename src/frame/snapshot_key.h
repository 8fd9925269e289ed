#pragma once

#include <vector>

#include "base/hash.h"
#include "frame/snapshot.h"

namespace kadr {

/// Hash of everything in a frame's snapshots that affects its pixels: equal keys are equal images, whatever the frame.
/// What it leaves out is when the frame is (its number and its seconds); an animated seed is part of the settings.
Hash content_key(const std::vector<SceneSnapshot>& parts);

}  // namespace kadr
