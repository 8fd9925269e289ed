#pragma once

#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>

namespace kadr {

struct WeightedRotation {
    double weight = 0;  ///< not negative
    glm::dquat rotation{1, 0, 0, 0};
};

/// The weighted mean of unit rotations. It depends neither on their order nor on the sign of a quaternion; of two it is the
/// slerp along the shorter arc, of several within 120 degrees of one another the one with the least sum of weight * angle^2.
/// A rotation whose weight runs to zero leaves it without a jump.
///
/// Each rotation enters as that of its two quaternions which lies on the side of the eigenvector q of the greatest
/// eigenvalue of sum(weight * q_i * q_i^T): the mean of Markley et al., which knows no signs. Points of the sphere on one
/// side of a plane have one mean there, which moves smoothly with them and their weights. So the mean jumps where a
/// rotation passes half a turn from q or the two greatest eigenvalues meet, and nowhere else (mean_flips.h).
///
/// @param rotations  at least one with a weight above zero; the weights need no particular sum
/// Source: Markley, Cheng, Crassidis, Oshman 2007, "Averaging quaternions"; Buss and Fillmore 2001, "Spherical averages and
/// applications to spherical splines and interpolation", A1 and theorem 1.
glm::dquat mean_rotation(std::span<const WeightedRotation> rotations);

/// The sides that the rotations of a mean enter it with.
struct MeanSides {
    glm::dquat middle{1, 0, 0, 0};  ///< the eigenvector
    std::vector<bool> flipped;      ///< [rotation] it enters as -q
    double margin = 1;              ///< the least cosine of half the angle to the middle, of those with weight
};
MeanSides mean_sides(std::span<const WeightedRotation> rotations);

}  // namespace kadr
