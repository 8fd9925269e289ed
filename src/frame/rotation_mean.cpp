#include "frame/rotation_mean.h"

#include <algorithm>
#include <cmath>

#include "frame/decompose.h"

namespace kadr {

namespace {

constexpr int kMostSteps = 100;
constexpr double kClose = 1e-15;  // of half an angle: below the rounding of a product of quaternions

/// Half the rotation vector of a unit quaternion, by the shorter way.
glm::dvec3 log_of(glm::dquat q) {
    if (q.w < 0) q = -q;
    const glm::dvec3 v(q.x, q.y, q.z);
    const double sine = glm::length(v);
    return sine < 1e-15 ? v : v * (std::atan2(sine, q.w) / sine);
}

glm::dquat exp_of(const glm::dvec3& half) {
    const double angle = glm::length(half);
    const glm::dvec3 v = half * (angle < 1e-15 ? 1.0 : std::sin(angle) / angle);
    return {std::cos(angle), v.x, v.y, v.z};
}

/// The weighted sum with all on the side of the heaviest: near the mean, and it where all agree.
glm::dquat first_guess(std::span<const WeightedRotation> rotations) {
    const auto heaviest = std::max_element(rotations.begin(), rotations.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
    glm::dquat sum(0, 0, 0, 0);
    for (const WeightedRotation& r : rotations)
        sum += r.rotation * (glm::dot(heaviest->rotation, r.rotation) < 0 ? -r.weight : r.weight);
    return glm::length(sum) > 1e-9 ? glm::normalize(sum) : heaviest->rotation;
}

}  // namespace

glm::dquat mean_rotation(std::span<const WeightedRotation> rotations) {
    if (rotations.size() == 1) return rotations[0].rotation;
    double total = 0;
    for (const WeightedRotation& r : rotations) total += r.weight;
    if (rotations.size() == 2) return slerp_shorter(rotations[0].rotation, rotations[1].rotation, rotations[1].weight / total);
    glm::dquat mean = first_guess(rotations);
    for (int step = 0; step < kMostSteps; ++step) {
        glm::dvec3 towards(0);
        for (const WeightedRotation& r : rotations) towards += log_of(glm::conjugate(mean) * r.rotation) * (r.weight / total);
        mean = glm::normalize(mean * exp_of(towards));
        if (glm::length(towards) < kClose) break;
    }
    return mean;
}

}  // namespace kadr
