#include "frame/camera_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/gtc/quaternion.hpp>

#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "frame/decompose.h"

namespace kadr {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
/// Of the distance: what a picture is high, at most, where rays start ahead of the camera.
constexpr double kNarrow = 1.0 / 32;
/// Triangles that are looked at one by one; of more, their meshes' surrounding balls.
constexpr std::size_t kMostTriangles = 4'000'000;

struct Box {
    glm::dvec3 low{kInfinite}, high{-kInfinite};
    void add_ball(const glm::dvec3& centre, double radius) { low = glm::min(low, centre - radius), high = glm::max(high, centre + radius); }
};

/// What one key of the camera sees until the next one, as a pyramid whose top is cut off: at the depth z, that is z along
/// the view axis, it is edge + slope * z wide to either side. In the units of the snapshot.
class View {
public:
    /// @param turn_rad, moved  to the neighbouring keys, at most
    View(const CameraState& camera, const RenderSpace& space, double turn_rad, double moved) : turn_rad_(turn_rad), moved_(moved), position_(space.from_world(camera.position)) {
        camera_from_space_ = glm::transpose(glm::mat3_cast(camera.rotation));
        const double corner = std::hypot(camera.tan_half_width, camera.tan_half_height);
        if (camera.orthographic) edge_ = corner / space.unit_m;
        else slope_ = corner + (camera.lens_radius > 0 ? camera.lens_radius / camera.focus_distance : 0);
        edge_ += camera.lens_radius / space.unit_m + moved;
        slope_ += std::tan(turn_rad);
    }

    /// Right, up and ahead.
    glm::dvec3 seen(const glm::dvec3& p) const {
        const glm::dvec3 local = camera_from_space_ * (p - position_);
        return {local.x, local.y, -local.z};
    }

    /// Depth at which a box of seen() coordinates begins to be in view; infinite: never.
    double depth_of(const Box& box) const {
        double depth = std::max(box.low.z, 0.0);
        for (int axis = 0; axis < 2; ++axis) {
            const double beside = std::max({box.low[axis], -box.high[axis], 0.0});
            if (beside > edge_) depth = std::max(depth, slope_ > 0 ? (beside - edge_) / slope_ : kInfinite);
        }
        return depth <= box.high.z ? depth : kInfinite;
    }

    /// That of a triangle of seen() coordinates: of what is left of it inside the pyramid.
    double depth_of(const std::array<glm::dvec3, 3>& corners) const {
        bool whole = true;
        for (int side = 0; side < kSides; ++side) {
            const auto outside = std::count_if(corners.begin(), corners.end(), [&](const glm::dvec3& p) { return height_over(side, p) < 0; });
            if (outside == 3) return kInfinite;
            whole = whole && outside == 0;
        }
        Polygon polygon{{corners[0], corners[1], corners[2]}, 3};
        for (int side = 0; side < kSides && !whole && polygon.count > 0; ++side) polygon = clip(polygon, side);
        double depth = kInfinite;
        for (std::size_t i = 0; i < polygon.count; ++i) depth = std::min(depth, polygon.points[i].z);
        return depth;
    }

    /// The least depth that something at this one can have until the camera is at a neighbouring key.
    double least_until_next(double depth) const {
        return depth * std::cos(turn_rad_) - (edge_ + slope_ * depth) * std::sin(turn_rad_) - moved_;
    }
    double half_size_at(double depth) const { return edge_ + slope_ * depth; }

private:
    static constexpr int kSides = 5;
    struct Polygon {
        std::array<glm::dvec3, 3 + kSides> points{};
        std::size_t count = 0;
    };

    /// At least 0 on the inner side.
    double height_over(int side, const glm::dvec3& p) const {
        const double half = edge_ + slope_ * p.z;
        switch (side) {
            case 0: return p.z;
            case 1: return half - p.x;
            case 2: return half + p.x;
            case 3: return half - p.y;
            default: return half + p.y;
        }
    }

    /// Source: Sutherland & Hodgman 1974, "Reentrant Polygon Clipping".
    Polygon clip(const Polygon& polygon, int side) const {
        Polygon kept;
        for (std::size_t i = 0; i < polygon.count; ++i) {
            const glm::dvec3 &a = polygon.points[i], &b = polygon.points[(i + 1) % polygon.count];
            const double from = height_over(side, a), to = height_over(side, b);
            if (from >= 0) kept.points[kept.count++] = a;
            if ((from >= 0) != (to >= 0)) kept.points[kept.count++] = glm::mix(a, b, from / (from - to));
        }
        return kept;
    }

    double turn_rad_, moved_, edge_ = 0, slope_ = 0;
    glm::dvec3 position_;
    glm::dmat3 camera_from_space_;
};

double angle_of(const glm::dquat& a, const glm::dquat& b) { return 2 * std::acos(std::min(std::abs(glm::dot(a, b)), 1.0)); }

std::vector<CameraState> cameras_of(const BoundShot& shot, double open_s, double close_s, std::size_t keys) {
    std::vector<CameraState> cameras;
    for (std::size_t i = 0; i < keys; ++i) cameras.push_back(camera_at(shot, keys > 1 ? std::lerp(open_s, close_s, static_cast<double>(i) / static_cast<double>(keys - 1)) : open_s));
    return cameras;
}

std::vector<View> views_of(const std::vector<CameraState>& cameras, const RenderSpace& space) {
    std::vector<View> views;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        double turn_rad = 0, moved = 0;
        for (const std::size_t next : {i - 1, i + 1})
            if (next < cameras.size()) {
                turn_rad = std::max(turn_rad, angle_of(cameras[i].rotation, cameras[next].rotation));
                moved = std::max(moved, glm::distance(cameras[i].position, cameras[next].position) / space.unit_m);
            }
        views.emplace_back(cameras[i], space, turn_rad, moved);
    }
    return views;
}

/// A motion frame of an instance as space_from_geometry.
glm::dmat4 frame_of(const MotionFrames& motion, std::size_t instance, std::size_t frame) {
    const std::size_t at = motion.headers[instance].first_frame + frame;
    glm::dmat4 place(1);
    if (motion.types[instance] == FrameType::matrix) {
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) place[column][row] = motion.matrices[at].matrix[row][column];
        return place;
    }
    const kernels::FrameSrt& srt = motion.srt[at];
    const glm::dmat3 turned = glm::mat3_cast(glm::angleAxis(static_cast<double>(srt.angle), glm::dvec3(srt.axis[0], srt.axis[1], srt.axis[2])));
    for (int c = 0; c < 3; ++c) place[c] = glm::dvec4(turned[c] * static_cast<double>(srt.scale[c]), 0);
    place[3] = glm::dvec4(srt.translation[0], srt.translation[1], srt.translation[2], 1);
    return place;
}

double length_of(const kernels::Vec3f& v) { return std::sqrt(static_cast<double>(dot(v, v))); }

/// Everything that camera rays may meet.
class Seen {
public:
    Seen(const Scene& scene, const SceneSnapshot& snapshot) : scene_(scene), snapshot_(snapshot) {
        for (const std::shared_ptr<const DeformedMesh>& mesh : snapshot.deformed) {
            double radius = 0;
            for (const kernels::Vertex& vertex : mesh->vertices) radius = std::max(radius, length_of(vertex.position));
            deformed_radii_.push_back(radius);
        }
    }

    double nearest(const View& view) const {
        std::vector<Candidate> candidates;
        double nearest = lights(view);
        for (std::size_t i = 0; i < snapshot_.instances.size(); ++i)
            if (const double depth = view.depth_of(box_of(view, i)); depth < nearest && shown(i)) candidates.push_back({depth, i});
        std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.depth < b.depth; });
        std::size_t left = kMostTriangles;
        for (const Candidate& candidate : candidates) {
            if (candidate.depth >= nearest) break;
            nearest = std::min(nearest, refined(view, candidate, left));
        }
        return nearest;
    }

private:
    struct Candidate {
        double depth;
        std::size_t instance;
    };

    const GeometryData& mesh_of(std::size_t i) const { return scene_.geometries[snapshot_.instances[i].geometry]; }
    bool shown(std::size_t i) const { return snapshot_.instances[i].mask != 0 && !mesh_of(i).indices.empty(); }

    double radius_of(std::size_t i) const {
        const std::int32_t deformed = snapshot_.instances[i].deformed;
        return deformed >= 0 ? deformed_radii_[static_cast<std::size_t>(deformed)] : std::sqrt(3.0);  // positions lie in [-1, 1]
    }

    /// Around its places over the shutter: they go in straight lines from frame to frame, and turns stay within a ball.
    Box box_of(const View& view, std::size_t i) const {
        Box box;
        for (std::size_t k = 0; k < snapshot_.motion.headers[i].frame_count; ++k) {
            const glm::dmat4 place = frame_of(snapshot_.motion, i, k);
            const double stretch = std::sqrt(glm::dot(place[0], place[0]) + glm::dot(place[1], place[1]) + glm::dot(place[2], place[2]));
            box.add_ball(view.seen(glm::dvec3(place[3])), radius_of(i) * stretch);
        }
        return box;
    }

    double refined(const View& view, const Candidate& candidate, std::size_t& left) const {
        const std::size_t i = candidate.instance;
        const GeometryData& mesh = mesh_of(i);
        if (snapshot_.motion.headers[i].frame_count != 1 || snapshot_.instances[i].deformed >= 0 || mesh.indices.size() / 3 > left) return candidate.depth;
        left -= mesh.indices.size() / 3;
        const glm::dmat4 place = frame_of(snapshot_.motion, i, 0);
        std::vector<glm::dvec3> corners;
        for (const kernels::Vec3f& p : mesh.positions) corners.push_back(view.seen(glm::dvec3(place * glm::dvec4(p.x, p.y, p.z, 1))));
        double nearest = kInfinite;
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
            nearest = std::min(nearest, view.depth_of({corners[mesh.indices[t]], corners[mesh.indices[t + 1]], corners[mesh.indices[t + 2]]}));
        return nearest;
    }

    /// Those with a surface, which rays meet as well.
    double lights(const View& view) const {
        double nearest = kInfinite;
        for (const LightKeys& light : snapshot_.lights) {
            Box box;
            for (std::uint32_t k = light.first; k < light.first + light.count; ++k) {
                const kernels::Light& key = snapshot_.light_keys[k];
                const double radius = key.kind == kernels::LightKind::area ? length_of(key.axis_u) + length_of(key.axis_v) : static_cast<double>(key.radius);
                if (radius > 0 && key.kind != kernels::LightKind::directional) box.add_ball(view.seen({key.position.x, key.position.y, key.position.z}), radius);
            }
            nearest = std::min(nearest, view.depth_of(box));
        }
        return nearest;
    }

    const Scene& scene_;
    const SceneSnapshot& snapshot_;
    std::vector<double> deformed_radii_;
};

bool is_narrow(const CameraState& camera) { return camera.orthographic || camera.tan_half_height < kNarrow; }

}  // namespace

double camera_start_m(const BoundShot& shot, double open_s, double close_s, const SceneSnapshot& snapshot) {
    const std::vector<CameraState> cameras = cameras_of(shot, open_s, close_s, snapshot.camera_keys.size());
    if (!std::all_of(cameras.begin(), cameras.end(), is_narrow)) return 0;
    const RenderSpace space = snapshot.space();
    const Seen seen(shot.scene(), snapshot);
    double start = kInfinite;
    for (const View& view : views_of(cameras, space)) {
        const double nearest = seen.nearest(view);
        if (!std::isfinite(nearest)) continue;  // nothing is in view
        const double depth = view.least_until_next(nearest);
        // A picture's width before it: what floats leave of places stays behind the plane.
        start = std::min(start, depth - 2 * view.half_size_at(depth));
        if (!(depth * kNarrow > view.half_size_at(0))) return 0;
    }
    if (!std::isfinite(start) || start <= 0) return 0;
    return static_cast<double>(static_cast<float>(start)) * space.unit_m;
}

}  // namespace kadr
