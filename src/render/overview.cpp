#include "render/overview.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/bindings.h"
#include "frame/camera_keys.h"

namespace kadr {
namespace {

constexpr double kVerticalFov = 0.7;  // 40 degrees
constexpr double kMargin = 1.15;

/// What has to be in the picture: a point and what is around it.
struct Ball {
    glm::dvec3 centre{0};
    double radius = 0;
};

/// The middle of all meshes, each counted once.
glm::dvec3 middle_of_meshes(const BoundShot& shot, double now_s) {
    glm::dvec3 sum(0);
    for (const InstanceSeed& seed : shot.bindings().seeds)
        sum += glm::dvec3(shot.bindings().node_transform(seed.node, now_s) *
                          glm::dvec4(shot.scene().geometries[seed.geometry].centre, 1));
    return sum / static_cast<double>(std::max<std::size_t>(1, shot.bindings().seeds.size()));
}

/// What the shot's camera looks at; an authored camera has no target, so it is as far away as the meshes are.
glm::dvec3 subject_of(const BoundShot& shot, const CameraState& camera, double now_s) {
    const glm::dvec3 forward = camera.rotation * glm::dvec3(0, 0, -1);
    double distance = camera.subject_distance;
    if (shot.shot().camera.gltf)
        distance = std::max(distance, glm::dot(middle_of_meshes(shot, now_s) - camera.position, forward));
    return camera.position + distance * forward;
}

std::vector<Ball> all_of(const BoundShot& shot, const std::vector<MotionPath>& paths, const PathTimes& times,
                         double now_s) {
    std::vector<Ball> balls;
    for (const MotionPath& path : paths)
        for (const FrameTime& frame : times.frames) balls.push_back({path.position(frame.time_s()), path.radius});
    const CameraState camera = camera_at(shot, now_s);
    balls.push_back({camera.position, 0});
    balls.push_back({subject_of(shot, camera, now_s), 0});
    return balls;
}

/// The direction from the middle to the second camera, and what is up there.
struct Place {
    glm::dvec3 towards, up;
};

Place place_of(const CameraState& camera, Viewpoint from) {
    const glm::dvec3 up(0, 1, 0);
    const glm::dvec3 right = camera.rotation * glm::dvec3(1, 0, 0);
    // A camera that looks straight down has its picture's upper side for "ahead".
    glm::dvec3 ahead = glm::cross(up, right);
    if (!(glm::length(ahead) > 1e-6)) ahead = camera.rotation * glm::dvec3(0, 1, 0);
    ahead = glm::normalize(ahead);
    const glm::dvec3 aside = glm::cross(ahead, up);
    if (from == Viewpoint::top) return {up, ahead};
    if (from == Viewpoint::iso) return {glm::normalize(aside + up - 0.8 * ahead), up};
    return {aside, up};
}

/// Position and target of a camera with these axes that has all of the balls in its picture.
struct Framing {
    glm::dvec3 position, target;
};

Framing frame_all(const std::vector<Ball>& balls, const Place& place, double tan_half_width, double tan_half_height) {
    const glm::dvec3 right = glm::normalize(glm::cross(place.up, place.towards)), up = glm::cross(place.towards, right);
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    const auto along = [&](const glm::dvec3& p) {
        return glm::dvec3(glm::dot(p, right), glm::dot(p, up), glm::dot(p, place.towards));
    };
    for (const Ball& ball : balls) {
        low = glm::min(low, along(ball.centre) - ball.radius);
        high = glm::max(high, along(ball.centre) + ball.radius);
    }
    const glm::dvec3 middle = 0.5 * (low + high);
    double distance = 1e-6;
    for (const Ball& ball : balls) {
        const glm::dvec3 offset = glm::abs(along(ball.centre) - middle) + ball.radius;
        const double nearer = along(ball.centre).z - middle.z + ball.radius;
        distance = std::max(
            {distance, nearer + kMargin * offset.x / tan_half_width, nearer + kMargin * offset.y / tan_half_height});
    }
    const glm::dvec3 target = middle.x * right + middle.y * up + middle.z * place.towards;
    return {target + distance * place.towards, target};
}

}  // namespace

Shot overview_shot(const BoundShot& bound, const std::vector<MotionPath>& paths, const PathTimes& times, Viewpoint from,
                   double now_s) {
    Shot shot = bound.shot();
    const Place place = place_of(camera_at(bound, now_s), from);
    const double tan_half_height = std::tan(0.5 * kVerticalFov);
    const double tan_half_width = tan_half_height * shot.image.pixel_aspect * shot.image.width / shot.image.height;
    const Framing framing = frame_all(all_of(bound, paths, times, now_s), place, tan_half_width, tan_half_height);
    shot.camera = CameraSpec();
    shot.camera.where = bound.shot().camera.where;
    shot.camera.position = Track<glm::dvec3>(framing.position);
    shot.camera.look_at = Track<glm::dvec3>(framing.target);
    shot.camera.up = Track<glm::dvec3>(place.up);
    shot.camera.vertical_fov_rad = Track<double>(kVerticalFov);
    shot.render.cull_backfaces = true;
    return shot;
}

void draw_frustum(Image& picture, const ScreenCamera& overview, const CameraState& camera) {
    constexpr double kOfTheDistance = 0.3;
    const double size_m = kOfTheDistance * camera.subject_distance;
    Drawing drawing(picture.width, picture.height);
    const auto line = [&](const glm::dvec3& from, const glm::dvec3& to) {
        if (const auto seen = overview.project(from, to)) drawing.line(seen->first.px, seen->second.px, 1.3);
    };
    const auto point = [&](double x, double y) {
        const double scale = camera.orthographic ? 1 : size_m;
        return camera.position + camera.rotation * glm::dvec3(x * scale * camera.tan_half_width,
                                                              y * scale * camera.tan_half_height, -size_m);
    };
    const glm::dvec3 corners[] = {point(-1, -1), point(1, -1), point(1, 1), point(-1, 1)};
    for (int i = 0; i < 4; ++i) {
        line(camera.position, corners[i]);
        line(corners[i], corners[(i + 1) % 4]);
    }
    const glm::dvec3 tip = point(0, 1.5);
    line(point(-0.4, 1.08), tip);
    line(point(0.4, 1.08), tip);
    line(point(-0.4, 1.08), point(0.4, 1.08));
    drawing.lay_onto(picture, path_color(MotionPath::Subject::camera, 0));
}

}  // namespace kadr
