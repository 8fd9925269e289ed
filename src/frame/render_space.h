#pragma once

#include <glm/glm.hpp>

namespace kadr {

/// The coordinates of a frame's snapshot: a point of the world is origin + unit_m * its coordinates.
struct RenderSpace {
    glm::dvec3 origin{0};  ///< metres
    double unit_m = 1;     ///< a power of two, so that dividing by it rounds nothing
    bool operator==(const RenderSpace&) const = default;

    glm::dvec3 from_world(const glm::dvec3& p) const { return (p - origin) / unit_m; }
    /// space_from_x of a world_from_x.
    glm::dmat4 from_world(const glm::dmat4& world_from_x) const {
        glm::dmat4 m = world_from_x;
        for (int i = 0; i < 3; ++i) m[3][i] -= origin[i];
        for (glm::dmat4::length_type c = 0; c < 4; ++c)
            for (int i = 0; i < 3; ++i) m[c][i] /= unit_m;
        return m;
    }
};

}  // namespace kadr
