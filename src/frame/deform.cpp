#include "frame/deform.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include <fmt/format.h>

#include "base/hash.h"
#include "base/text.h"
#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "frame/deform_fit.h"
#include "frame/motion_frames.h"
#include "frame/key_grid.h"
#include "frame/problem.h"

namespace kadr {

namespace {

constexpr double kMargin = 0.9;   // the error is looked at in three places of a segment, not everywhere
constexpr int kBoundTimes = 9;    // at which the bounds of a deformer are taken over the shot

// ---------------------------------------------------------------------------------------------------- once a shot

bool bends(const Scene& scene, const MorphRig& morphs, const InstanceSeed& seed) {
    const Node& node = scene.nodes[static_cast<std::size_t>(seed.mesh_node)];
    const GeometryData& geometry = scene.geometries[seed.geometry];
    if (node.skin >= 0 && geometry.skin.per_vertex > 0) return true;
    const bool weighs = std::any_of(node.weights.begin(), node.weights.end(), [](double weight) { return weight != 0; });
    return !geometry.targets.empty() && (weighs || morphs.moves(seed.mesh_node));
}

std::vector<JointBox> boxes_of(const GeometryData& geometry, bool skinned) {
    std::map<std::size_t, JointBox> boxes;
    const auto add = [&](std::size_t joint, const kernels::Vec3f& p) {
        const glm::dvec3 at(p.x, p.y, p.z);
        const auto [place, fresh] = boxes.try_emplace(joint, JointBox{at, at, joint});
        place->second.low = glm::min(place->second.low, at);
        place->second.high = glm::max(place->second.high, at);
    };
    const auto slots = skinned ? static_cast<std::size_t>(geometry.skin.per_vertex) : std::size_t{1};
    for (std::size_t v = 0; v < geometry.positions.size(); ++v)
        for (std::size_t i = v * slots; i < (v + 1) * slots; ++i)
            if (!skinned || geometry.skin.weights[i] > 0) add(skinned ? geometry.skin.joints[i] : 0, geometry.positions[v]);
    std::vector<JointBox> result;
    for (const auto& [joint, box] : boxes) result.push_back(box);
    return result;
}

std::vector<double> target_sizes(const GeometryData& geometry) {
    std::vector<double> sizes;
    for (const MorphTarget& target : geometry.targets) {
        double longest = 0;
        for (const kernels::Vec3f& d : target.positions) longest = std::max(longest, glm::length(glm::dvec3(d.x, d.y, d.z)));
        sizes.push_back(longest);
    }
    return sizes;
}

[[noreturn]] void refuse_infinite(const BoundShot& shot, const Bindings& bindings, const Deformer& deformer, double time_s) {
    const auto file = static_cast<std::size_t>(bindings.rig.file_of(deformer.mesh_node));
    const std::string& name = shot.scene().nodes[static_cast<std::size_t>(deformer.mesh_node)].name;
    throw InputError(problem_at(shot.shot().scenes[file].where,
                                fmt::format("the mesh of node '{}' has joints or morph weights that are not finite at {} s", name, format_number(time_s)),
                                "expected finite transforms and weights"));
}

DeformationPose finite_pose(const BoundShot& shot, const Bindings& bindings, const Deformer& deformer, double time_s, double clip_offset_s = 0) {
    DeformationPose pose = deformer.pose(shot.scene(), bindings, time_s, clip_offset_s);
    if (!pose.finite()) refuse_infinite(shot, bindings, deformer, time_s);
    return pose;
}

/// Centre and scale that hold the mesh over the whole shot, as far as some times of it tell.
void set_bounds(const BoundShot& shot, const Bindings& bindings, Deformer& deformer) {
    const std::vector<int>& frames = shot.timing().frames;
    const double begin = shot.sequence().frame(frames.front()).open_s, end = shot.sequence().frame(frames.back()).close_s;
    std::vector<glm::dvec3> corners;
    for (int i = 0; i < kBoundTimes; ++i)
        add_corners(deformer, finite_pose(shot, bindings, deformer, std::lerp(begin, end, i / (kBoundTimes - 1.0))), corners);
    glm::dvec3 low = corners.front(), high = low;
    for (const glm::dvec3& corner : corners) low = glm::min(low, corner), high = glm::max(high, corner);
    const glm::dvec3 half = 0.5 * (high - low);
    deformer.centre = 0.5 * (low + high);
    deformer.scale = std::max({half.x, half.y, half.z});
    if (!(deformer.scale > 0)) deformer.scale = 1;  // everything in one point
}

Deformer make_deformer(const BoundShot& shot, const Bindings& bindings, const InstanceSeed& seed) {
    const Node& node = shot.scene().nodes[static_cast<std::size_t>(seed.mesh_node)];
    const GeometryData& geometry = shot.scene().geometries[seed.geometry];
    const bool skinned = node.skin >= 0 && geometry.skin.per_vertex > 0;
    Deformer deformer;
    deformer.mesh_node = seed.mesh_node;
    deformer.geometry = seed.geometry;
    if (skinned) deformer.skeleton = Skeleton(shot.scene(), node.skin);
    deformer.skinning = shot.shot().scenes[static_cast<std::size_t>(bindings.rig.file_of(seed.mesh_node))].skinning;
    deformer.boxes = boxes_of(geometry, skinned);
    deformer.target_sizes = target_sizes(geometry);
    set_bounds(shot, bindings, deformer);
    return deformer;
}

// --------------------------------------------------------------------------------------------------- once a frame

std::vector<double> key_times(const Bindings& bindings, const Deformer& deformer, double open_s, double close_s) {
    std::vector<double> times = bindings.morphs.key_times_of(deformer.mesh_node, open_s, close_s);
    if (deformer.skeleton)
        for (const int node : deformer.skeleton->nodes()) {
            const std::vector<double> more = bindings.rig.key_times_of(node, open_s, close_s);
            times.insert(times.end(), more.begin(), more.end());
        }
    for (double& time : times) time = (time - open_s) / (close_s - open_s);
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < 1e-9; }), times.end());
    return times;
}

/// The part of the shutter that is fitted, and the camera in it.
class Part {
public:
    Part(const BoundShot& shot, double open_s, double close_s, const glm::dvec3& origin) : shot_(shot), open_s_(open_s), close_s_(close_s), origin_(origin) {}
    double open_s() const { return open_s_; }
    double close_s() const { return close_s_; }
    double time(double u) const { return open_s_ + u * (close_s_ - open_s_); }
    /// The camera's view at 4 * segments + 1 times.
    std::span<const PixelScale> scales(int segments) {
        std::vector<PixelScale>& scales = scales_[segments];
        for (int i = static_cast<int>(scales.size()); i <= 4 * segments; ++i) {
            CameraState camera = camera_at(shot_, time(i / (4.0 * segments)));
            camera.position -= origin_;
            scales.emplace_back(camera, shot_.shot().image.height);
        }
        return scales;
    }

private:
    const BoundShot& shot_;
    double open_s_, close_s_;
    glm::dvec3 origin_;
    std::map<int, std::vector<PixelScale>> scales_;
};

struct FittedPoses {
    std::vector<DeformationPose> keys;
    double error_px = 0;
};

FittedPoses fit_poses(const BoundShot& shot, const Deformer& deformer, Part& part, DeformationView view) {
    const Bindings& bindings = shot.bindings();
    const GeometryData& geometry = shot.scene().geometries[deformer.geometry];
    if (!(part.close_s() > part.open_s())) return {{finite_pose(shot, bindings, deformer, part.open_s())}, 0};
    const std::vector<double> times = key_times(bindings, deformer, part.open_s(), part.close_s());
    const int base = even_segments_for(times);
    for (int segments = refined_segments(base, base > 1 || times.empty() ? 1 : static_cast<int>(times.size()) + 1);; segments *= 2) {
        std::vector<DeformationPose> poses;
        for (int i = 0; i <= 4 * segments; ++i) poses.push_back(finite_pose(shot, bindings, deformer, part.time(i / (4.0 * segments))));
        if (std::all_of(poses.begin(), poses.end(), [&](const DeformationPose& pose) { return nearly_same(pose, poses[0]); })) return {{poses[0]}, 0};
        view.scales = part.scales(segments);
        const bool last = 2 * segments > kMostSegments;
        const double enough = view.enough_px;
        if (last) view.enough_px = INFINITY;  // the figure is reported: measure it to the end
        const double error = deformation_error_px(geometry, deformer, poses, view);
        if (error > enough && !last) continue;
        FittedPoses fitted{{}, error};
        for (std::size_t i = 0; i < poses.size(); i += 4) fitted.keys.push_back(std::move(poses[i]));
        return fitted;
    }
}

std::uint64_t version_of(const std::vector<DeformationPose>& keys) {
    Hasher hasher;
    for (const DeformationPose& key : keys) {
        for (const glm::dmat4& joint : key.joints)
            for (int i = 0; i < 4; ++i)
                for (int k = 0; k < 3; ++k) hasher.add(joint[i][k]);
        for (const double weight : key.weights) hasher.add(weight);
        hasher.add(std::int64_t{0});
    }
    return hasher.finish().low;
}

std::shared_ptr<const DeformedMesh> make_mesh(const GeometryData& geometry, const Deformer& deformer, std::uint32_t index, const FittedPoses& fitted, std::uint64_t version) {
    auto mesh = std::make_shared<DeformedMesh>();
    const std::size_t count = geometry.positions.size();
    mesh->geometry = deformer.geometry;
    mesh->deformer = index;
    mesh->key_count = static_cast<std::uint32_t>(fitted.keys.size());
    mesh->version = version;
    mesh->error_px = fitted.error_px;
    mesh->vertices.resize(count * fitted.keys.size());
    mesh->tangents.resize(geometry.tangents.size() * fitted.keys.size());
    for (std::size_t k = 0; k < fitted.keys.size(); ++k)
        deform_vertices(geometry, VertexPose(fitted.keys[k], deformer.skinning), std::span(mesh->vertices).subspan(k * count, count),
                        std::span(mesh->tangents).subspan(k * geometry.tangents.size(), geometry.tangents.size()));
    return mesh;
}

}  // namespace

void bind_deformers(const BoundShot& shot, Bindings& bindings) {
    for (InstanceSeed& seed : bindings.seeds) {
        if (!bends(shot.scene(), bindings.morphs, seed)) continue;
        seed.deformer = static_cast<int>(bindings.deformers.size());
        bindings.deformers.push_back(make_deformer(shot, bindings, seed));
        if (bindings.deformers.back().skeleton) seed.node = bindings.deformers.back().skeleton->root();
    }
}

void add_deformed(const BoundShot& shot, double open_s, double close_s, SceneSnapshot& snapshot) {
    const Bindings& bindings = shot.bindings();
    if (bindings.deformers.empty()) return;
    Part part(shot, open_s, close_s, snapshot.render_origin);
    std::map<int, std::vector<std::size_t>> shown;  // deformer -> instances
    for (std::size_t i = snapshot.instances.shared_size(); i < snapshot.instances.size(); ++i)
        if (const int deformer = bindings.seed_of(snapshot.instances[i].id).deformer; deformer >= 0) shown[deformer].push_back(i);
    double error_px = 0;
    for (const auto& [index, instances] : shown) {
        const Deformer& deformer = bindings.deformers[static_cast<std::size_t>(index)];
        DeformationView view;
        view.enough_px = kMargin * kDeformationShare * shot.shot().render.motion_tolerance_px;
        for (const std::size_t i : instances) {
            view.world_from_deformed.push_back(interpolate(snapshot.motion, i, 0));  // relative to the origin
            snapshot.instances.edit(i).deformed = static_cast<int>(snapshot.deformed.size());
        }
        const FittedPoses fitted = fit_poses(shot, deformer, part, view);
        const std::uint64_t version = version_of(fitted.keys);
        std::shared_ptr<const DeformedMesh> mesh = bindings.deformed->find(static_cast<std::uint32_t>(index), version);
        if (!mesh) bindings.deformed->keep(mesh = make_mesh(shot.scene().geometries[deformer.geometry], deformer, static_cast<std::uint32_t>(index), fitted, version));
        error_px = std::max(error_px, fitted.error_px);
        snapshot.deformed.push_back(std::move(mesh));
    }
    snapshot.motion.max_error_px += error_px;
}

std::vector<std::vector<kernels::Vec3f>> deformed_positions(const BoundShot& shot, const SceneSnapshot& snapshot, double time_s) {
    std::vector<std::vector<kernels::Vec3f>> result;
    for (const auto& mesh : snapshot.deformed) {
        const Deformer& deformer = shot.bindings().deformers[mesh->deformer];
        const GeometryData& geometry = shot.scene().geometries[deformer.geometry];
        std::vector<kernels::Vertex> vertices(geometry.positions.size());
        deform_vertices(geometry, VertexPose(finite_pose(shot, shot.bindings(), deformer, time_s), deformer.skinning), vertices, {});
        std::vector<kernels::Vec3f>& positions = result.emplace_back();
        for (const kernels::Vertex& vertex : vertices) positions.push_back(vertex.position);
    }
    return result;
}

}  // namespace kadr
