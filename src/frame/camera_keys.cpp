#include "frame/camera_keys.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/bindings.h"
#include "frame/decompose.h"
#include "frame/key_grid.h"
#include "frame/problem.h"
#include "frame/view_axes.h"

namespace kadr {

namespace {

constexpr double kDefaultFocalMm = 50;
constexpr double kWidestStep = 0.17453292519943295;  // 10 degrees

double aspect_of(const ImageSpec& image) { return image.pixel_aspect * image.width / image.height; }

bool fits_width(const CameraSpec& spec, double aspect) {
    return spec.fit == CameraSpec::Fit::horizontal || (spec.fit == CameraSpec::Fit::automatic && aspect >= 1);
}

void set_vertical(CameraState& camera, double tan_half_height, double aspect) {
    camera.tan_half_height = tan_half_height;
    camera.tan_half_width = aspect * tan_half_height;
}

void set_field_of_view(CameraState& camera, const CameraSpec& spec, double aspect, double time_s) {
    if (spec.vertical_fov_rad) return set_vertical(camera, std::tan(0.5 * evaluate(*spec.vertical_fov_rad, time_s)), aspect);
    const double focal = spec.focal_length_mm ? evaluate(*spec.focal_length_mm, time_s) : kDefaultFocalMm;
    if (fits_width(spec, aspect)) return set_vertical(camera, 0.5 * spec.sensor_mm.x / focal / aspect, aspect);
    set_vertical(camera, 0.5 * spec.sensor_mm.y / focal, aspect);
}

/// glTF gives the vertical field; the image's aspect decides the horizontal one.
void set_authored(CameraState& camera, const SceneCamera& source, double aspect) {
    camera.orthographic = source.orthographic;
    set_vertical(camera, source.orthographic ? std::abs(source.ymag) : std::tan(0.5 * source.yfov_rad), aspect);
}

[[noreturn]] void refuse(const CameraSpec& spec, std::string found, std::string expected) {
    throw InputError(problem_at(spec.where, std::move(found), std::move(expected)));
}

glm::dvec3 target_of(const BoundShot& shot, double time_s) {
    const Target& target = shot.shot().camera.look_at;
    if (const auto* point = std::get_if<PositionTrack>(&target)) return evaluate(*point, time_s);
    return shot.bindings().position_of(std::get<NodeReference>(target), time_s);
}

bool stands_still(const BoundShot& shot, const NodeReference& reference) {
    const int node = shot.node_of(reference);
    if (node >= 0) return !shot.bindings().rig.moves(node);
    return !varies(shot.shot().scenes[static_cast<std::size_t>(shot.scene_of(reference))].transform);
}

/// Whether the view never changes but for its lens.
bool looks_one_way(const BoundShot& shot) {
    const CameraSpec& spec = shot.shot().camera;
    if (varies(spec.position) || varies(spec.up) || (spec.around && !stands_still(shot, *spec.around))) return false;
    if (const auto* point = std::get_if<PositionTrack>(&spec.look_at)) return !varies(*point);
    return stands_still(shot, std::get<NodeReference>(spec.look_at));
}

/// A view straight up or down needs an `up` of its own. Only a camera that never turns may do with the stand-in of
/// look_rotation: under one that does the picture would flip.
void check_up(const BoundShot& shot, const glm::dvec3& forward, const glm::dvec3& up, double time_s) {
    constexpr double kParallel = 1e-9;
    const CameraSpec& spec = shot.shot().camera;
    if (glm::length(glm::cross(forward, up)) > kParallel * glm::length(up)) return;
    if (spec.up_given || !looks_one_way(shot))
        refuse(spec, fmt::format("camera.up lies along the view at {} s", format_number(time_s)),
               "expected a direction beside the view, such as up: [0, 0, -1] for one straight down");
}

/// Towards look_at, or along the path. Sets how far away the subject is.
glm::dvec3 view_direction(const BoundShot& shot, double time_s, CameraState& camera) {
    const CameraSpec& spec = shot.shot().camera;
    if (spec.position.turns_along()) {
        const glm::dvec3 along = tangent(spec.position, time_s);
        if (along == glm::dvec3(0))
            refuse(spec, fmt::format("the path of camera.position turns back on itself at {} s and has no direction there", format_number(time_s)),
                   "expected a point beside it that makes the turn a curve, or look_at instead of orient: along");
        camera.subject_distance = std::min(1.0, 0.1 * spec.position.path->path.length());  // a scale; nothing says what it looks at
        return along;
    }
    const glm::dvec3 towards = target_of(shot, time_s) - camera.position;
    camera.subject_distance = glm::length(towards);
    const double rounding = 1e-15 * glm::length(camera.position);
    if (!(camera.subject_distance > rounding) || !std::isfinite(camera.subject_distance))
        refuse(spec, fmt::format("camera.position and camera.look_at are the same point at {} s", format_number(time_s)),
               "expected two points: the view has no direction");
    return towards / camera.subject_distance;
}

CameraState placed_by_shot(const BoundShot& shot, double time_s) {
    const CameraSpec& spec = shot.shot().camera;
    CameraState camera;
    camera.position = evaluate(spec.position, time_s);
    if (spec.around) camera.position += shot.bindings().position_of(*spec.around, time_s);
    const glm::dvec3 forward = view_direction(shot, time_s, camera), up = evaluate(spec.up, time_s);
    check_up(shot, forward, up, time_s);
    camera.rotation = look_rotation(forward, up);
    camera.focus_distance = camera.subject_distance;
    set_field_of_view(camera, spec, aspect_of(shot.shot().image), time_s);
    return camera;
}

const std::vector<DrivenProperty>& driven_of(const BoundShot& shot) {
    static const std::vector<DrivenProperty> none;
    const Bindings& bindings = shot.bindings();
    if (bindings.camera_node < 0) return none;
    const int camera = shot.scene().nodes[static_cast<std::size_t>(bindings.camera_node)].camera;
    return bindings.properties.of(bindings.rig.file_of(bindings.camera_node), PropertyOwner::camera, camera);
}

/// References mean the first copy of a scene, with its clip offset.
double driven_offset_s(const BoundShot& shot) {
    const Bindings& bindings = shot.bindings();
    return bindings.camera_node < 0 ? 0 : bindings.first_offset_s(bindings.rig.file_of(bindings.camera_node));
}

/// An authored camera with what its clips drive. @pre camera_node >= 0
SceneCamera source_at(const BoundShot& shot, double time_s) {
    SceneCamera camera = shot.scene().cameras[static_cast<std::size_t>(shot.scene().nodes[static_cast<std::size_t>(shot.bindings().camera_node)].camera)];
    for (const DrivenProperty& driven : driven_of(shot)) {
        const auto value = [&](double own) { return driven.value(own, time_s, driven_offset_s(shot)); };
        if (driven.property == Property::camera_yfov) camera.yfov_rad = value(camera.yfov_rad);
        else if (driven.property == Property::camera_xmag) camera.xmag = value(camera.xmag);
        else if (driven.property == Property::camera_ymag) camera.ymag = value(camera.ymag);
        else if (driven.property == Property::camera_znear) camera.znear = value(camera.znear);
        else if (driven.property == Property::camera_zfar) camera.zfar = driven.distance(camera.zfar, time_s, driven_offset_s(shot));
    }
    return camera;
}

CameraState placed_by_node(const BoundShot& shot, double time_s) {
    const int node = shot.bindings().camera_node;
    const SceneCamera source = source_at(shot, time_s);
    const glm::dmat4 world = shot.bindings().node_transform(node, time_s);
    CameraState camera;
    camera.position = glm::dvec3(world[3]);
    const glm::dvec3 forward = -glm::dvec3(world[2]);
    if (!is_finite(world) || !(glm::length(forward) > 0))
        refuse(shot.shot().camera, fmt::format("the node of camera.gltf has the scale 0 or no place at {} s", format_number(time_s)),
               "expected a transform with an inverse");
    // Scale does not belong to a camera (glTF 2.0, 3.10): the directions of the axes are all that counts.
    camera.rotation = look_rotation(glm::normalize(forward), glm::dvec3(world[1]));
    // The near plane is the one hint of scale that an authored camera gives; artists put it at a hundredth or less.
    camera.focus_distance = std::max(1.0, 100 * source.znear);
    if (source.orthographic && source.ymag == 0)
        refuse(shot.shot().camera, fmt::format("the ymag of camera '{}' is animated to 0 at {} s", source.name, format_number(time_s)), "expected a number other than 0");
    set_authored(camera, source, aspect_of(shot.shot().image));
    // A narrow view shows what is far away: at least half a metre of it.
    constexpr double kLeastHalfHeight_m = 0.25;
    camera.subject_distance = camera.orthographic ? camera.focus_distance : std::max(camera.focus_distance, kLeastHalfHeight_m / camera.tan_half_height);
    return camera;
}

/// Forward along the view axis; the view keeps its direction.
void apply_dolly(CameraState& camera, const BoundShot& shot, double time_s) {
    const CameraSpec& spec = shot.shot().camera;
    if (!spec.dolly_m) return;
    const double forward = evaluate(*spec.dolly_m, time_s);
    camera.position += camera.rotation * glm::dvec3(0, 0, -forward);
    if (spec.gltf || spec.position.turns_along()) return;  // no target
    if (!(forward < camera.subject_distance))
        refuse(spec, fmt::format("camera.dolly is {} m at {} s, and what the camera looks at is {} m away", format_number(forward), format_number(time_s), format_number(camera.subject_distance)),
               "expected a dolly that stops before camera.look_at");
    camera.subject_distance -= forward;
    camera.focus_distance = camera.subject_distance;
}

/// About and along the camera's own axes. Last: the lens is focused by someone who holds still.
void apply_shake(CameraState& camera, const BoundShot& shot, double time_s) {
    const CameraSpec& spec = shot.shot().camera;
    if (!spec.shake) return;
    const ShakeOffset shake = evaluate(*spec.shake, time_s);
    const double angle = glm::length(shake.turn_rad);
    camera.position += camera.rotation * shake.offset_m;
    if (angle > 0) camera.rotation = glm::normalize(camera.rotation * glm::angleAxis(angle, shake.turn_rad / angle));
}

void set_focus(CameraState& camera, const BoundShot& shot, double time_s) {
    const CameraSpec& spec = shot.shot().camera;
    if (!spec.focus) return;
    if (const auto* distance = std::get_if<Track<double>>(&*spec.focus)) {
        camera.focus_distance = evaluate(*distance, time_s);
    } else {
        const glm::dvec3 point = shot.bindings().position_of(std::get<NodeReference>(*spec.focus), time_s);
        camera.focus_distance = glm::dot(point - camera.position, camera.rotation * glm::dvec3(0, 0, -1));
    }
    if (spec.gltf || spec.position.turns_along()) camera.subject_distance = std::max(std::abs(camera.focus_distance), 1e-9);
}

/// Thin lens: the aperture's diameter is the focal length over the f-stop; the focal length is that of the sensor.
void set_lens(CameraState& camera, const BoundShot& shot, double time_s) {
    const CameraSpec& spec = shot.shot().camera;
    if (!spec.f_stop || camera.orthographic) return;
    if (!(camera.focus_distance > 0))
        refuse(spec, fmt::format("camera.focus lies {} m behind the camera at {} s", format_number(-camera.focus_distance), format_number(time_s)),
               "expected a point in front of it");
    const bool wide = fits_width(spec, aspect_of(shot.shot().image));
    const double focal_m = 0.5e-3 * (wide ? spec.sensor_mm.x / camera.tan_half_width : spec.sensor_mm.y / camera.tan_half_height);
    camera.lens_radius = 0.5 * focal_m / evaluate(*spec.f_stop, time_s);
}

glm::dvec3 forward_of(const CameraState& camera) { return camera.rotation * glm::dvec3(0, 0, -1); }

/// Where the plane that rays start on crosses the view axis.
glm::dvec3 start_of(const CameraState& camera) { return camera.position + camera.start_m * forward_of(camera); }

/// As kernels interpolate it.
CameraState between(const CameraState& a, const CameraState& b, double u) {
    CameraState c = a;
    c.rotation = slerp_shorter(a.rotation, b.rotation, u);
    c.position = glm::mix(start_of(a), start_of(b), u) - c.start_m * forward_of(c);
    c.tan_half_width = std::lerp(a.tan_half_width, b.tan_half_width, u);
    c.tan_half_height = std::lerp(a.tan_half_height, b.tan_half_height, u);
    c.lens_radius = std::lerp(a.lens_radius, b.lens_radius, u);
    c.focus_distance = std::lerp(a.focus_distance, b.focus_distance, u);
    return c;
}

/// What a displacement of a camera counts for. Along the axis it only makes the picture grow about its middle; where rays start
/// far ahead of a camera that turns, that is most of it.
double shown_motion(const CameraState& camera, const glm::dvec3& moved) {
    if (camera.start_m == 0) return glm::length(moved);
    const glm::dvec3 forward = forward_of(camera);
    const double along = glm::dot(moved, forward);
    return glm::length(moved - along * forward) + std::abs(along) * std::hypot(camera.tan_half_width, camera.tan_half_height);
}

/// How far the image of the subject moves between two cameras, in pixels: turned, displaced and zoomed.
double pixels_between(const CameraState& a, const CameraState& b, int image_height) {
    const double half_height = 0.5 * image_height;
    const double moved = shown_motion(b, a.position - b.position);
    const double zoomed = std::abs(a.tan_half_height / b.tan_half_height - 1) * half_height;
    if (a.orthographic) return moved * half_height / b.tan_half_height + zoomed + angle_between(a.rotation, b.rotation) * half_height;
    const double corner = 1 + b.tan_half_width * b.tan_half_width + b.tan_half_height * b.tan_half_height;
    const double turned = angle_between(a.rotation, b.rotation) * corner;
    const double lens = std::abs(a.lens_radius - b.lens_radius) / b.subject_distance;
    const double focus = b.lens_radius * std::abs(1 / a.focus_distance - 1 / b.focus_distance);
    return (turned + moved / b.subject_distance + lens + focus) * half_height / b.tan_half_height + zoomed;
}

/// Error of evenly spaced states at a quarter, the half and three quarters of every step, where the fit looks at it, and
/// where tracks have keys: a path that has a corner there strays farthest in it.
/// @param corners  in (0, 1)  @param at  the true camera at a part of the shutter
template <class At>
double worst_error_px(const std::vector<CameraState>& states, const std::vector<double>& corners, int image_height, const At& at) {
    double worst = 0;
    const auto look = [&](double u) {
        const double position = u * static_cast<double>(states.size() - 1);
        const std::size_t from = std::min(static_cast<std::size_t>(position), states.size() - 2);
        const CameraState is = between(states[from], states[from + 1], position - static_cast<double>(from));
        worst = std::max(worst, pixels_between(is, at(u), image_height));
    };
    const std::size_t checks = 4 * (states.size() - 1);
    for (std::size_t i = 0; i < checks; ++i)
        if (i % 4 != 0) look(static_cast<double>(i) / static_cast<double>(checks));
    for (const double u : corners) look(u);
    return worst;
}

/// Applies `visit(track)` to every track of the camera that is in use.
template <class Visit>
void visit_tracks(const CameraSpec& spec, Visit visit) {
    if (!spec.gltf) {
        visit(spec.position);
        visit(spec.up);
        if (const auto* point = std::get_if<PositionTrack>(&spec.look_at)) visit(*point);
        if (spec.focal_length_mm) visit(*spec.focal_length_mm);
        if (spec.vertical_fov_rad) visit(*spec.vertical_fov_rad);
    }
    if (spec.dolly_m) visit(*spec.dolly_m);
    if (spec.shake) visit(*spec.shake);
    if (spec.f_stop) visit(*spec.f_stop);
    if (!spec.focus) return;
    if (const auto* distance = std::get_if<Track<double>>(&*spec.focus)) visit(*distance);
}

std::vector<double> camera_key_times(const BoundShot& shot, double open_s, double close_s) {
    std::vector<double> times;
    const auto add = [&times](const std::vector<double>& more) { times.insert(times.end(), more.begin(), more.end()); };
    visit_tracks(shot.shot().camera, [&](const auto& track) { add(key_times(track, open_s, close_s)); });
    const CameraSpec& spec = shot.shot().camera;
    const Bindings& bindings = shot.bindings();
    const auto add_node = [&](const NodeReference& reference) {
        const int node = shot.node_of(reference);
        if (node >= 0) return add(bindings.key_times_of(node, open_s, close_s));
        add(key_times(shot.shot().scenes[static_cast<std::size_t>(shot.scene_of(reference))].transform, open_s, close_s));
    };
    if (bindings.camera_node >= 0) add(bindings.key_times_of(bindings.camera_node, open_s, close_s));
    for (const DrivenProperty& driven : driven_of(shot)) add(driven.key_times(open_s, close_s, driven_offset_s(shot)));
    if (spec.around) add_node(*spec.around);
    if (const auto* node = std::get_if<NodeReference>(&spec.look_at); node && !spec.gltf) add_node(*node);
    if (const auto* node = spec.focus ? std::get_if<NodeReference>(&*spec.focus) : nullptr) add_node(*node);
    for (double& time : times) time = (time - open_s) / (close_s - open_s);
    return times;
}

}  // namespace

template <class T>
kernels::CameraKeyOf<T> to_key(const CameraState& camera, const RenderSpace& space) {
    const glm::vec<3, T> p(space.from_world(start_of(camera)));
    const glm::qua<T> q(camera.rotation);
    const double film_unit = camera.orthographic ? space.unit_m : 1;  // an orthographic picture is as wide as what it shows
    return {{p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}, static_cast<T>(camera.tan_half_width / film_unit), static_cast<T>(camera.tan_half_height / film_unit),
            static_cast<T>(camera.lens_radius / space.unit_m), static_cast<T>((camera.focus_distance - camera.start_m) / space.unit_m),
            static_cast<T>(camera.start_m / space.unit_m)};
}
template kernels::CameraKeyOf<float> to_key(const CameraState&, const RenderSpace&);
template kernels::CameraKeyOf<double> to_key(const CameraState&, const RenderSpace&);

CameraState camera_at(const BoundShot& shot, double time_s) {
    CameraState camera = shot.bindings().camera_node >= 0 ? placed_by_node(shot, time_s) : placed_by_shot(shot, time_s);
    apply_dolly(camera, shot, time_s);
    set_focus(camera, shot, time_s);
    set_lens(camera, shot, time_s);
    apply_shake(camera, shot, time_s);
    return camera;
}

CameraFit fit_camera(const BoundShot& shot, double open_s, double close_s, const RenderSpace& space, double start_m) {
    CameraFit fit;
    const auto at = [&](double u) {
        CameraState camera = camera_at(shot, open_s + u * (close_s - open_s));
        camera.start_m = start_m;
        return camera;
    };
    std::vector<CameraState> states{at(0)};
    if (close_s > open_s) {
        const std::vector<double> keys = camera_key_times(shot, open_s, close_s);
        const double tolerance = kMotionMargin * shot.shot().render.motion_tolerance_px;
        const int height = shot.shot().image.height, base = even_segments_for(keys);
        int at_least = static_cast<int>(std::min<std::size_t>(keys.size() + 1, kMostSegments));
        for (;; at_least = 2 * static_cast<int>(states.size() - 1)) {
            states = fit_keys(
                base, at_least, kMostSegments, at, std::equal_to<>(),
                [&](const CameraState& a, const CameraState& b, double u, const CameraState& wanted) {
                    return angle_between(a.rotation, wanted.rotation) + angle_between(wanted.rotation, b.rotation) <= kWidestStep &&
                           pixels_between(between(a, b, u), wanted, height) <= tolerance;
                });
            fit.error_px = states.size() > 1 ? worst_error_px(states, keys, height, at) : 0;
            if (fit.error_px <= tolerance || 2 * static_cast<int>(states.size() - 1) > kMostSegments) break;
        }
        for (const double u : keys) fit.corners_s.push_back(std::lerp(open_s, close_s, u));
    }
    for (CameraState& state : states) {
        if (&state != &states.front() && glm::dot((&state)[-1].rotation, state.rotation) < 0) state.rotation = -state.rotation;
        fit.keys.push_back(to_key<float>(state, space));
    }
    return fit;
}

kernels::Camera make_camera(const BoundShot& shot, double time_s) {
    kernels::Camera camera{};
    camera.blades = shot.shot().camera.blades;
    camera.far_clip = std::numeric_limits<float>::infinity();
    if (shot.bindings().camera_node < 0) return camera;
    const SceneCamera source = source_at(shot, time_s);
    camera.orthographic = source.orthographic;
    camera.near_clip = static_cast<float>(source.znear);
    if (source.zfar > 0) camera.far_clip = static_cast<float>(source.zfar);
    return camera;
}

std::vector<double> camera_discontinuities(const BoundShot& shot, double begin_s, double end_s) {
    std::vector<double> times;
    visit_tracks(shot.shot().camera, [&](const auto& track) {
        const std::vector<double> jumps = discontinuities(track, begin_s, end_s);
        times.insert(times.end(), jumps.begin(), jumps.end());
    });
    for (const DrivenProperty& driven : driven_of(shot)) {
        const std::vector<double> jumps = driven.discontinuities(begin_s, end_s, driven_offset_s(shot));
        times.insert(times.end(), jumps.begin(), jumps.end());
    }
    return times;
}

PixelScale::PixelScale(const CameraState& camera, int image_height)
    : position_(camera.position),
      forward_(camera.rotation * glm::dvec3(0, 0, -1)),
      scale_(0.5 * image_height / camera.tan_half_height),
      corner_(camera.tan_half_width * camera.tan_half_width + camera.tan_half_height * camera.tan_half_height),
      orthographic_(camera.orthographic) {}

}  // namespace kadr
