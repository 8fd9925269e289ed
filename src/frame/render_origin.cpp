#include "frame/render_origin.h"

#include <algorithm>
#include <cmath>

namespace kadr {

namespace {

/// Of what is seen at the distance of the subject.
double half_height_m(const CameraState& camera) {
    return camera.orthographic ? camera.tan_half_height : camera.tan_half_height * camera.subject_distance;
}

}  // namespace

glm::dvec3 render_origin(const CameraState& camera) {
    constexpr double kCellDistances = 128, kCellHalfHeights = 512;
    const glm::dvec3 subject = camera.position + camera.rotation * glm::dvec3(0, 0, -camera.subject_distance);
    const double widest = std::clamp(std::min(kCellDistances * camera.subject_distance, kCellHalfHeights * half_height_m(camera)), 1e-28, 1e32);
    const double cell = std::exp2(std::floor(std::log2(widest)));
    const glm::dvec3 origin = glm::round(subject / cell) * cell;
    return origin + 0.0;  // -0 would be another value to a hash
}

}  // namespace kadr
