#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "frame/render_space.h"
#include "kernels/scene/scene_types.h"
#include "scene/scene.h"

namespace kadr {

/// Vertices of a mesh as the kernels fetch them.
struct PackedGeometry {
    std::vector<kernels::Vertex> vertices;
    std::vector<kernels::Vec4f> tangents, colors;  ///< empty: the source's
    std::vector<kernels::Vec2f> uv1;               ///< empty: the source's
    std::vector<unsigned> indices;                 ///< empty: the source's

    /// In the mesh's own coordinates.
    explicit PackedGeometry(const GeometryData& source);
    /// Flattened: in a render space. Triangles that are far larger than their distance are subdivided.
    PackedGeometry(const GeometryData& source, const glm::dmat4& world_from_geometry, const RenderSpace& space);

    /// Points to what is here and to what is the source's.
    kernels::Geometry view(const GeometryData& source) const;

private:
    void allocate(const GeometryData& source);
    void subdivide(const GeometryData& source, std::vector<glm::dvec3>& positions);
};

}  // namespace kadr
