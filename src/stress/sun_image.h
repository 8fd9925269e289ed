#pragma once

#include <filesystem>

namespace kadr::stress {

/// Solid angle of the bright pixel, steradians.
double sun_solid_angle();

/// Writes a latitude-longitude image of 64 x 32 pixels: all of one radiance but a pixel high above the front right,
/// a sun. Radiance HDR, whose values reach beyond those of half floats.  Source: Ward 1991, "Real Pixels".
/// @throws RenderError
void write_sun_image(const std::filesystem::path& file, double sky, double sun);

}  // namespace kadr::stress
