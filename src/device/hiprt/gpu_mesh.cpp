#include "device/hiprt/gpu_mesh.h"

#include <algorithm>
#include <cmath>

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

void grow(TriangleBox& box, const kernels::Vec3f& p) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
}

/// By a few units in the last place of the largest coordinate: what rounding moves a ray in the mesh's space.
void pad(TriangleBox& box) {
    float largest = 0;
    for (const float x : {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z})
        largest = std::max(largest, std::abs(x));
    const float by = 1e-6f * largest;
    box.low = {box.low.x - by, box.low.y - by, box.low.z - by};
    box.high = {box.high.x + by, box.high.y + by, box.high.z + by};
}

}  // namespace

std::vector<TriangleBox> boxes_of(const kernels::Geometry& host) {
    std::vector<TriangleBox> boxes(host.triangle_count);
    for (unsigned t = 0; t < host.triangle_count; ++t) {
        const unsigned* corners = host.indices + std::size_t{3} * t;
        boxes[t] = {host.vertices[corners[0]].position, host.vertices[corners[0]].position};
        for (std::size_t k = 0; k < keys_of(host); ++k)
            for (int c = 0; c < 3; ++c) grow(boxes[t], host.vertices[k * host.vertex_count + corners[c]].position);
        pad(boxes[t]);
    }
    return boxes;
}

GpuMesh::GpuMesh(GpuMemory& memory, UploadQueue& uploads, const kernels::Geometry& host)
    : vertices(copy(memory, uploads, host.vertices, keys_of(host) * host.vertex_count)),
      indices(copy(memory, uploads, host.indices, std::size_t{3} * host.triangle_count)),
      tangents(copy(memory, uploads, host.tangents, keys_of(host) * host.vertex_count)),
      colors(copy(memory, uploads, host.colors, host.vertex_count)),
      uv1(copy(memory, uploads, host.uv1, host.vertex_count)) {
    if (keys_of(host) == 1) return;
    boxes = DeviceBuffer<TriangleBox>(memory, host.triangle_count, MemoryUse::vertices);
    uploads.add(boxes, boxes_of(host));
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
        input.list = {boxes.pointer(), host.triangle_count, sizeof(TriangleBox)};
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
