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

/// The point that everything of a frame is relative to: the camera's position at the shutter's opening, snapped to a
/// cubic grid whose cell is the largest power of two up to 128 times the distance of what the camera looks at.
/// Then a coordinate near the camera is at most 64 distances long, and a float holds it to 64 * 2^-24 = 4e-6 of that
/// distance: below a hundredth of a pixel. A camera within half a cell of the world's origin gets the origin itself, and
/// grids of different cells are nested, so that a static scene is hardly ever rebuilt.
glm::dvec3 render_origin(const glm::dvec3& camera_position, double subject_distance);

/// That origin, and the unit in which devices compute: the metre for subjects of everyday size, 0.25 m to 1000 km away;
/// else the power of two below their distance. Offsets of rays from flattened surfaces are made for coordinates of order
/// 1, and the fourth power of a scale has to be a float.
RenderSpace render_space(const glm::dvec3& camera_position, double subject_distance);

}  // namespace kadr
