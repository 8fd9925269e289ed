#include "stress/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace kadr::stress {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSlices = 32, kRings = 16;
constexpr int kSlivers = 16;  // of a bundle: many of them lie under every pixel that it crosses

std::uint32_t add_vertex(Mesh& mesh, const glm::dvec3& position, const glm::dvec3& normal) {
    mesh.positions.push_back(position);
    mesh.normals.push_back(normal);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh.indices.insert(mesh.indices.end(), {a, b, c}); }

/// Corners counterclockwise from the front.
void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    add_triangle(mesh, a, b, c);
    add_triangle(mesh, a, c, d);
}

std::vector<double> even_steps(double from, double to, int steps) {
    std::vector<double> values;
    for (int i = 0; i <= steps; ++i) values.push_back(from + (to - from) * i / steps);
    return values;
}

/// Even steps whose middle one is replaced by a bundle of narrow ones.
std::vector<double> steps_with_bundle(double from, double to, int steps, double width) {
    std::vector<double> values = even_steps(from, to, steps);
    const double middle = 0.5 * (from + to);
    std::erase_if(values, [&](double value) { return std::abs(value - middle) <= 0.5 * kSlivers * width; });
    for (int i = 0; i <= kSlivers; ++i) values.push_back(middle + width * (i - 0.5 * kSlivers));
    std::sort(values.begin(), values.end());
    return values;
}

glm::dvec3 on_rim(int i, int count) {
    const double angle = 2 * kPi * i / count;
    return {std::cos(angle), 0, -std::sin(angle)};
}

/// Smooth, radius 1: rings of triangles between latitudes, which ascend in radians from the equator and begin and end at a pole.
Mesh globe(const std::vector<double>& latitudes) {
    Mesh mesh;
    for (const double latitude : latitudes)
        for (int slice = 0; slice <= kSlices; ++slice) {
            const glm::dvec3 rim = std::cos(latitude) * on_rim(slice, kSlices);
            const glm::dvec3 p(rim.x, std::sin(latitude), rim.z);
            add_vertex(mesh, p, p);
        }
    constexpr std::uint32_t kRow = kSlices + 1;
    const auto rings = static_cast<std::uint32_t>(latitudes.size() - 1);
    for (std::uint32_t ring = 0; ring < rings; ++ring)
        for (std::uint32_t a = ring * kRow; a + 1 < (ring + 1) * kRow; ++a) {
            if (ring > 0) add_triangle(mesh, a, a + 1, a + 1 + kRow);
            if (ring + 1 < rings) add_triangle(mesh, a, a + 1 + kRow, a + kRow);
        }
    return mesh;
}

/// Strips along z between ascending x, from z = -1 to 1 at y = 0, facing +y.
Mesh strips(const std::vector<double>& edges) {
    Mesh mesh;
    const glm::dvec3 up(0, 1, 0);
    for (const double x : edges) {
        add_vertex(mesh, {x, 0, 1}, up);
        add_vertex(mesh, {x, 0, -1}, up);
    }
    for (std::uint32_t i = 0; i + 1 < edges.size(); ++i) add_quad(mesh, 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
    return mesh;
}

constexpr double kFlatPart = 0.1, kFall = 0.1;

double terrain_height(double x, double z) {
    const double beyond = std::max(0.0, std::hypot(x, z) - kFlatPart);
    return -kFall * beyond * beyond;
}

glm::dvec3 terrain_normal(double x, double z) {
    const double r = std::hypot(x, z), slope = r > kFlatPart ? 2 * kFall * (r - kFlatPart) / r : 0;
    return glm::normalize(glm::dvec3(slope * x, 1, slope * z));
}

}  // namespace

Mesh sphere() { return globe(even_steps(-0.5 * kPi, 0.5 * kPi, kRings)); }

Mesh sliver_sphere(double aspect) {
    const double side = 2 * kPi / kSlices;
    return globe(steps_with_bundle(-0.5 * kPi, 0.5 * kPi, kRings, side / aspect));
}

Mesh square() { return strips({-1, 1}); }

Mesh sliver_square(double aspect) { return strips(steps_with_bundle(-1, 1, 8, 2 / aspect)); }

Mesh terrain(int cells) {
    Mesh mesh;
    const std::vector<double> steps = even_steps(-1, 1, cells);
    for (const double z : steps)
        for (const double x : steps) add_vertex(mesh, {x, terrain_height(x, z), z}, terrain_normal(x, z));
    const auto row = static_cast<std::uint32_t>(cells + 1);
    for (std::uint32_t i = 0; i + row < mesh.positions.size(); ++i)
        if ((i + 1) % row != 0) add_quad(mesh, i, i + row, i + row + 1, i + 1);
    return mesh;
}

Mesh cube() {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            glm::dvec3 normal(0), u(0), v(0);
            normal[axis] = side;
            u[(axis + 1) % 3] = 1;
            v[(axis + 2) % 3] = side;
            const std::uint32_t first = add_vertex(mesh, normal - u - v, normal);
            add_vertex(mesh, normal + u - v, normal);
            add_vertex(mesh, normal + u + v, normal);
            add_vertex(mesh, normal - u + v, normal);
            add_quad(mesh, first, first + 1, first + 2, first + 3);
        }
    return mesh;
}

Mesh disc(int triangles) {
    Mesh mesh;
    const glm::dvec3 up(0, 1, 0);
    const std::uint32_t middle = add_vertex(mesh, {0, 0, 0}, up);
    for (int i = 0; i < triangles; ++i) add_vertex(mesh, on_rim(i, triangles), up);
    const auto count = static_cast<std::uint32_t>(triangles);
    for (std::uint32_t i = 0; i < count; ++i) add_triangle(mesh, middle, 1 + i, 1 + (i + 1) % count);
    return mesh;
}

Mesh cone(int triangles) {
    Mesh mesh;
    const glm::dvec3 apex(0, 1, 0);
    for (int i = 0; i < triangles; ++i) {
        const glm::dvec3 a = on_rim(i, triangles), b = on_rim(i + 1, triangles), normal = glm::normalize(glm::cross(a - apex, b - apex));
        const std::uint32_t first = add_vertex(mesh, apex, normal);
        add_vertex(mesh, a, normal);
        add_vertex(mesh, b, normal);
        add_triangle(mesh, first, first + 1, first + 2);
    }
    return mesh;
}

Mesh repeated_triangle(int times) {
    Mesh mesh;
    const glm::dvec3 front(0, 0, 1);
    add_vertex(mesh, {-1, -1, 0}, front);
    add_vertex(mesh, {1, -1, 0}, front);
    add_vertex(mesh, {1, 1, 0}, front);
    mesh.indices.reserve(3 * static_cast<std::size_t>(times));
    for (int i = 0; i < times; ++i) add_triangle(mesh, 0, 1, 2);
    return mesh;
}

void add_empty_triangles(Mesh& mesh, int count) {
    const std::size_t triangles = mesh.indices.size() / 3;
    for (int i = 0; i < count; ++i) {
        const std::size_t at = 3 * (static_cast<std::size_t>(i) % triangles);
        const std::uint32_t a = mesh.indices[at], b = mesh.indices[at + 1];
        if (i % 3 == 0) add_triangle(mesh, a, a, a);
        if (i % 3 == 1) add_triangle(mesh, a, b, b);
        if (i % 3 == 2) add_triangle(mesh, a, b, add_vertex(mesh, 0.5 * (mesh.positions[a] + mesh.positions[b]), mesh.normals[a]));
    }
}

}  // namespace kadr::stress
