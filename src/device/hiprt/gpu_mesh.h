#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/hiprt_abi.h"
#include "device/hiprt/upload_queue.h"
#include "kernels/scene/scene_types.h"

namespace kadr {

/// The box around a triangle over the whole shutter.
struct TriangleBox {
    kernels::Vec3f low, high;
};

/// Boxes around the triangles of a mesh and all keys of its vertices: between keys corners go straight, so they stay
/// within. A hair larger, so that a ray along a side meets them.
std::vector<TriangleBox> boxes_of(const kernels::Geometry& host);

/// What the kernels and HIPRT fetch of a mesh, in the memory of the GPU.
struct GpuMesh {
    DeviceBuffer<kernels::Vertex> vertices;
    DeviceBuffer<unsigned> indices;
    DeviceBuffer<kernels::Vec4f> tangents, colors;
    DeviceBuffer<kernels::Vec2f> uv1;
    DeviceBuffer<kernels::Vec3f> previous;  ///< positions one frame earlier; empty: those of now
    DeviceBuffer<TriangleBox> boxes;        ///< of a mesh whose vertices have several keys

    GpuMesh() = default;
    /// Copies what a mesh of the host points to, vertices and tangents of all keys.
    GpuMesh(GpuMemory& memory, UploadQueue& uploads, const kernels::Geometry& host);

    /// `host` with addresses of the GPU.
    kernels::Geometry view(const kernels::Geometry& host) const;
    /// What HIPRT builds a structure of: triangles, or boxes where vertices have several keys, which our intersection
    /// function looks into. @param filtered  rays ask our filter function at every hit
    hiprt::GeometryBuildInput build_input(const kernels::Geometry& host, bool filtered) const;
};

}  // namespace kadr
