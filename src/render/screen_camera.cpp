#include "render/screen_camera.h"

namespace kadr {
namespace {

// Of the distance of what the camera looks at: nearer things, the camera's own path above all, fly off the picture.
constexpr double kNear = 0.02;

}  // namespace

ScreenCamera::ScreenCamera(const CameraState& camera, int width, int height)
    : camera_(camera), width_(width), height_(height), near_(kNear * camera.subject_distance) {}

glm::dvec3 ScreenCamera::in_camera(const glm::dvec3& world) const {
    return glm::conjugate(camera_.rotation) * (world - camera_.position);
}

ScreenCamera::Point ScreenCamera::to_picture(const glm::dvec3& p) const {
    const double depth = -p.z, scale = camera_.orthographic ? 1.0 : depth;
    const double x = p.x / (scale * camera_.tan_half_width), y = p.y / (scale * camera_.tan_half_height);
    return {{0.5 * width_ * (x + 1), 0.5 * height_ * (1 - y)}, depth};
}

std::optional<ScreenCamera::Point> ScreenCamera::project(const glm::dvec3& world) const {
    const glm::dvec3 p = in_camera(world);
    if (!(-p.z > near_)) return std::nullopt;
    return to_picture(p);
}

std::optional<std::pair<ScreenCamera::Point, ScreenCamera::Point>> ScreenCamera::project(const glm::dvec3& from,
                                                                                         const glm::dvec3& to) const {
    glm::dvec3 a = in_camera(from), b = in_camera(to);
    const double a_front = -a.z - near_, b_front = -b.z - near_;
    if (!(a_front > 0) && !(b_front > 0)) return std::nullopt;
    if (a_front < 0) a = glm::mix(a, b, a_front / (a_front - b_front));
    if (b_front < 0) b = glm::mix(b, a, b_front / (b_front - a_front));
    return std::pair{to_picture(a), to_picture(b)};
}

}  // namespace kadr
