#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kadr {

/// Right and up of something that looks along `forward` (unit). Where `up` is parallel to it (or zero) the world axis
/// that is farthest from `forward` stands in, -z before the others, so that looking straight down has north on top.
struct ViewAxes {
    glm::dvec3 right, up;
};
ViewAxes view_axes(const glm::dvec3& forward, const glm::dvec3& up);

/// world_from_camera of a camera that looks along `forward` (unit): its -z.
glm::dquat look_rotation(const glm::dvec3& forward, const glm::dvec3& up);

}  // namespace kadr
