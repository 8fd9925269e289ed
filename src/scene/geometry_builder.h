#pragma once

#include <string>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"
#include "scene/scene_needs.h"

namespace kadr {

struct BuiltGeometry {
    GeometryData data;                  ///< no indices: nothing to draw (points, lines, no positions)
    std::vector<Diagnostic> warnings;
};

/// What the primitive holds, by its accessors; and the name that its geometry will have.
GeometryOutline outline_of(const GltfDocument& document, std::size_t mesh, std::size_t primitive);
std::string geometry_name(const GltfDocument& document, std::size_t mesh, std::size_t primitive);

/// One primitive as normalised triangles, with the attributes that are needed.
///
/// @param normal_uv_set  the texture coordinates of the material's normal texture, which the primitive has; -1: no normal
///                       texture, and then tangents are dropped
/// @throws InputError  for attributes of wrong type or count, indices beyond the vertices, values that are not finite
BuiltGeometry build_geometry(const GltfDocument& document, std::size_t mesh, std::size_t primitive, int normal_uv_set, const GeometryNeeds& needs);

}  // namespace kadr
