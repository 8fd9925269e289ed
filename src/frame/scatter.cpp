#include "frame/scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "frame/problem.h"
#include "frame/references.h"

namespace kadr {

namespace {

/// Darts in a row that find no room before a surface counts as full. It then holds about 85 % of what random places can
/// fill (discs of half the distance cover 0.547 of a plane at most: Feder 1980); the rest would take many times the darts.
constexpr int kMostMisses = 1000;

enum Dimension : std::uint32_t { kTriangle = 16, kAlong, kAcross };

/// A triangle in the world.
struct Corners {
    glm::dvec3 a, b, c;
};

[[noreturn]] void refuse(const ScatterSpec& spec, std::string found, std::string expected) {
    throw InputError(problem_at(spec.where, fmt::format("scatter: '{}' {}", spec.target, found), std::move(expected)));
}

/// All triangles of the target, and the sum of their areas up to each.
class Surface {
public:
    Surface(const ScatterSpec& spec, int file, const Scene& scene, const NodeRig& rig) : spec_(spec), scene_(scene), rig_(rig) {
        const ResolvedReference target = resolve(scene, {spec.target, spec.where});
        if (target.file == file) refuse(spec, "is the scene that is strewn", "expected another scene or a node of one");
        add_nodes(target);
        if (cumulative_.empty() || !(cumulative_.back() > 0) || !std::isfinite(cumulative_.back()))
            refuse(spec, "has no surface to strew on", "expected a node whose meshes have an area");
    }

    const Corners& triangle_at(double share) const {
        const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), share * cumulative_.back());
        return triangles_[std::min(static_cast<std::size_t>(found - cumulative_.begin()), triangles_.size() - 1)];
    }

private:
    bool belongs(int node, const ResolvedReference& target) const {
        if (rig_.file_of(node) != target.file || !rig_.reachable(node)) return false;
        if (target.node < 0) return true;
        while (node >= 0 && node != target.node) node = scene_.nodes[static_cast<std::size_t>(node)].parent;
        return node == target.node;
    }

    void add_nodes(const ResolvedReference& target) {
        for (std::size_t node = 0; node < scene_.nodes.size(); ++node) {
            const int index = static_cast<int>(node);
            if (!belongs(index, target)) continue;
            for (const MeshPrimitive& primitive : scene_.nodes[node].primitives) {
                if (rig_.moves(index)) refuse(spec_, fmt::format("moves: node '{}'", node_path(scene_, target.file, index)), "expected a surface that stands still");
                add_mesh(scene_.geometries[static_cast<std::size_t>(primitive.geometry)], rig_.node_transform(index, 0));
            }
        }
    }

    void add_mesh(const GeometryData& geometry, const glm::dmat4& world_from_node) {
        const auto place = [&](std::uint32_t i) {
            const kernels::Vec3f& p = geometry.positions[i];
            return glm::dvec3(world_from_node * glm::dvec4(geometry.centre + geometry.scale * glm::dvec3(p.x, p.y, p.z), 1));
        };
        double sum = cumulative_.empty() ? 0 : cumulative_.back();
        for (std::size_t i = 0; i + 2 < geometry.indices.size(); i += 3) {
            const Corners corners{place(geometry.indices[i]), place(geometry.indices[i + 1]), place(geometry.indices[i + 2])};
            sum += 0.5 * glm::length(glm::cross(corners.b - corners.a, corners.c - corners.a));
            triangles_.push_back(corners);
            cumulative_.push_back(sum);
        }
    }

    const ScatterSpec& spec_;
    const Scene& scene_;
    const NodeRig& rig_;
    std::vector<Corners> triangles_;
    std::vector<double> cumulative_;
};

/// Points that keep a distance from each other, in cells of that size.
class Spread {
public:
    explicit Spread(double distance) : distance_(distance) {}

    /// Adds a point, unless another is too near.
    bool add(const glm::dvec3& point) {
        const Cell at = cell_of(point);
        if (holds_near(at, point)) return false;  // of what misses, most misses here
        for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z)
            for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y)
                for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x)
                    if (holds_near({x, y, z}, point)) return false;
        cells_[at].push_back(point);
        return true;
    }

private:
    using Cell = std::array<std::int64_t, 3>;
    struct HashCell {
        std::size_t operator()(const Cell& cell) const {
            std::uint64_t h = 0;
            for (const std::int64_t i : cell) h = (h ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15ULL, h ^= h >> 32;
            return static_cast<std::size_t>(h);
        }
    };

    Cell cell_of(const glm::dvec3& point) const {
        constexpr double kFarthest = 1e18;  // what an index holds; cells beyond fall together
        Cell cell;
        for (int i = 0; i < 3; ++i) cell[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::clamp(std::floor(point[i] / distance_), -kFarthest, kFarthest));
        return cell;
    }

    bool holds_near(const Cell& cell, const glm::dvec3& point) const {
        const auto found = cells_.find(cell);
        if (found == cells_.end()) return false;
        return std::any_of(found->second.begin(), found->second.end(), [&](const glm::dvec3& other) { return glm::distance(other, point) < distance_; });
    }

    double distance_;
    std::unordered_map<Cell, std::vector<glm::dvec3>, HashCell> cells_;
};

/// The turn that takes +y to a unit direction by the shortest way.
glm::dquat upright_to(const glm::dvec3& direction) {
    const glm::dvec3 up(0, 1, 0);
    if (direction.y < -1 + 1e-12) return {0, 1, 0, 0};  // upside down: half a turn about x
    return glm::normalize(glm::dquat(1 + glm::dot(up, direction), glm::cross(up, direction)));
}

/// A point of the surface, and the normal there: functions of seed and number alone.
struct Dart {
    glm::dvec3 point, normal;
};

Dart throw_dart(const Surface& surface, std::uint32_t seed, std::uint32_t number) {
    const auto random = [&](Dimension dimension) { return random_unit(seed, number, dimension); };
    const Corners& t = surface.triangle_at(random(kTriangle));
    const double root = std::sqrt(random(kAlong)), along = random(kAcross);
    return {(1 - root) * t.a + root * (1 - along) * t.b + root * along * t.c, glm::cross(t.b - t.a, t.c - t.a)};
}

}  // namespace

std::vector<Placement> scatter_copies(const InstancesSpec& spec, int file, const Scene& scene, const NodeRig& rig) {
    const ScatterSpec& scatter = *spec.scatter;
    const Surface surface(scatter, file, scene, rig);
    // The copies lie inside the scene's transform, as it is at 0 s; the surface is in the world.
    const glm::dmat4 scene_from_world = glm::inverse(rig.scene_transform(file, 0));
    Spread spread(scatter.distance_m);
    std::vector<Placement> placements;
    int misses = 0;
    for (std::uint32_t number = 0; placements.size() < static_cast<std::size_t>(scatter.count) && misses < kMostMisses; ++number) {
        const Dart dart = throw_dart(surface, spec.seed, number);
        if (scatter.distance_m > 0 && !spread.add(dart.point)) {
            ++misses;
            continue;
        }
        misses = 0;
        Placement& placement = placements.emplace_back();
        placement.translation = glm::dvec3(scene_from_world * glm::dvec4(dart.point, 1));
        if (scatter.align == ScatterSpec::Align::normal) placement.rotation = glm::quat(upright_to(glm::normalize(dart.normal)));
        vary(spec, number, placement);
    }
    return placements;
}

}  // namespace kadr
