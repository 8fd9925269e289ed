#include "device/tables/packed_geometry.h"

namespace kadr {
namespace {

kernels::Vec3f to_float(const glm::dvec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
glm::dvec3 to_double(kernels::Vec3f v) { return {v.x, v.y, v.z}; }

}  // namespace

PackedGeometry::PackedGeometry(const GeometryData& source) {
    allocate(source);
    for (std::size_t i = 0; i < source.positions.size(); ++i) vertices[i].position = source.positions[i];
    for (std::size_t i = 0; i < source.normals.size(); ++i) vertices[i].normal = source.normals[i];
}

PackedGeometry::PackedGeometry(const GeometryData& source, const glm::dmat4& world_from_geometry,
                               const RenderSpace& space) {
    const glm::dmat4 space_from_geometry = space.from_world(world_from_geometry);
    const glm::dmat3 linear(space_from_geometry);
    const glm::dvec3 shift(space_from_geometry[3]);
    const bool mirrored = glm::determinant(linear) < 0;
    const glm::dmat3 normal_matrix = glm::transpose(glm::inverse(linear));
    allocate(source);
    for (std::size_t i = 0; i < source.positions.size(); ++i)
        vertices[i].position = to_float(linear * to_double(source.positions[i]) + shift);
    for (std::size_t i = 0; i < source.normals.size(); ++i)
        vertices[i].normal = to_float(glm::normalize(normal_matrix * to_double(source.normals[i])));
    tangents.resize(source.tangents.size());
    for (std::size_t i = 0; i < tangents.size(); ++i) {
        const kernels::Vec4f t = source.tangents[i];
        const glm::dvec3 d = linear * glm::dvec3(t.x, t.y, t.z);
        const double length = glm::length(d);
        const kernels::Vec3f v = to_float(length > 0 ? d / length : d);
        tangents[i] = {v.x, v.y, v.z, mirrored ? -t.w : t.w};
    }
    if (!mirrored) return;
    indices = source.indices;  // a mirror turns the winding round; turn it back, so that the front stays the front
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
}

kernels::Geometry PackedGeometry::view(const GeometryData& source) const {
    kernels::Geometry g{};
    g.vertices = vertices.data();
    g.vertex_count = static_cast<unsigned>(vertices.size());
    g.indices = indices.empty() ? source.indices.data() : indices.data();
    g.triangle_count = static_cast<unsigned>(source.indices.size() / 3);
    if (!source.tangents.empty()) g.tangents = tangents.empty() ? source.tangents.data() : tangents.data();
    if (!source.uv[1].empty()) g.uv1 = source.uv[1].data();
    if (!source.colors.empty()) g.colors = source.colors.data();
    return g;
}

void PackedGeometry::allocate(const GeometryData& source) {
    vertices.assign(source.positions.size(), {{0, 0, 0}, {0, 0, 0}, {0, 0}});
    for (std::size_t i = 0; i < source.uv[0].size(); ++i) vertices[i].uv = source.uv[0][i];
}

}  // namespace kadr
