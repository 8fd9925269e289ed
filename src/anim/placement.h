#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kadr {

/// Where a copy lies, as little as a hundred thousand of them should cost: 56 bytes. The translation is double, so that
/// copies far from the origin keep their distances; a float rotation is off by 6e-8 rad at most.
struct Placement {
    glm::dvec3 translation{0};
    glm::quat rotation{1, 0, 0, 0};
    glm::vec3 scale{1};
    float clip_offset_s = 0;
    bool operator==(const Placement&) const = default;
};
static_assert(sizeof(Placement) == 56);

/// translation * rotation * scale
inline glm::dmat4 matrix_of(const Placement& placement) {
    const glm::dmat3 rotation = glm::mat3_cast(glm::normalize(glm::dquat(placement.rotation)));
    const glm::dvec3 scale(placement.scale);
    return {glm::dvec4(rotation[0] * scale.x, 0), glm::dvec4(rotation[1] * scale.y, 0), glm::dvec4(rotation[2] * scale.z, 0),
            glm::dvec4(placement.translation, 1)};
}

}  // namespace kadr
