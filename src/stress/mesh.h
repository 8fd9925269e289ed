#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace kadr::stress {

/// Triangles, counterclockwise from their front, with a normal a vertex.
struct Mesh {
    std::vector<glm::dvec3> positions, normals;  ///< as many of both
    std::vector<std::uint32_t> indices;          ///< three a triangle
};

/// Radius 1 about the origin, smooth, 960 triangles.
Mesh sphere();
/// The same with a bundle of narrow rings about the equator: their triangles are `aspect` times as long as high.
Mesh sliver_sphere(double aspect);

/// From -1 to 1 in x and z at y = 0, facing +y.
Mesh square();
/// The same with a bundle of narrow strips along its middle: `aspect` times as long as wide.
Mesh sliver_square(double aspect);
/// From -1 to 1 in x and z, flat in the middle, falling towards its rim. @param cells  along each side
Mesh terrain(int cells);
/// Radius 1 at y = 0, facing +y: triangles that meet in its middle.
Mesh disc(int triangles);

/// From -1 to 1 along every axis, with a hard edge between faces.
Mesh cube();
/// From the apex (0, 1, 0) to a rim of radius 1 at y = 0, open below, with hard edges: a fan.
Mesh cone(int triangles);
/// Half of the square from -1 to 1 in x and y, facing +z, as often as asked for on the same three vertices.
Mesh repeated_triangle(int times);

/// Adds triangles without area: single points, doubled edges and three points on a line in turn.
void add_empty_triangles(Mesh& mesh, int count);

}  // namespace kadr::stress
