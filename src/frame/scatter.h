#pragma once

#include <vector>

#include "frame/node_rig.h"
#include "frame/placement.h"
#include "scene/scene.h"

namespace kadr {

/// Copies strewn over the triangles of a scene or of one of its nodes (with all below it), as many to the square metre
/// everywhere, in the coordinates of the scene that is strewn: its transform is undone.
/// Where they keep a distance, by throwing darts until `count` have stuck or a thousand in a row have found no room; then
/// there are fewer. Source: Cook 1986, "Stochastic Sampling in Computer Graphics", 3.3.
/// Source: uniform points of triangles, Osada et al. 2002, "Shape Distributions", 4.2.
///
/// @param file  of the scene that is strewn
/// @throws InputError  unknown target; one that moves, is the strewn scene itself, or has no surface
std::vector<Placement> scatter_copies(const InstancesSpec& spec, int file, const Scene& scene, const NodeRig& rig);

}  // namespace kadr
