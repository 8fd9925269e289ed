#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/error.h"

namespace kadr {

/// The most instances a scene may have: HIPRT's limit, kept on every device.
inline constexpr std::int64_t kMostInstances = (1 << 24) - 1;

/// One copy of a scene: scaled, rotated, then translated, inside the scene's own transform.
struct PlacementSpec {
    glm::dvec3 translate_m{0};
    glm::dquat rotate{1, 0, 0, 0};
    glm::dvec3 scale{1};
    double offset_s = 0;  ///< added to the time at which its clips play
    bool operator==(const PlacementSpec&) const = default;
};

/// Copies on the crossings of a grid that is centred on the scene's origin.
struct GridSpec {
    std::array<int, 3> counts{1, 1, 1};
    glm::dvec3 spacing_m{1};
    double jitter = 0;  ///< largest random displacement along each axis, as a part of the spacing
    bool operator==(const GridSpec&) const = default;
};

/// Copies strewn over the surfaces of a node or of a whole scene, evenly by area.
struct ScatterSpec {
    std::string target;  ///< "scene" or "scene/Node"
    SourceLocation where;
    int count = 1;
    enum class Align { up, normal } align = Align::up;  ///< the copy's +y: the world's, or the surface's normal
    double distance_m = 0;  ///< least distance of any two; where it leaves no room for `count`, there are fewer
    bool operator==(const ScatterSpec& o) const { return target == o.target && count == o.count && align == o.align && distance_m == o.distance_m; }
};

/// How a scene is repeated: a list of places, or a grid or scatter with random variation.
struct InstancesSpec {
    SourceLocation where;
    std::vector<PlacementSpec> list;
    std::optional<GridSpec> grid;
    std::optional<ScatterSpec> scatter;
    std::uint32_t seed = 0;
    double random_yaw_rad = 0;          ///< full range of a turn about the copy's +y
    glm::dvec2 random_scale{1};         ///< least and largest factor
    glm::dvec2 random_offset_s{0};      ///< least and largest clip offset
    int offset_steps = 0;               ///< even steps that random offsets are rounded down to; 0: none
    bool operator==(const InstancesSpec& o) const {
        return list == o.list && grid == o.grid && scatter == o.scatter && seed == o.seed &&
               random_yaw_rad == o.random_yaw_rad && random_scale == o.random_scale &&
               random_offset_s == o.random_offset_s && offset_steps == o.offset_steps;
    }
};

}  // namespace kadr
