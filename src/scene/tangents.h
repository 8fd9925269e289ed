#pragma once

#include "scene/scene.h"

namespace kadr {

/// Tangents of a mesh from its normals (or faces) and the texture coordinates of `uv_set`, with glTF's handedness: bitangent =
/// cross(normal, tangent) * w points to the top of the texture (-v). Like MikkTSpace, each triangle adds its direction of
/// growing u, projected into the vertex's plane and weighted by the corner's angle. Unlike MikkTSpace, vertices are not split:
/// where triangles of opposite handedness share a vertex, the larger angle decides.
/// Flat meshes (no normals) are unshared first, so that every triangle has its own tangent.
void add_tangents(GeometryData& geometry, int uv_set);

}  // namespace kadr
