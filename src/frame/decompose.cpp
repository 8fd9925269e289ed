#include "frame/decompose.h"

#include <algorithm>
#include <cmath>

namespace kadr {

namespace {

constexpr double kLargestHarmlessShear = 1e-6;
constexpr double kSmallestScale = 1e-7;

double largest_scale(const Decomposition& parts) {
    return std::max({std::abs(parts.scale.x), std::abs(parts.scale.y), std::abs(parts.scale.z)});
}

/// Any unit vector at right angles to a unit vector.
glm::dvec3 perpendicular(const glm::dvec3& axis) {
    const glm::dvec3 other = std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(glm::cross(axis, other));
}

glm::dvec3 direction_or(const glm::dvec3& vector, const glm::dvec3& fallback, double& length) {
    length = glm::length(vector);
    return length > 0 ? vector / length : fallback;
}

}  // namespace

Decomposition decompose(const glm::dmat4& transform) {
    Decomposition parts;
    const glm::dvec3 x(transform[0]), y(transform[1]), z(transform[2]);
    parts.translation = glm::dvec3(transform[3]);
    const glm::dvec3 first = direction_or(x, {1, 0, 0}, parts.scale.x);
    parts.shear.x = glm::dot(first, y);
    const glm::dvec3 second = direction_or(y - first * parts.shear.x, perpendicular(first), parts.scale.y);
    // Once more: where two columns are nearly parallel, one pass leaves a rounding error that is not small beside the rest.
    const glm::dvec3 second_exact = glm::normalize(second - first * glm::dot(first, second));
    const glm::dvec3 third = glm::cross(first, second_exact);
    parts.shear.y = glm::dot(first, z);
    parts.shear.z = glm::dot(second_exact, z);
    parts.scale.z = glm::dot(third, z);
    parts.rotation = glm::normalize(glm::quat_cast(glm::dmat3(first, second_exact, third)));
    return parts;
}

glm::dmat4 compose(const Decomposition& parts) {
    const glm::dmat3 r = glm::mat3_cast(parts.rotation);
    return {glm::dvec4(r[0] * parts.scale.x, 0), glm::dvec4(r[0] * parts.shear.x + r[1] * parts.scale.y, 0),
            glm::dvec4(r[0] * parts.shear.y + r[1] * parts.shear.z + r[2] * parts.scale.z, 0),
            glm::dvec4(parts.translation, 1)};
}

Decomposition interpolate(const Decomposition& a, const Decomposition& b, double u) {
    return {slerp_shorter(a.rotation, b.rotation, u), glm::mix(a.scale, b.scale, u), glm::mix(a.shear, b.shear, u),
            glm::mix(a.translation, b.translation, u)};
}

bool is_sheared(const Decomposition& parts) {
    const double shear = std::max({std::abs(parts.shear.x), std::abs(parts.shear.y), std::abs(parts.shear.z)});
    return shear > kLargestHarmlessShear * largest_scale(parts);
}

bool is_singular(const Decomposition& parts) {
    const double smallest = std::min({std::abs(parts.scale.x), std::abs(parts.scale.y), std::abs(parts.scale.z)});
    return !(smallest > kSmallestScale * largest_scale(parts)) || smallest < 1e-30;
}

bool is_finite(const glm::dmat4& transform) {
    double sum = 0;  // NaN and infinity survive a sum of zeros times the entries
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) sum += 0 * transform[column][row];
    return sum == 0;
}

double angle_between(const glm::dquat& a, const glm::dquat& b) {
    const glm::dquat near = glm::dot(a, b) < 0 ? -b : b;
    return 4 * std::atan2(glm::length(a - near), glm::length(a + near));
}

glm::dquat slerp_shorter(const glm::dquat& a, glm::dquat b, double u) {
    if (glm::dot(a, b) < 0) b = -b;
    const double angle = 2 * std::atan2(glm::length(a - b), glm::length(a + b));
    if (angle < 1e-8) return glm::normalize(a * (1 - u) + b * u);
    const double sine = std::sin(angle);
    return a * (std::sin((1 - u) * angle) / sine) + b * (std::sin(u * angle) / sine);
}

}  // namespace kadr
