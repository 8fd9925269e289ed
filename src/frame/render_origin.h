#pragma once

#include <glm/glm.hpp>

namespace kadr {

/// The point that everything of a frame is relative to: the camera's position at the shutter's opening, snapped to a
/// cubic grid whose cell is the largest power of two up to 128 times the distance of what the camera looks at.
/// Then a coordinate near the camera is at most 64 distances long, and a float holds it to 64 * 2^-24 = 4e-6 of that
/// distance: below a hundredth of a pixel. A camera within half a cell of the world's origin gets the origin itself, and
/// grids of different cells are nested, so that a static scene is hardly ever rebuilt.
glm::dvec3 render_origin(const glm::dvec3& camera_position, double subject_distance);

}  // namespace kadr
