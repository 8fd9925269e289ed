#pragma once

#include <string>

#include "frame/frame_state.h"

namespace kadr {

/// The shot's timeline as text of at most 100 columns: frames and exact times, the shutter, a table of the tracks, one
/// bar a track, and the cuts with the frames whose shutter they split. Ends with a newline.
std::string timeline_text(const BoundShot& shot);

}  // namespace kadr
