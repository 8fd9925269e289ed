#pragma once

#include "frame/camera_keys.h"
#include "frame/render_space.h"

namespace kadr {

/// The point that everything of a frame is relative to: what the camera looks at, at the shutter's opening, snapped to a
/// cubic grid. Its cell is the largest power of two up to 128 times the distance of that point, or in narrow views up to 128
/// times half the height of what is seen there.
/// Then a coordinate near what is seen is at most 64 distances and 64 half heights long, and a float holds it to
/// 64 * 2^-24 = 4e-6 of half the height: 0.002 pixels of 1080 lines. A camera that looks at something within half a cell
/// of the world's origin gets the origin itself, and grids of different cells are nested, so that a static scene is hardly
/// ever rebuilt.
glm::dvec3 render_origin(const CameraState& camera);

/// That origin, and the unit in which devices compute: the metre where the picture shows something of everyday size, 0.25 m
/// to 1000 km high; else the power of two below that size. Offsets of rays from flattened surfaces are made for coordinates
/// of order 1, and the fourth power of a scale has to be a float.
RenderSpace render_space(const CameraState& camera);

}  // namespace kadr
