#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace kadr {

/// A vertex in the middle of two others, which come before it.
struct Midpoint {
    std::uint32_t a = 0, b = 0;
};

/// Triangles after their longest edges were halved, some of them many times.
struct Subdivision {
    std::vector<std::uint32_t> indices;  ///< three a triangle
    std::vector<Midpoint> added;         ///< vertices beyond those that there were
};

/// Halves edges until no triangle has one that is longer than 256 times its distance from the origin (or 4096, near it).
///
/// A point of a triangle is as precise as the float coordinates of its corners: on a terrain of 10 km with corners at its
/// rim, the ground under a screw has the precision of the rim, a millimetre, as large as the screw. Smaller triangles have
/// corners near by. An edge is halved for all triangles that have its two ends, whatever vertices lie there, so that no crack
/// opens.
///
/// @param positions  in the coordinates whose origin is near the camera; the new vertices are added at its end
/// @return           no indices: nothing was to be done
Subdivision subdivide_near_origin(std::vector<glm::dvec3>& positions, const std::vector<std::uint32_t>& indices);

}  // namespace kadr
