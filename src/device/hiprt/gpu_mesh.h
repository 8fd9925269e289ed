#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/hiprt_abi.h"
#include "device/hiprt/upload_queue.h"
#include "kernels/deform/bend.h"

namespace kadr {

/// Boxes around the triangles of a mesh and all keys of its vertices.
std::vector<kernels::TriangleBox> boxes_of(const kernels::Geometry& host);

/// What the kernels and HIPRT fetch of a mesh, in the memory of the GPU.
struct GpuMesh {
    DeviceBuffer<kernels::Vertex> vertices;
    DeviceBuffer<unsigned> indices;
    DeviceBuffer<kernels::Vec4f> tangents, colors;
    DeviceBuffer<kernels::Vec2f> uv1;
    DeviceBuffer<kernels::Vec3f> previous;  ///< positions one frame earlier; empty: those of now
    DeviceBuffer<kernels::TriangleBox> boxes;        ///< of a mesh whose vertices have several keys

    GpuMesh() = default;
    /// Copies what a mesh of the host points to, vertices and tangents of all keys.
    /// @param bent  false: there is only room for those, and for the boxes around them, which something else fills
    GpuMesh(GpuMemory& memory, UploadQueue& uploads, const kernels::Geometry& host, bool bent = true);

    /// Copies vertices, tangents and boxes of the host's mesh, which has as many keys.
    void upload_bent(UploadQueue& uploads, const kernels::Geometry& host) const;

    /// `host` with addresses of the GPU.
    kernels::Geometry view(const kernels::Geometry& host) const;
    /// What HIPRT builds a structure of: triangles, or boxes where vertices have several keys, which our intersection
    /// function looks into. @param filtered  rays ask our filter function at every hit
    hiprt::GeometryBuildInput build_input(const kernels::Geometry& host, bool filtered) const;
};

}  // namespace kadr
