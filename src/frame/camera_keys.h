#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "frame/frame_state.h"
#include "frame/render_space.h"
#include "kernels/scene/scene_types.h"

namespace kadr {

/// The camera at one time, in the world, in double.
struct CameraState {
    glm::dvec3 position{0};
    glm::dquat rotation{1, 0, 0, 0};  ///< world_from_camera; looks along -z, +y up
    bool orthographic = false;
    double tan_half_width = 1, tan_half_height = 1;  ///< as in kernels::CameraKey
    double lens_radius = 0, focus_distance = 1;      ///< metres
    double subject_distance = 1;  ///< how far away what it looks at is, roughly: the scale for "precise enough"
    double start_m = 0;           ///< of rays, as in kernels::CameraKey (camera_start)
    bool operator==(const CameraState&) const = default;
};

/// @throws InputError  where the camera stands on what it looks at, or focuses behind itself
CameraState camera_at(const BoundShot& shot, double time_s);

/// As kernels read it, in a render space. T: float or double.
template <class T>
kernels::CameraKeyOf<T> to_key(const CameraState& camera, const RenderSpace& space);

struct CameraFit {
    std::vector<kernels::CameraKey> keys;  ///< evenly spaced, in the render space
    double error_px = 0;                   ///< how far the subject's image strays from where the true camera has it, at most
    std::vector<double> corners_s;         ///< keys of its tracks: good times to split the shutter at where the error is too large
};

/// Keys over a part of the shutter: one when the camera is still, else as many as the motion tolerance and 10 degrees a
/// step ask for, and no more than 129: then the error is above the tolerance.
/// @param start_m  CameraState::start_m of all keys
CameraFit fit_camera(const BoundShot& shot, double open_s, double close_s, const RenderSpace& space, double start_m = 0);

/// The parts of the camera that do not change within a part of the shutter; its clip planes are those of `time_s`.
kernels::Camera make_camera(const BoundShot& shot, double time_s);

/// Jumps and keys of everything the camera depends on, inside (begin, end).
std::vector<double> camera_discontinuities(const BoundShot& shot, double begin_s, double end_s);

/// World-space error of a point as pixels: what a displacement looks like from the camera at that time.
class PixelScale {
public:
    PixelScale(const CameraState& camera, int image_height);
    /// An upper bound for a point at `point` that is displaced by `distance`; `nearest` keeps points beside or behind
    /// the camera from counting without limit.
    double pixels(double distance, const glm::dvec3& point, double nearest) const {
        if (orthographic_) return distance * scale_;
        const glm::dvec3 to_point = point - position_;
        const double along = glm::dot(to_point, forward_);
        const double depth = along > nearest ? along : nearest;
        // A displacement towards the camera shows the more the farther out the point is; the image's corner is the farthest.
        const double aside = (glm::dot(to_point, to_point) - along * along) / (depth * depth);
        return distance * scale_ / depth * std::sqrt(1 + std::min(std::max(aside, 0.0), corner_));
    }
    /// An upper bound of that for all points within `radius` of `centre`.
    double most_pixels(double distance, const glm::dvec3& centre, double radius, double nearest) const {
        if (orthographic_) return distance * scale_;
        const double depth = std::max(glm::dot(centre - position_, forward_) - radius, nearest);
        return distance * scale_ / depth * std::sqrt(1 + corner_);
    }

private:
    glm::dvec3 position_, forward_;
    double scale_, corner_;
    bool orthographic_;
};

}  // namespace kadr
