#include "frame/render_origin.h"

#include <algorithm>
#include <cmath>

namespace kadr {

namespace {

/// Of what is seen at the distance of the subject.
double half_height_m(const CameraState& camera) {
    return camera.orthographic ? camera.tan_half_height : camera.tan_half_height * camera.subject_distance;
}

double power_of_two_below(double x) { return std::exp2(std::floor(std::log2(x))); }

}  // namespace

glm::dvec3 render_origin(const CameraState& camera) {
    constexpr double kCellDistances = 128, kCellHalfHeights = 128;
    const glm::dvec3 subject = camera.position + camera.rotation * glm::dvec3(0, 0, -camera.subject_distance);
    const double widest = std::min(kCellDistances * camera.subject_distance, kCellHalfHeights * half_height_m(camera));
    const double cell = power_of_two_below(std::clamp(widest, 1e-28, 1e32));
    const glm::dvec3 origin = glm::round(subject / cell) * cell;
    return origin + 0.0;  // -0 would be another value to a hash
}

RenderSpace render_space(const CameraState& camera) {
    constexpr double kSmallest_m = 0.25, kLargest_m = 0x1p20;
    // A wide view shows the more of what is near: the distance is its size.
    const double height = 2 * half_height_m(camera), shown = std::clamp(camera.orthographic ? height : std::min(height, camera.subject_distance), 1e-30, 1e30);
    const bool everyday = shown >= kSmallest_m && shown <= kLargest_m;
    return {render_origin(camera), everyday ? 1.0 : power_of_two_below(shown)};
}

}  // namespace kadr
