#include "device/tables/packed_geometry.h"

#include <utility>

#include "device/tables/subdivide.h"

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
    std::vector<glm::dvec3> positions(source.positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = linear * to_double(source.positions[i]) + shift;
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
    subdivide(source, positions);
    for (std::size_t i = 0; i < positions.size(); ++i) vertices[i].position = to_float(positions[i]);
    if (!mirrored) return;
    if (indices.empty()) indices = source.indices;
    // A mirror turns the winding round; turn it back, so that the front stays the front.
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
}

/// Attributes in the middle of an edge are the mean of its ends', as interpolation over the whole triangle has them.
void PackedGeometry::subdivide(const GeometryData& source, std::vector<glm::dvec3>& positions) {
    Subdivision finer = subdivide_near_origin(positions, source.indices);
    if (finer.indices.empty()) return;
    indices = std::move(finer.indices);
    uv1 = source.uv[1];
    colors = source.colors;
    const auto mean = [](kernels::Vec4f a, kernels::Vec4f b) {
        return kernels::Vec4f{0.5f * (a.x + b.x), 0.5f * (a.y + b.y), 0.5f * (a.z + b.z), 0.5f * (a.w + b.w)};
    };
    for (const Midpoint& m : finer.added) {
        const kernels::Vertex a = vertices[m.a], b = vertices[m.b];
        vertices.push_back({{0, 0, 0}, (a.normal + b.normal) * 0.5f, (a.uv + b.uv) * 0.5f});
        if (!tangents.empty()) tangents.push_back(mean(tangents[m.a], tangents[m.b]));
        if (!uv1.empty()) uv1.push_back((uv1[m.a] + uv1[m.b]) * 0.5f);
        if (!colors.empty()) colors.push_back(mean(colors[m.a], colors[m.b]));
    }
}

kernels::Geometry PackedGeometry::view(const GeometryData& source) const {
    kernels::Geometry g{};
    g.vertices = vertices.data();
    g.vertex_count = static_cast<unsigned>(vertices.size());
    g.indices = indices.empty() ? source.indices.data() : indices.data();
    g.triangle_count = static_cast<unsigned>((indices.empty() ? source.indices.size() : indices.size()) / 3);
    if (!source.tangents.empty()) g.tangents = tangents.empty() ? source.tangents.data() : tangents.data();
    if (!source.uv[1].empty()) g.uv1 = uv1.empty() ? source.uv[1].data() : uv1.data();
    if (!source.colors.empty()) g.colors = colors.empty() ? source.colors.data() : colors.data();
    return g;
}

void PackedGeometry::allocate(const GeometryData& source) {
    vertices.assign(source.positions.size(), {{0, 0, 0}, {0, 0, 0}, {0, 0}});
    for (std::size_t i = 0; i < source.uv[0].size(); ++i) vertices[i].uv = source.uv[0][i];
}

}  // namespace kadr
