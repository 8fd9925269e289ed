#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scene/scene_types.h"

namespace kadr {

/// How much worse a structure gets when its triangles move but its tree stays: a stand-in for the device's own tree, which
/// cannot be asked.
///
/// Triangles in the order of a space-filling curve at the time of building; groups of eight, groups of eight groups and
/// so on. The cost is what the surface area heuristic says of such a tree: the areas of all boxes over that of the root.
/// Source: MacDonald & Booth, "Heuristics for Ray Tracing Using Space Subdivision", 1990; Morton codes as in Lauterbach et
/// al., "Fast BVH Construction on GPUs", 2009.
class BoundsTree {
public:
    /// Orders the triangles by where they are now. @param indices  three a triangle
    void order(std::span<const kernels::Vertex> vertices, const std::vector<std::uint32_t>& indices);
    /// The cost with the vertices where they are now; the order stays.
    double cost(std::span<const kernels::Vertex> vertices, const std::vector<std::uint32_t>& indices) const;

private:
    std::vector<std::uint32_t> order_;  ///< triangles
};

}  // namespace kadr
