#pragma once

#include "frame/snapshot.h"
#include "kernels/scene/scene_types.h"
#include "scene/scene.h"

namespace kadr {

/// A bent mesh as the kernels fetch it: vertices and tangents of all keys are the mesh's, what does not bend is the
/// source's. Points into both.
kernels::Geometry geometry_of(const DeformedMesh& mesh, const GeometryData& source);

}  // namespace kadr
