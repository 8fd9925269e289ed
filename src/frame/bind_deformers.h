#pragma once

#include <span>
#include <vector>

#include "frame/snapshot.h"

namespace kadr {

struct Bindings;
struct Placement;

/// What bent meshes may take in memory, all together: vertices and structures of every clip offset of every mesh.
inline constexpr double kMostBentBytes = 16e9;
/// Of Embree's structure over a bent mesh, a triangle, with motion blur.
inline constexpr double kStructureBytes = 250;

/// Finds the seeds whose vertices bend, and gives them deformers with bounds over the whole shot.
/// @param copies  [file]; empty: the scene is not repeated
/// @throws InputError  naming the node whose joints are not finite, or whose copies at different times of their clips would
///         take more than kMostBentBytes
void bind_deformers(const BoundShot& shot, std::span<const std::vector<Placement>> copies, Bindings& bindings);

}  // namespace kadr
