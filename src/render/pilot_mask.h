#pragma once

#include <cstdint>
#include <vector>

namespace kadr {

/// Which pixels a pilot looks at.
struct PilotMask {
    std::vector<std::uint8_t> active;  ///< [y][x], 0: not this one
    double count = 0;                  ///< of those that it does look at
};

/// One of 32 pixels, but no fewer than 1024 of a picture: their mean error is known to some ten percent. Every so many
/// of a row, and the rows are shifted against each other by the golden section, so that no column or block is passed
/// over. The same for every frame: what differs between frames is not the choice.
PilotMask pilot_mask(int width, int height);

}  // namespace kadr
