#pragma once

#include "device/device.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_types.h"
#include "scene/scene.h"

namespace kadr {

/// A bent mesh as the kernels fetch it: vertices and tangents of all keys are the mesh's, what does not bend is the
/// source's. Points into both.
kernels::Geometry geometry_of(const DeformedMesh& mesh, const GeometryData& source);

/// Of the meshes of a snapshot that instances show. by_kernels is left to the device.
BendingCounts count_bending(const SceneSnapshot& snapshot);

}  // namespace kadr
