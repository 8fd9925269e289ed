#pragma once

#include <span>

#include <glm/gtc/quaternion.hpp>

namespace kadr {

struct WeightedRotation {
    double weight = 0;  ///< not negative
    glm::dquat rotation{1, 0, 0, 0};
};

/// The weighted mean of unit rotations: the one with the least sum of weight * angle^2, so that it does not depend on
/// their order nor on the sign of a quaternion. Of two it is the slerp along the shorter arc; where they lie half a
/// turn apart there are two such means and either comes back.
///
/// @param rotations  at least one with a weight above zero; the weights need no particular sum
/// Source: Buss and Fillmore 2001, "Spherical averages and applications to spherical splines and interpolation", A1.
glm::dquat mean_rotation(std::span<const WeightedRotation> rotations);

}  // namespace kadr
