#include "render/motion_paths.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "frame/snapshot.h"

namespace kadr {
namespace {

constexpr int kMostSteps = 24;          // from frame to frame: 15 degrees each of a whole turn
constexpr std::size_t kSamples = 4000;  // of a path, roughly

void sort_unique(std::vector<double>& times) {
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
}

struct Box {
    glm::dvec3 low{HUGE_VAL}, high{-HUGE_VAL};
    void add(const glm::dvec3& point) { low = glm::min(low, point), high = glm::max(high, point); }
    glm::dvec3 corner(int i) const { return {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}; }
    glm::dvec3 centre() const { return 0.5 * (low + high); }
    double radius() const { return 0.5 * glm::distance(low, high); }
};

Box box_of(const GeometryData& geometry) {
    Box box;
    for (const kernels::Vec3f& p : geometry.positions)
        box.add(geometry.centre + geometry.scale * glm::dvec3(p.x, p.y, p.z));
    return box;
}

/// What moves as a whole: a scene (node -1), or a node whose parents stand still.
struct Mover {
    int file = -1, node = -1;
    bool operator<(const Mover& other) const { return std::pair(file, node) < std::pair(other.file, other.node); }
};

glm::dmat4 place_of(const BoundShot& shot, const Mover& mover, double time_s) {
    const Bindings& bindings = shot.bindings();
    return mover.node < 0 ? bindings.rig.scene_transform(mover.file, time_s) : bindings.node_transform(mover.node, time_s);
}

Mover mover_of(const BoundShot& shot, int node) {
    const NodeRig& rig = shot.bindings().rig;
    const int file = rig.file_of(node);
    const std::vector<Node>& nodes = shot.scene().nodes;
    const auto parent = [&](int i) { return nodes[static_cast<std::size_t>(i)].parent; };
    while (parent(node) >= 0 && rig.moves(parent(node))) node = parent(node);
    const bool scene_moves = varies(shot.shot().scenes[static_cast<std::size_t>(file)].transform);
    return {file, parent(node) < 0 && scene_moves ? -1 : node};
}

/// The boxes of all that moves, each in its mover's own coordinates at one time.
std::map<Mover, Box> moving_boxes(const BoundShot& shot, double now_s) {
    std::map<Mover, Box> boxes;
    std::map<std::uint32_t, Box> of_geometry;
    for (const InstanceSeed& seed : shot.bindings().seeds) {
        if (!shot.bindings().rig.moves(seed.node)) continue;
        const auto [box, is_new] = of_geometry.try_emplace(seed.geometry);
        if (is_new) box->second = box_of(shot.scene().geometries[seed.geometry]);
        const Mover mover = mover_of(shot, seed.node);
        const glm::dmat4 mover_from_node =
            glm::inverse(place_of(shot, mover, now_s)) * shot.bindings().node_transform(seed.node, now_s);
        for (int i = 0; i < 8; ++i)
            boxes[mover].add(glm::dvec3(mover_from_node * glm::dvec4(box->second.corner(i), 1)));
    }
    return boxes;
}

/// How far apart the ends of a path lie: the diagonal of its box.
double extent_of(const MotionPath& path, const std::vector<FrameTime>& frames) {
    Box box;
    for (const FrameTime& frame : frames)
        for (const double time : {frame.open_s, frame.time_s(), frame.close_s}) box.add(path.position(time));
    return 2 * box.radius();
}

std::string name_of(const BoundShot& shot, const Mover& mover) {
    if (mover.node < 0) return shot.scene().files[static_cast<std::size_t>(mover.file)].id;
    return node_path(shot.scene(), mover.file, mover.node);
}

MotionPath follow(const BoundShot& shot, const Mover& mover, const Box& box, const glm::dvec3& point) {
    MotionPath path{MotionPath::Subject::object, name_of(shot, mover), {}, box.radius()};
    path.position = [&shot, mover, point](double time_s) {
        return glm::dvec3(place_of(shot, mover, time_s) * glm::dvec4(point, 1));
    };
    return path;
}

MotionPath object_path(const BoundShot& shot, const Mover& mover, const Box& box, const PathTimes& times) {
    MotionPath best = follow(shot, mover, box, box.centre());
    // Where the corners go so much farther than the middle, it is the turning that one wants to see.
    constexpr double kFarther = 3;
    double farthest = kFarther * extent_of(best, times.frames);
    for (int i = 0; i < 8; ++i) {
        MotionPath corner = follow(shot, mover, box, box.corner(i));
        const double extent = extent_of(corner, times.frames);
        if (!(extent > farthest)) continue;
        farthest = extent;
        best = std::move(corner);
        best.name += " (a corner)";
    }
    return best;
}

void add_camera(const BoundShot& shot, std::vector<MotionPath>& paths) {
    paths.push_back(
        {MotionPath::Subject::camera, "camera", [&shot](double t) { return camera_at(shot, t).position; }, 0});
    const CameraSpec& camera = shot.shot().camera;
    if (camera.gltf) return;
    const auto target = [&shot, &look_at = camera.look_at](double time_s) {
        if (const auto* node = std::get_if<NodeReference>(&look_at)) return shot.bindings().position_of(*node, time_s);
        return evaluate(std::get<0>(look_at), time_s);
    };
    paths.push_back({MotionPath::Subject::target, "look at", target, 0});
}

void add_lights(const BoundShot& shot, std::vector<MotionPath>& paths) {
    for (const LightSpec& light : shot.shot().lights) {
        if (light.kind == LightKind::directional) continue;
        const auto position = [&light](double time_s) { return evaluate(light.position, time_s); };
        paths.push_back({MotionPath::Subject::light, light.id, position, 0});
    }
    for (const LightSeed& seed : shot.bindings().lights) {
        const Bindings& bindings = shot.bindings();
        const int node = seed.node;
        if (seed.copy != bindings.first_copy(bindings.rig.file_of(node))) continue;
        if (shot.scene()
                .lights[static_cast<std::size_t>(shot.scene().nodes[static_cast<std::size_t>(node)].light)]
                .kind == kernels::LightKind::directional)
            continue;
        const auto position = [&bindings, seed](double t) { return glm::dvec3(bindings.node_transform(seed.node, seed.copy, t)[3]); };
        paths.push_back({MotionPath::Subject::light, node_path(shot.scene(), bindings.rig.file_of(node), node), position, 0});
    }
}

}  // namespace

PathTimes path_times(const BoundShot& shot, const std::vector<int>& frames) {
    PathTimes times;
    for (const int number : frames) times.frames.push_back(shot.sequence().frame(number));
    const FrameTime &first = times.frames.front(), &last = times.frames.back();
    const double begin_s = std::min(first.open_s, first.time_s()), end_s = std::max(last.close_s, last.time_s());
    const int whole = last.number - first.number + 1;
    const int steps = std::clamp(static_cast<int>(kSamples) / whole, 1, kMostSteps) * whole;
    for (int i = 0; i <= steps; ++i)
        times.samples_s.push_back(std::lerp(begin_s, end_s, static_cast<double>(i) / steps));
    for (const FrameTime& frame : times.frames)
        times.samples_s.insert(times.samples_s.end(), {frame.open_s, frame.time_s(), frame.close_s});
    times.jumps_s = shot_discontinuities(shot, begin_s, end_s);
    // Both sides of a jump, so that the path reaches up to it.
    const double inset = 1e-7 * (end_s - begin_s);
    for (const double jump : times.jumps_s) times.samples_s.insert(times.samples_s.end(), {jump - inset, jump + inset});
    std::erase_if(times.samples_s, [&](double time) { return time < begin_s || time > end_s; });
    sort_unique(times.samples_s);
    return times;
}

std::vector<MotionPath> motion_paths(const BoundShot& shot, const PathTimes& times, double now_s) {
    std::vector<MotionPath> paths;
    add_camera(shot, paths);
    add_lights(shot, paths);
    for (const auto& [mover, box] : moving_boxes(shot, now_s)) paths.push_back(object_path(shot, mover, box, times));
    std::erase_if(paths, [&](const MotionPath& path) { return !(extent_of(path, times.frames) > 1e-9); });
    return paths;
}

}  // namespace kadr
