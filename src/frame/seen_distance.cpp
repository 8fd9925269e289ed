#include "frame/seen_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/bindings.h"

namespace kadr {
namespace {

/// A crowd is looked at in a sample of its members.
constexpr std::size_t kMostLookedAt = 4096;
/// Of the radius of what the camera is inside of: its walls are nearer than that.
constexpr double kInside = 0.1;

/// Distance from the camera to a ball, infinite where the ball is out of view.
double distance_to(const CameraState& camera, const glm::dvec3& centre, double radius) {
    const glm::dvec3 to_centre = centre - camera.position;
    const double distance = glm::length(to_centre);
    if (distance <= radius) return kInside * radius;
    const double half_view = std::atan(std::hypot(camera.tan_half_width, camera.tan_half_height));
    const double off_axis = std::acos(std::clamp(glm::dot(to_centre / distance, camera.rotation * glm::dvec3(0, 0, -1)), -1.0, 1.0));
    const bool seen = camera.orthographic || off_axis <= half_view + std::asin(radius / distance);
    return seen ? std::max(distance - radius, kInside * radius) : std::numeric_limits<double>::infinity();
}

double nearest_seen(const BoundShot& shot, const CameraState& camera, double time_s) {
    const Bindings& bindings = shot.bindings();
    double nearest = std::numeric_limits<double>::infinity();
    const std::size_t step = bindings.instances.size() / kMostLookedAt + 1;
    for (std::size_t i = 0; i < bindings.instances.size(); i += step) {
        const Instance instance = bindings.instances[i];
        // Meshes fill [-1, 1] along their longest side.
        const glm::dmat4 world = bindings.node_transform(instance.seed->node, instance.copy, time_s) * bindings.copied_from_geometry(shot.scene(), instance);
        const double radius = std::sqrt(glm::dot(world[0], world[0]) + glm::dot(world[1], world[1]) + glm::dot(world[2], world[2]));
        nearest = std::min(nearest, distance_to(camera, glm::dvec3(world[3]), radius));
    }
    return nearest;
}

}  // namespace

double seen_distance(const BoundShot& shot, const CameraState& camera, double time_s) {
    const double hint = camera.subject_distance;
    if (shot.bindings().camera_node < 0) return hint;
    const double seen = nearest_seen(shot, camera, time_s);
    // Where the view is narrow, the place of what it shows has to be known to a few of its heights.
    const bool narrow = !camera.orthographic && camera.tan_half_height < 0.01;
    return std::isfinite(seen) && seen > 0 && (narrow || seen < hint / 8 || seen > 1024 * hint) ? seen : hint;
}

}  // namespace kadr
