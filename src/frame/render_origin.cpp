#include "frame/render_origin.h"

#include <algorithm>
#include <cmath>

namespace kadr {

glm::dvec3 render_origin(const glm::dvec3& camera_position, double subject_distance) {
    constexpr double kCellDistances = 128;
    const double distance = std::clamp(subject_distance, 1e-30, 1e30);
    const double cell = std::exp2(std::floor(std::log2(kCellDistances * distance)));
    const glm::dvec3 origin = glm::round(camera_position / cell) * cell;
    return origin + 0.0;  // -0 would be another value to a hash
}

RenderSpace render_space(const glm::dvec3& camera_position, double subject_distance) {
    constexpr double kNearest_m = 0.25, kFarthest_m = 0x1p20;
    const double distance = std::clamp(subject_distance, 1e-30, 1e30);
    const bool everyday = distance >= kNearest_m && distance <= kFarthest_m;
    return {render_origin(camera_position, subject_distance), everyday ? 1.0 : std::exp2(std::floor(std::log2(distance)))};
}

}  // namespace kadr
