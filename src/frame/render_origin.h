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

/// That origin for a picture of ordinary angle, and the unit in which devices compute: the metre where the picture shows
/// something of everyday size, 0.25 m to 1000 km high; else the power of two below that size. Offsets of rays from flattened surfaces are
/// made for coordinates of order 1, and the fourth power of a scale has to be a float.
///
/// Through a long lens a pixel is so narrow that the subject itself needs the precision: there the origin lies on a grid
/// about the subject, whose cell shrinks with the pixel, so that rounding stays below a hundredth of it.
///
/// @param forward    unit, along the view axis
/// @param pixel_rad  angle of a pixel; 0: an orthographic picture
/// @param shown_m    height of what the picture shows at the subject's distance, or that distance where it is shorter
RenderSpace render_space(const glm::dvec3& camera_position, const glm::dvec3& forward, double subject_distance, double pixel_rad, double shown_m);

}  // namespace kadr
