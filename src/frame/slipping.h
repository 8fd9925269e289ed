#pragma once

#include <optional>
#include <string>

#include "frame/frame_state.h"

namespace kadr {

/// How many rays would slip between two triangles that share an edge where a device tests them one by one.
struct Slipping {
    std::string node;   ///< whose triangles ask for it most
    double share = 0;   ///< of a picture's rays

    /// "one ray in 4100 would slip between triangles, most of them of node 'stage/Fan'"
    std::string text() const;
};

/// Estimated from coordinates alone: floats place the edges that a ray passes within 2^-24 of its length, and of the rays
/// that come so near to one some are told by both of its triangles that they pass beside. So many slip as there is length of
/// edges on an area, times the length of rays. From afar that is much for dense meshes, and for needles always.
/// Looks at the first, the middle and the last frame.
/// @return where it is more than one ray in ten thousand, which a picture may show, or nothing
std::optional<Slipping> find_slipping(const BoundShot& shot);

}  // namespace kadr
