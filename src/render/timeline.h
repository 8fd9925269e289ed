#pragma once

#include <string>

#include "frame/frame_state.h"

namespace kadr {

/// The shot's timeline as text of at most 100 columns: frames and exact times, the shutter, a table of the tracks, one
/// bar a track, the cuts with the frames whose shutter they split, and the frames that repeat the one before. Ends with a
/// newline.
/// @throws InputError  where a frame's motion cannot be represented (see make_snapshots)
std::string timeline_text(const BoundShot& shot);

}  // namespace kadr
