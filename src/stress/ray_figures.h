#pragma once

#include <cstdint>

#include "device/device.h"
#include "frame/snapshot.h"

namespace kadr::stress {

/// How many single rays of a device contradict the reference. Only clear cases count: those that the reference answers
/// the same for five rays a tenth of a pixel apart, so that an edge that lies within that of a ray is nobody's error.
struct RayFigures {
    std::uint64_t camera_rays = 0;       ///< of a clear answer
    std::uint64_t holes = 0;             ///< passed through a surface, or met one where nothing is
    std::uint64_t wrong_surfaces = 0;    ///< met another material than is in front
    double position_error_px = 0;        ///< largest, of the point that was met, in the picture
    double position_error_ulp = 0;       ///< the same, in units in the last place (of float) of its largest coordinate
    std::uint64_t shadow_rays = 0;       ///< of a clear answer, in every direction
    std::uint64_t light_rays = 0;        ///< of a clear answer, to points of the lights
    std::uint64_t false_shadows = 0, leaks = 0;  ///< of both

    std::uint64_t errors() const { return holes + wrong_surfaces + false_shadows + leaks; }
    bool operator==(const RayFigures&) const = default;
};
/// Counts add up, errors are the larger ones.
RayFigures operator+(const RayFigures& a, const RayFigures& b);

struct RayCounts {
    int per_pixel_edge = 1;   ///< camera rays: this squared in every pixel, on an even grid
    int directions = 8;       ///< shadow rays from each point that was met, and as many to each light
};

/// Sends rays through both devices, which were given the same snapshot, at the shutter's opening.
/// @pre both have a probe
RayFigures compare_rays(Device& device, Device& reference, const SceneSnapshot& snapshot, const RayCounts& counts);

}  // namespace kadr::stress
