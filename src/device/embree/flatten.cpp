#include "device/embree/flatten.h"

#include <algorithm>

namespace kadr {
namespace {

/// Repeated meshes are flattened as well while all copies together stay below this.
constexpr std::uint64_t kMaxRepeatedTriangles = 1'000'000;
/// Smallest size of a flattened mesh against its distance from the render origin: below it, floats relative to the
/// origin would be too coarse for ray offsets, and the mesh keeps its own coordinates.
constexpr double kMinRelativeSize = 1e-3;

bool may_be_flattened(const SnapshotInstance& instance) { return instance.fixed_place >= 0 && instance.deformed < 0; }

}  // namespace

std::vector<bool> choose_flattened(const Scene& scene, const SceneSnapshot& snapshot) {
    std::vector<std::uint64_t> uses(scene.geometries.size(), 0);
    for (const SnapshotInstance& instance : snapshot.instances) uses[instance.geometry] += may_be_flattened(instance) ? 1 : 0;
    std::vector<bool> flattened(snapshot.instances.size(), false);
    for (std::size_t i = 0; i < flattened.size(); ++i) {
        const SnapshotInstance& instance = snapshot.instances[i];
        const std::uint64_t triangles = scene.geometries[instance.geometry].indices.size() / 3;
        // What is hidden leaves the flat scene, which is then built anew; it costs rays nothing.
        if (!may_be_flattened(instance) || instance.mask == 0 ||
            (uses[instance.geometry] > 1 && uses[instance.geometry] * triangles > kMaxRepeatedTriangles))
            continue;
        const glm::dmat4& place = snapshot.fixed_places[static_cast<std::size_t>(instance.fixed_place)];
        const glm::dmat3 linear(place);
        const double size = std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
        const double distance = glm::length(glm::dvec3(place[3]) - snapshot.render_origin);
        flattened[i] = size > kMinRelativeSize * distance;
    }
    return flattened;
}

}  // namespace kadr
