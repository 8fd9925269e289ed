#include "frame/render_origin.h"

#include <algorithm>
#include <cmath>

namespace kadr {

namespace {

constexpr double kCellDistances = 128;

glm::dvec3 snapped(const glm::dvec3& p, double largest_cell) {
    const double cell = std::exp2(std::floor(std::log2(largest_cell)));
    return glm::round(p / cell) * cell + 0.0;  // -0 would be another value to a hash
}

}  // namespace

glm::dvec3 render_origin(const glm::dvec3& camera_position, double subject_distance) {
    return snapped(camera_position, kCellDistances * std::clamp(subject_distance, 1e-30, 1e30));
}

RenderSpace render_space(const glm::dvec3& camera_position, const glm::dvec3& forward, double subject_distance, double pixel_rad, double shown_m) {
    constexpr double kSmallest_m = 0.25, kLargest_m = 0x1p20;
    const double distance = std::clamp(subject_distance, 1e-30, 1e30), shown = std::clamp(shown_m, 1e-30, 1e30);
    const bool everyday = shown >= kSmallest_m && shown <= kLargest_m;
    const double unit_m = everyday ? 1.0 : std::exp2(std::floor(std::log2(shown)));
    // Half a cell times 2^-24 is a hundredth of a pixel at the subject.
    const double cell = 0.02 * 0x1p24 * pixel_rad * distance;
    if (pixel_rad > 0 && cell < 2 * distance) return {snapped(camera_position + forward * distance, cell), unit_m};
    return {render_origin(camera_position, subject_distance), unit_m};
}

}  // namespace kadr
