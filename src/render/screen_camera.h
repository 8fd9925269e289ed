#pragma once

#include <optional>
#include <utility>

#include <glm/glm.hpp>

#include "frame/camera_keys.h"

namespace kadr {

/// A camera at one time as a map from the world to the pixels of a picture: x right, y down, the centre of the first
/// pixel at (0.5, 0.5). In double, as kernels::project is in float.
class ScreenCamera {
public:
    ScreenCamera(const CameraState& camera, int width, int height);

    struct Point {
        glm::dvec2 px{0};
        double depth = 0;  ///< metres along the view axis
    };
    /// Nothing where the point lies behind the camera, or too near to it to mean anything.
    std::optional<Point> project(const glm::dvec3& world) const;
    /// The part of a segment that lies in front of the camera.
    std::optional<std::pair<Point, Point>> project(const glm::dvec3& from, const glm::dvec3& to) const;

    int width() const { return width_; }
    int height() const { return height_; }

private:
    glm::dvec3 in_camera(const glm::dvec3& world) const;
    Point to_picture(const glm::dvec3& in_camera) const;

    CameraState camera_;
    int width_, height_;
    double near_;
};

}  // namespace kadr
