#include "scene/tangents.h"

#include <algorithm>
#include <cmath>

namespace kadr {

namespace {

using kernels::Vec2f;
using kernels::Vec3f;
using kernels::Vec4f;

float length(Vec3f v) { return std::sqrt(dot(v, v)); }
Vec3f normalised(Vec3f v, Vec3f otherwise) {
    const float l = length(v);
    return l > 0 && std::isfinite(l) ? v * (1.0f / l) : otherwise;
}
Vec3f face_normal(Vec3f a, Vec3f b, Vec3f c) { return normalised(cross(b - a, c - a), {0, 0, 1}); }

/// Some direction in the plane of `normal`, for triangles whose texture coordinates have no direction.
Vec3f any_tangent(Vec3f normal) {
    const Vec3f axis = std::abs(normal.x) < 0.9f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0};
    return normalised(axis - normal * dot(normal, axis), {1, 0, 0});
}

template <class T>
void unshare(std::vector<T>& values, const std::vector<std::uint32_t>& indices) {
    if (values.empty()) return;
    std::vector<T> result;
    result.reserve(indices.size());
    for (const std::uint32_t index : indices) result.push_back(values[index]);
    values = std::move(result);
}

void unshare_vertices(GeometryData& g) {
    unshare(g.positions, g.indices);
    unshare(g.uv[0], g.indices);
    unshare(g.uv[1], g.indices);
    unshare(g.colors, g.indices);
    for (std::size_t i = 0; i < g.indices.size(); ++i) g.indices[i] = static_cast<std::uint32_t>(i);
}

float corner_angle(Vec3f at, Vec3f left, Vec3f right) {
    const Vec3f a = left - at, b = right - at;
    const float lengths = length(a) * length(b);
    return lengths > 0 ? std::acos(std::clamp(dot(a, b) / lengths, -1.0f, 1.0f)) : 0.0f;
}

/// Directions in which u and v grow on a triangle; false where the texture coordinates span no area.
bool uv_directions(const Vec3f p[3], const Vec2f uv[3], Vec3f& along_u, Vec3f& along_v) {
    const Vec3f e1 = p[1] - p[0], e2 = p[2] - p[0];
    const Vec2f d1 = uv[1] - uv[0], d2 = uv[2] - uv[0];
    const float area = d1.x * d2.y - d2.x * d1.y;
    if (area == 0 || !std::isfinite(area)) return false;
    const float sign = area > 0 ? 1.0f : -1.0f;  // the magnitude is normalised away
    along_u = normalised((e1 * d2.y - e2 * d1.y) * sign, {0, 0, 0});
    along_v = normalised((e2 * d1.x - e1 * d2.x) * sign, {0, 0, 0});
    return true;
}

}  // namespace

void add_tangents(GeometryData& g, int uv_set) {
    if (g.normals.empty()) unshare_vertices(g);
    const auto& uvs = g.uv[static_cast<std::size_t>(uv_set)];
    std::vector<Vec3f> sums(g.positions.size(), Vec3f{0, 0, 0});
    std::vector<float> handedness(g.positions.size(), 0.0f);
    std::vector<Vec3f> flat;
    if (g.normals.empty()) flat.resize(g.positions.size());
    for (std::size_t t = 0; t + 2 < g.indices.size(); t += 3) {
        const std::uint32_t* index = &g.indices[t];
        const Vec3f p[3] = {g.positions[index[0]], g.positions[index[1]], g.positions[index[2]]};
        const Vec2f uv[3] = {uvs[index[0]], uvs[index[1]], uvs[index[2]]};
        if (!flat.empty()) flat[index[0]] = flat[index[1]] = flat[index[2]] = face_normal(p[0], p[1], p[2]);
        Vec3f along_u, along_v;
        if (!uv_directions(p, uv, along_u, along_v)) continue;
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = index[corner];
            const Vec3f normal = flat.empty() ? g.normals[vertex] : flat[vertex];
            const float angle = corner_angle(p[corner], p[(corner + 1) % 3], p[(corner + 2) % 3]);
            const Vec3f tangent = normalised(along_u - normal * dot(normal, along_u), {0, 0, 0});
            sums[vertex] = sums[vertex] + tangent * angle;
            // v grows downward in the image, and the bitangent points up.
            handedness[vertex] += dot(cross(normal, tangent), along_v) < 0 ? angle : -angle;
        }
    }
    g.tangents.resize(g.positions.size());
    for (std::size_t v = 0; v < sums.size(); ++v) {
        const Vec3f tangent = normalised(sums[v], any_tangent(flat.empty() ? g.normals[v] : flat[v]));
        g.tangents[v] = {tangent.x, tangent.y, tangent.z, handedness[v] < 0 ? -1.0f : 1.0f};
    }
}

}  // namespace kadr
