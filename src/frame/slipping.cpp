#include "frame/slipping.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "frame/references.h"

namespace kadr {
namespace {

constexpr double kTooMany = 1e-4;
constexpr double kFloat = 0x1p-24;
/// Measured: rays from the middle of spheres of 256 to a million triangles, Embree 3.13.5, single rays.
constexpr double kOfNearRays = 0.12;
/// Instances that are looked at; of more, a sample.
constexpr std::size_t kMostLookedAt = 4096;

/// Of a mesh, in its own coordinates, in which it is about 2 large.
struct Edges {
    double area = 0;
    double length = 0;  ///< of all edges, those that two triangles share once
};

Edges edges_of(const GeometryData& mesh) {
    Edges edges;
    const auto corner = [&](std::size_t i) {
        const kernels::Vec3f& p = mesh.positions[mesh.indices[i]];
        return glm::dvec3(p.x, p.y, p.z);
    };
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::dvec3 a = corner(i), b = corner(i + 1), c = corner(i + 2);
        const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
        if (!(area > 0)) continue;  // met by no ray
        edges.area += area;
        edges.length += 0.5 * (glm::distance(a, b) + glm::distance(b, c) + glm::distance(c, a));
    }
    return edges;
}

class Estimate {
public:
    explicit Estimate(const BoundShot& shot) : shot_(shot), edges_(shot.scene().geometries.size()), known_(edges_.size()) {}

    Slipping at(double time_s) {
        const CameraState camera = camera_at(shot_, time_s);
        const InstanceList& instances = shot_.bindings().instances;
        const std::size_t step = instances.size() / kMostLookedAt + 1;
        double slipped = 0, met = 0, most = 0;
        int node = -1;
        for (std::size_t i = 0; i < instances.size(); i += step) {
            const Instance instance = instances[i];
            const Part part = part_of(instance, camera, time_s);
            slipped += part.met * part.share, met += part.met;
            if (part.met * part.share > most) most = part.met * part.share, node = instance.seed->mesh_node;
        }
        if (node < 0) return {};
        // What fills the picture more than once hides one another.
        return {node_path(shot_.scene(), shot_.bindings().rig.file_of(node), node), slipped / std::max(met, 1.0)};
    }

private:
    struct Part {
        double met = 0;    ///< of the picture's rays
        double share = 0;  ///< of them, slipped
    };

    const Edges& edges(std::size_t geometry) {
        if (!known_[geometry]) edges_[geometry] = edges_of(shot_.scene().geometries[geometry]), known_[geometry] = true;
        return edges_[geometry];
    }

    Part part_of(const Instance& instance, const CameraState& camera, double time_s) {
        const Edges& mesh = edges(instance.seed->geometry);
        if (!(mesh.area > 0)) return {};
        const glm::dmat4 world = shot_.bindings().node_transform(instance.seed->node, instance.copy, time_s) * shot_.bindings().copied_from_geometry(shot_.scene(), instance);
        const double radius = std::sqrt(glm::dot(world[0], world[0]) + glm::dot(world[1], world[1]) + glm::dot(world[2], world[2])), scale = radius / std::numbers::sqrt3;
        // Rays come from the camera, and from the mesh itself.
        const double away = std::max(glm::distance(glm::dvec3(world[3]), camera.position), radius);
        if (!(scale > 0) || !std::isfinite(away)) return {};
        const double shown = camera.orthographic ? 1 : away, picture = 4 * camera.tan_half_width * camera.tan_half_height * shown * shown;
        // A convex body shows a quarter of its surface (Cauchy).
        return {std::min(0.25 * mesh.area * scale * scale / picture, 1.0), std::min(kOfNearRays * kFloat * away / scale * mesh.length / mesh.area, 1.0)};
    }

    const BoundShot& shot_;
    std::vector<Edges> edges_;
    std::vector<char> known_;
};

}  // namespace

std::string Slipping::text() const { return fmt::format("one ray in {:.0f} would slip between triangles, most of them of node '{}'", 1 / share, node); }

std::optional<Slipping> find_slipping(const BoundShot& shot) {
    const std::vector<int>& frames = shot.timing().frames;
    Estimate estimate(shot);
    Slipping worst;
    for (const std::size_t at : {std::size_t{0}, frames.size() / 2, frames.size() - 1}) {
        const Slipping slipping = estimate.at(shot.sequence().frame(frames[at]).open_s);
        if (slipping.share > worst.share) worst = slipping;
    }
    if (worst.share <= kTooMany) return std::nullopt;
    return worst;
}

}  // namespace kadr
