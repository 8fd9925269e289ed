#pragma once

#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kadr {

struct BuiltGeometry {
    GeometryData data;                  ///< no indices: nothing to draw (points, lines, no positions)
    std::vector<Diagnostic> warnings;
};

/// One primitive as normalised triangles.
///
/// @param normal_uv_set  the texture coordinates of the material's normal texture, which the primitive has; -1: no normal
///                       texture, and then tangents are dropped
/// @throws InputError  for attributes of wrong type or count, indices beyond the vertices, values that are not finite
BuiltGeometry build_geometry(const GltfDocument& document, std::size_t mesh, std::size_t primitive, int normal_uv_set);

}  // namespace kadr
