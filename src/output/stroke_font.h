#pragma once

#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace kadr {

/// A letter as pen strokes on a grid: x from 0 to 4, y down, 0 the top of capitals and 6 the line that text stands on;
/// tails reach to 8. A stroke of one point is a dot.
using Glyph = std::vector<std::vector<glm::ivec2>>;

inline constexpr int kGlyphHeight = 6;  ///< of capitals and digits, grid units

/// The strokes of a printable ASCII letter; a box for what the font does not have. Labels on pictures need no font file
/// and no font library that way, and look the same everywhere.
const Glyph& glyph_of(char letter);
/// From the letter's left end to that of the next one, in grid units.
int advance_of(char letter);

}  // namespace kadr
