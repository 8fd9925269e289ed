#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "device/device.h"
#include "frame/frame_state.h"
#include "frame/snapshot.h"

namespace kadr {

/// What a device says that a ray met.
struct SeenSurface {
    bool met = false;
    std::string node, mesh;  ///< "scene/Parent/Node" and the mesh's name
    int primitive = -1;      ///< triangle of the mesh
    double distance_m = 0;
};

/// A ray that two devices answer differently beyond what edges and rounding explain.
struct BadPixel {
    int frame = 0, x = 0, y = 0;
    double time = 0;  ///< in [0, 1] of the frame's shutter, or of its part
    SeenSurface first, second;
};

/// How two devices answer the same camera rays, through the centres of all pixels at several times of the shutter.
///
/// A ray that meets another triangle on each is not always an error: within an error bar of the ray there may be an
/// edge, of which it meets one side here and the other there, or slips between both (HIPRT's triangle test is not
/// watertight); or both surfaces lie in one place. The bar is what floats leave of a ray's and a surface's place, in
/// pixels. Around such a ray, eight more are sent at twice the bar: where both devices see an edge among them, it was
/// an edge.
struct RayAgreement {
    std::uint64_t rays = 0;
    std::uint64_t other_ids = 0;     ///< met another instance or triangle, or nothing where the other met something
    std::uint64_t at_edges = 0;      ///< of them, explained by an edge within the error bar
    std::uint64_t same_place = 0;    ///< of them, explained by surfaces in one place
    std::uint64_t wrong_ids = 0;     ///< of them, explained by neither
    std::uint64_t wrong_places = 0;  ///< met the same triangle elsewhere, beyond the error bar
    double error_bar_px = 0;         ///< the largest that was allowed
    double place_error = 0;          ///< largest distance of places where ids agree, over that from the camera
    std::optional<BadPixel> first_bad;

    std::uint64_t wrong() const { return wrong_ids + wrong_places; }
};
/// Counts add up, errors are the larger ones, the first bad pixel stays.
RayAgreement operator+(const RayAgreement& a, const RayAgreement& b);

/// @param motion_error_px  what one of the devices may know of motion that the other does not (the reference in double
///                         follows tracks, not keys)
/// @pre both have a probe and were given this snapshot of the shot
RayAgreement compare_rays(const BoundShot& shot, Device& first, Device& second, const SceneSnapshot& snapshot,
                          double motion_error_px);

}  // namespace kadr
