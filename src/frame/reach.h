#pragma once

#include <cstdint>
#include <limits>

#include "frame/decompose.h"

namespace kadr {

class BoundShot;
struct SceneSnapshot;

/// How far the instances of a snapshot reach from its render origin, and the smallest of them.
struct Reach {
    double farthest_m = 0;
    std::uint32_t farthest = 0;   ///< id of that instance
    double smallest_m = std::numeric_limits<double>::infinity();
    std::uint32_t smallest = 0;   ///< id of that instance

    void add(std::uint32_t instance, const Decomposition& place);
    void add(const Reach& other);
};

/// Devices trace in floats, and rays in the coordinates of single meshes as well: beyond 1e17 metres or units of the render
/// space, of things 1e17 times as large as a mesh, or where the cube of a scale vanishes, their numbers come near the end of
/// what floats hold, and Embree ends the program.
/// @throws InputError  naming the node, or the camera
void check_reach(const BoundShot& shot, const SceneSnapshot& snapshot, const Reach& reach);

}  // namespace kadr
