#include "frame/view_axes.h"

#include <cmath>

namespace kadr {

namespace {

glm::dvec3 farthest_axis(const glm::dvec3& forward) {
    constexpr glm::dvec3 kAxes[] = {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}};
    glm::dvec3 best = kAxes[0];
    for (const glm::dvec3& axis : kAxes)
        if (std::abs(glm::dot(axis, forward)) < std::abs(glm::dot(best, forward)) - 1e-3) best = axis;
    return best;
}

}  // namespace

ViewAxes view_axes(const glm::dvec3& forward, const glm::dvec3& up) {
    constexpr double kParallel = 1e-9;
    glm::dvec3 right = glm::cross(forward, up);
    if (!(glm::length(right) > kParallel * glm::length(up))) right = glm::cross(forward, farthest_axis(forward));
    right = glm::normalize(right);
    return {right, glm::cross(right, forward)};
}

glm::dquat look_rotation(const glm::dvec3& forward, const glm::dvec3& up) {
    const ViewAxes axes = view_axes(forward, up);
    return glm::normalize(glm::quat_cast(glm::dmat3(axes.right, axes.up, -forward)));
}

}  // namespace kadr
