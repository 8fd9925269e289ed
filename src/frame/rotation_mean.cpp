#include "frame/rotation_mean.h"

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "anim/rotation_math.h"
#include "frame/decompose.h"

namespace kadr {

namespace {

constexpr int kMostSteps = 100;
constexpr int kMostSquarings = 50;    // tells eigenvalues apart that differ by 1e-14 of themselves
constexpr double kClose = 1e-15;      // of half an angle: below the rounding of a product of quaternions
constexpr double kOnThePlane = 1e-9;  // a cosine whose sign is rounding
constexpr double kNothing = 1e-12;    // a weight beside which the rest is everything

glm::dvec4 vector_of(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }

double trace(const glm::dmat4& m) { return m[0][0] + m[1][1] + m[2][2] + m[3][3]; }

/// Of a symmetric matrix without negative eigenvalues and with trace 1: squared again and again, all but the greatest
/// eigenvalue vanish beside it.
glm::dvec4 greatest_eigenvector(glm::dmat4 m) {
    for (int i = 0; i < kMostSquarings; ++i) {
        m = m * m;
        const double size = trace(m);
        m /= size;
        if (size > 1 - 1e-15) break;  // rank one
    }
    const auto longer = [&](int a, int b) { return glm::dot(m[a], m[a]) < glm::dot(m[b], m[b]); };
    return glm::normalize(m[std::max({0, 1, 2, 3}, longer)]);
}

glm::dquat middle_of(std::span<const WeightedRotation> rotations) {
    glm::dmat4 sum(0);
    double total = 0;
    for (const WeightedRotation& r : rotations) {
        sum += glm::outerProduct(vector_of(r.rotation), vector_of(r.rotation)) * r.weight;
        total += r.weight;
    }
    const glm::dvec4 q = greatest_eigenvector(sum / total);
    return {q.w, q.x, q.y, q.z};
}

/// Of the rotations that are not half a turn from the middle.
const glm::dquat& heaviest_beside(const glm::dquat& middle, std::span<const WeightedRotation> rotations) {
    const auto weight = [&](const WeightedRotation& r) { return std::abs(glm::dot(middle, r.rotation)) > kOnThePlane ? r.weight : -1; };
    return std::max_element(rotations.begin(), rotations.end(), [&](const auto& a, const auto& b) { return weight(a) < weight(b); })->rotation;
}

}  // namespace

MeanSides mean_sides(std::span<const WeightedRotation> rotations) {
    MeanSides sides{middle_of(rotations), {}, 1};
    const glm::dquat heaviest = nearer(sides.middle, heaviest_beside(sides.middle, rotations));
    for (const WeightedRotation& r : rotations) {
        const double cosine = glm::dot(sides.middle, r.rotation);
        if (r.weight > kNothing) sides.margin = std::min(sides.margin, std::abs(cosine));
        // Half a turn from the middle rounding must not decide.
        sides.flipped.push_back((std::abs(cosine) > kOnThePlane ? cosine : glm::dot(heaviest, r.rotation)) < 0);
    }
    return sides;
}

glm::dquat mean_rotation(std::span<const WeightedRotation> rotations) {
    if (rotations.size() == 1) return rotations[0].rotation;
    double total = 0;
    for (const WeightedRotation& r : rotations) total += r.weight;
    if (rotations.size() == 2) return slerp_shorter(rotations[0].rotation, rotations[1].rotation, rotations[1].weight / total);
    const MeanSides sides = mean_sides(rotations);
    glm::dquat mean = sides.middle;
    for (int step = 0; step < kMostSteps; ++step) {
        glm::dvec3 towards(0);
        for (std::size_t i = 0; i < rotations.size(); ++i) {
            const glm::dquat& q = rotations[i].rotation;
            towards += log_of(glm::conjugate(mean) * (sides.flipped[i] ? -q : q)) * (rotations[i].weight / total);
        }
        mean = glm::normalize(mean * exp_of(towards));
        if (glm::length(towards) < kClose) break;
    }
    return mean;
}

}  // namespace kadr
