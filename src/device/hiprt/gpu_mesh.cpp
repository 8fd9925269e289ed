#include "device/hiprt/gpu_mesh.h"

#include "kernels/gpu/launch_params.h"

namespace kadr {
namespace {

template <class T>
DeviceBuffer<T> copy(GpuMemory& memory, UploadQueue& uploads, const T* from, std::size_t count) {
    DeviceBuffer<T> buffer(memory, from ? count : 0, MemoryUse::vertices);
    if (from) uploads.add(buffer, {from, count});
    return buffer;
}

}  // namespace

GpuMesh::GpuMesh(GpuMemory& memory, UploadQueue& uploads, const kernels::Geometry& host)
    : vertices(copy(memory, uploads, host.vertices, host.vertex_count)),
      indices(copy(memory, uploads, host.indices, std::size_t{3} * host.triangle_count)),
      tangents(copy(memory, uploads, host.tangents, host.vertex_count)),
      colors(copy(memory, uploads, host.colors, host.vertex_count)),
      uv1(copy(memory, uploads, host.uv1, host.vertex_count)) {}

kernels::Geometry GpuMesh::view(const kernels::Geometry& host) const {
    kernels::Geometry g = host;
    g.vertices = vertices.data();
    g.indices = indices.data();
    g.tangents = tangents.data();
    g.colors = colors.data();
    g.uv1 = uv1.data();
    g.previous = previous.data();
    return g;
}

hiprt::GeometryBuildInput GpuMesh::build_input(const kernels::Geometry& host, bool filtered) const {
    hiprt::GeometryBuildInput input;
    if (filtered) input.geometry_type = kernels::geometry_type::kFiltered;
    input.mesh.vertices = vertices.pointer();
    input.mesh.vertex_count = host.vertex_count;
    input.mesh.vertex_stride = sizeof(kernels::Vertex);
    input.mesh.indices = indices.pointer();
    input.mesh.triangle_count = host.triangle_count;
    input.mesh.triangle_stride = 3 * sizeof(unsigned);
    return input;
}

}  // namespace kadr
