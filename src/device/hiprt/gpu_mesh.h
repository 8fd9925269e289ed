#pragma once

#include <cstdint>
#include <span>

#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/hiprt_abi.h"
#include "device/hiprt/upload_queue.h"
#include "kernels/scene/scene_types.h"

namespace kadr {

/// What the kernels and HIPRT fetch of a mesh, in the memory of the GPU.
struct GpuMesh {
    DeviceBuffer<kernels::Vertex> vertices;
    DeviceBuffer<unsigned> indices;
    DeviceBuffer<kernels::Vec4f> tangents, colors;
    DeviceBuffer<kernels::Vec2f> uv1;
    DeviceBuffer<kernels::Vec3f> previous;  ///< positions one frame earlier; empty: those of now

    GpuMesh() = default;
    /// Copies what a mesh of the host points to; `vertices` of one key.
    GpuMesh(GpuMemory& memory, UploadQueue& uploads, const kernels::Geometry& host);

    /// `host` with addresses of the GPU.
    kernels::Geometry view(const kernels::Geometry& host) const;
    /// What HIPRT builds a structure of. @param filtered  rays ask our filter function at every hit
    hiprt::GeometryBuildInput build_input(const kernels::Geometry& host, bool filtered) const;
};

}  // namespace kadr
