#include "device/hiprt/gpu_mesh.h"

#include <algorithm>

#include "kernels/gpu/launch_params.h"

namespace kadr {
namespace {

template <class T>
DeviceBuffer<T> copy(GpuMemory& memory, UploadQueue& uploads, const T* from, std::size_t count) {
    DeviceBuffer<T> buffer(memory, from ? count : 0, MemoryUse::vertices);
    if (from) uploads.add(buffer, {from, count});
    return buffer;
}

std::size_t keys_of(const kernels::Geometry& host) { return std::max(host.key_count, 1u); }

}  // namespace

std::vector<kernels::TriangleBox> boxes_of(const kernels::Geometry& host) {
    std::vector<kernels::TriangleBox> boxes(host.triangle_count);
    for (unsigned t = 0; t < host.triangle_count; ++t) boxes[t] = kernels::box_of(host, t);
    return boxes;
}

GpuMesh::GpuMesh(GpuMemory& memory, UploadQueue& uploads, const kernels::Geometry& host, bool bent)
    : vertices(memory, keys_of(host) * host.vertex_count, MemoryUse::vertices),
      indices(copy(memory, uploads, host.indices, std::size_t{3} * host.triangle_count)),
      tangents(memory, host.tangents ? keys_of(host) * host.vertex_count : 0, MemoryUse::vertices),
      colors(copy(memory, uploads, host.colors, host.vertex_count)),
      uv1(copy(memory, uploads, host.uv1, host.vertex_count)),
      boxes(memory, keys_of(host) > 1 ? host.triangle_count : 0, MemoryUse::vertices) {
    if (bent) upload_bent(uploads, host);
}

void GpuMesh::upload_bent(UploadQueue& uploads, const kernels::Geometry& host) const {
    uploads.add(vertices, {host.vertices, vertices.count()});
    if (host.tangents) uploads.add(tangents, {host.tangents, tangents.count()});
    if (boxes.count() > 0) uploads.add(boxes, boxes_of(host));
}

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
    if (boxes.count() > 0) {
        input.type = hiprt::PrimitiveType::aabb_list;
        input.geometry_type = kernels::geometry_type::kMoving;
        input.list = {boxes.pointer(), host.triangle_count, sizeof(kernels::TriangleBox)};
        return input;
    }
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
