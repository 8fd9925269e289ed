#pragma once

#include "base/hash.h"
#include "shot/shot.h"

namespace kadr {

/// Feeds every value of the shot that can change a frame's linear pixels or layers. Left out: the frame range, output
/// paths, video, name and comments, and the content of assets (hashed where they are read; their number and order is
/// part of this).
void hash_shot(const Shot& shot, Hasher& hasher);

/// Feeds what changes display-referred files besides: the view and the bits of PNG. EXR files do not depend on it.
void hash_view(const Shot& shot, Hasher& hasher);

}  // namespace kadr
