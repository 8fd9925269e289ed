#include "frame/thin_shells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "frame/bindings.h"

namespace kadr {
namespace {

constexpr std::size_t kMostMeshes = 512;

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    void add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
    double size() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

struct PlacedMesh {
    int node = -1;
    const GeometryData* mesh = nullptr;
    glm::dmat4 world_from_geometry{1};
    Box own, world;  ///< in the mesh's coordinates, in the world
};

glm::dvec3 to_double(const kernels::Vec3f& p) { return {p.x, p.y, p.z}; }

PlacedMesh placed(const BoundShot& shot, const Instance& instance, double time_s) {
    PlacedMesh placed;
    placed.node = instance.seed->mesh_node;
    placed.mesh = &shot.scene().geometries[instance.seed->geometry];
    placed.world_from_geometry = shot.bindings().node_transform(instance.seed->node, instance.copy, time_s) * shot.bindings().copied_from_geometry(shot.scene(), instance);
    for (const kernels::Vec3f& p : placed.mesh->positions) {
        placed.own.add(to_double(p));
        placed.world.add(glm::dvec3(placed.world_from_geometry * glm::dvec4(to_double(p), 1)));
    }
    return placed;
}

/// One of every mesh.
std::vector<PlacedMesh> meshes_of(const BoundShot& shot, double time_s) {
    std::vector<PlacedMesh> meshes;
    const InstanceSeed* last = nullptr;
    const InstanceList& instances = shot.bindings().instances;
    for (std::size_t i = 0; i < instances.size() && meshes.size() < kMostMeshes; ++i) {
        const Instance instance = instances[i];
        if (std::exchange(last, instance.seed) == instance.seed) continue;
        meshes.push_back(placed(shot, instance, time_s));
    }
    return meshes;
}

/// Whether triangles face along an axis of the mesh's own coordinates and against it: a surface that is merely uneven does
/// not.
bool has_two_sides(const GeometryData& mesh, int axis) {
    constexpr double kFacing = 0.9;
    bool along = false, against = false;
    for (std::size_t i = 0; i + 2 < mesh.indices.size() && !(along && against); i += 3) {
        const glm::dvec3 a = to_double(mesh.positions[mesh.indices[i]]);
        const glm::dvec3 normal = glm::cross(to_double(mesh.positions[mesh.indices[i + 1]]) - a, to_double(mesh.positions[mesh.indices[i + 2]]) - a);
        const double length = glm::length(normal);
        along |= normal[axis] > kFacing * length, against |= normal[axis] < -kFacing * length;
    }
    return along && against;
}

ThinShell plate(const PlacedMesh& placed) {
    glm::dvec3 sides;
    for (int axis = 0; axis < 3; ++axis) sides[axis] = (placed.own.high[axis] - placed.own.low[axis]) * glm::length(glm::dvec3(placed.world_from_geometry[axis]));
    const int thin = sides.x <= sides.y && sides.x <= sides.z ? 0 : sides.y <= sides.z ? 1 : 2;
    ThinShell shell{placed.node, -1, sides[thin], std::max({sides.x, sides.y, sides.z})};
    if (shell.thickness_m < kThinnestShell * shell.size_m && !has_two_sides(*placed.mesh, thin)) shell.thickness_m = 0;
    return shell;
}

/// The space between a box and one that is inside of it on all sides. @return thickness 0: it is not
ThinShell between(const PlacedMesh& outer, const PlacedMesh& inner) {
    ThinShell shell{outer.node, inner.node, 0, outer.world.size()};
    const glm::dvec3 below = inner.world.low - outer.world.low, above = outer.world.high - inner.world.high;
    const double least = std::min({below.x, below.y, below.z, above.x, above.y, above.z}), most = std::max({below.x, below.y, below.z, above.x, above.y, above.z});
    if (least > 0 && most < kThinnestShell * shell.size_m) shell.thickness_m = least;
    return shell;
}

}  // namespace

std::optional<ThinShell> find_thin_shell(const BoundShot& shot, double time_s) {
    std::optional<ThinShell> thinnest;
    double least = kThinnestShell;
    const auto consider = [&](const ThinShell& shell) {
        if (!(shell.thickness_m > 0) || !(shell.thickness_m < least * shell.size_m)) return;
        least = shell.thickness_m / shell.size_m;
        thinnest = shell;
    };
    const std::vector<PlacedMesh> meshes = meshes_of(shot, time_s);
    for (const PlacedMesh& mesh : meshes) consider(plate(mesh));
    for (const PlacedMesh& outer : meshes)
        for (const PlacedMesh& inner : meshes)
            if (&outer != &inner) consider(between(outer, inner));
    return thinnest;
}

}  // namespace kadr
