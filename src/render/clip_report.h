#pragma once

#include <string>

#include "frame/frame_state.h"

namespace kadr {

/// What clips each scene of a shot has and plays, as text: a table of the clips, a line for every layer (which part of
/// which clip plays from when, how it loops and how much it counts), and the node tree of what moves or is hidden, cut
/// after 200 lines. Ends with a newline; empty where no scene has a clip nor says anything of a node.
std::string clip_report(const BoundShot& shot);

}  // namespace kadr
