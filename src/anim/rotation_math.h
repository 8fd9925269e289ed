#pragma once

#include <cmath>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kadr {

/// Slerp without a change of sign; the angle by atan2, which stays exact for tiny and for wide arcs.
inline glm::dquat arc(const glm::dquat& a, const glm::dquat& b, double u) {
    const glm::dquat difference = a - b, sum = a + b;
    const double angle = 2 * std::atan2(glm::length(difference), glm::length(sum));
    const double sine = std::sin(angle);
    if (angle < 1e-9 || sine < 1e-12) return glm::normalize(a * (1 - u) + b * u);
    return a * (std::sin((1 - u) * angle) / sine) + b * (std::sin(u * angle) / sine);
}

/// Of b and -b, which are one rotation, the one nearer to a.
inline glm::dquat nearer(const glm::dquat& a, const glm::dquat& b) { return glm::dot(a, b) < 0 ? -b : b; }

/// Half the rotation vector of a unit quaternion.
inline glm::dvec3 log_of(const glm::dquat& q) {
    const glm::dvec3 v(q.x, q.y, q.z);
    const double sine = glm::length(v);
    return sine < 1e-15 ? v : v * (std::atan2(sine, q.w) / sine);
}

/// The unit quaternion whose log_of is `half`, up to whole turns.
inline glm::dquat exp_of(const glm::dvec3& half) {
    const double angle = glm::length(half);
    const glm::dvec3 v = half * (angle < 1e-15 ? 1.0 : std::sin(angle) / angle);
    return {std::cos(angle), v.x, v.y, v.z};
}

/// log(from^-1 * to) by the shorter arc.
inline glm::dvec3 step_between(const glm::dquat& from, const glm::dquat& to) {
    return log_of(glm::conjugate(from) * nearer(from, to));
}

}  // namespace kadr
