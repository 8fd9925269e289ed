#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kadr {

/// An affine transform as translation * rotation * U, where U is upper triangular with `scale` on its diagonal and
/// `shear` = (xy, xz, yz) above it. Without shear this is T * R * S. A mirror shows as a negative last scale, so the
/// parts change continuously while the transform has an inverse.
/// Source: Gram-Schmidt on the columns, as HIPRT and Embree (RTCQuaternionDecomposition) have it.
struct Decomposition {
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
    glm::dvec3 shear{0};
    glm::dvec3 translation{0};
    bool operator==(const Decomposition&) const = default;
};

/// Columns that vanish leave a zero in `scale`; ask is_singular before inverting.
Decomposition decompose(const glm::dmat4& transform);
glm::dmat4 compose(const Decomposition& parts);

/// The one rule of motion: everything linearly, but for the rotation, which goes by slerp along the shorter arc.
Decomposition interpolate(const Decomposition& a, const Decomposition& b, double u);

/// Whether shear is more than what rounding to float leaves in a matrix of a file (1e-6 of the largest scale).
bool is_sheared(const Decomposition& parts);
/// Whether some axis is flat: below 1e-7 of the largest scale, where floats hold no inverse.
bool is_singular(const Decomposition& parts);
bool is_finite(const glm::dmat4& transform);

/// Radians between two unit rotations, in [0, pi].
double angle_between(const glm::dquat& a, const glm::dquat& b);
glm::dquat slerp_shorter(const glm::dquat& a, glm::dquat b, double u);

}  // namespace kadr
