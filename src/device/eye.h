#pragma once

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "frame/snapshot.h"

namespace kadr {

/// The camera of a snapshot at the shutter's opening, as far as errors of single rays (device/probe.h) are told in pixels by it.
/// Places are relative to the render origin, lengths in the snapshot's unit.
struct Eye {
    explicit Eye(const SceneSnapshot& snapshot)
        : orthographic(snapshot.camera.orthographic), width(snapshot.settings.width), height(snapshot.settings.height) {
        const kernels::CameraKey& key = snapshot.camera_keys.front();
        const glm::dquat rotation(key.rotation[3], key.rotation[0], key.rotation[1], key.rotation[2]);
        forward = rotation * glm::dvec3(0, 0, -1);
        // Rays of a long lens start in front of the camera, and that is the place that its key has.
        starts_at_camera = key.start == 0;
        place = glm::dvec3(key.position.x, key.position.y, key.position.z) - static_cast<double>(key.start) * forward;
        pixel_at_one = 2.0 * key.tan_half_height / height;
    }
    /// Height of a pixel at a point, as far away as it is from the camera.
    double pixel_at(const glm::dvec3& point) const { return pixel_at_one * (orthographic ? 1.0 : glm::distance(point, place)); }
    /// The way of the ray that meets a point, unit.
    glm::dvec3 towards(const glm::dvec3& point) const {
        const glm::dvec3 way = point - place;
        return orthographic || glm::length(way) == 0 ? forward : glm::normalize(way);
    }

    glm::dvec3 place, forward;
    double pixel_at_one = 0;  ///< at unit distance; of an orthographic camera everywhere
    bool orthographic;
    bool starts_at_camera = true;  ///< rays of devices in float; those of the reference always do
    int width, height;
};

}  // namespace kadr
