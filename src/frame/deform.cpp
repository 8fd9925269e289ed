#include "frame/deform.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <mutex>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <tbb/parallel_for.h>

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

[[noreturn]] void refuse_infinite(const BoundShot& shot, const Bindings& bindings, const Deformer& deformer, double time_s) {
    const auto file = static_cast<std::size_t>(bindings.rig.file_of(deformer.mesh_node));
    const std::string& name = shot.scene().nodes[static_cast<std::size_t>(deformer.mesh_node)].name;
    throw InputError(problem_at(shot.shot().scenes[file].where,
                                fmt::format("the mesh of node '{}' has joints or morph weights that are not finite at {} s", name, format_number(time_s)),
                                "expected finite transforms and weights"));
}

std::vector<double> key_times(const Bindings& bindings, const BentMesh& mesh, double open_s, double close_s) {
    const Deformer& deformer = *mesh.deformer;
    std::vector<double> times = bindings.morphs.key_times_of(deformer.mesh_node, open_s, close_s, mesh.clip_offset_s);
    if (deformer.skeleton)
        for (const int node : deformer.skeleton->nodes()) {
            const std::vector<double> more = bindings.rig.key_times_of(node, open_s, close_s, mesh.clip_offset_s);
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
    /// The camera's view at 4 * segments + 1 times. Many threads may ask.
    std::span<const PixelScale> scales(int segments) {
        const std::lock_guard lock(mutex_);
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
    std::mutex mutex_;
    std::map<int, std::vector<PixelScale>> scales_;  ///< lists stay as they are once they are made
};

struct FittedPoses {
    std::vector<DeformationPose> keys;
    double error_px = 0;
};

FittedPoses fit_poses(const BoundShot& shot, const BentMesh& mesh, Part& part, DeformationView view) {
    const Bindings& bindings = shot.bindings();
    const Deformer& deformer = *mesh.deformer;
    const auto pose_at = [&](double time_s) { return finite_pose(shot, bindings, deformer, time_s, mesh.clip_offset_s); };
    const GeometryData& geometry = shot.scene().geometries[deformer.geometry];
    if (!(part.close_s() > part.open_s())) return {{pose_at(part.open_s())}, 0};
    const std::vector<double> times = key_times(bindings, mesh, part.open_s(), part.close_s());
    const int base = even_segments_for(times);
    for (int segments = refined_segments(base, base > 1 || times.empty() ? 1 : static_cast<int>(times.size()) + 1);; segments *= 2) {
        std::vector<DeformationPose> poses;
        for (int i = 0; i <= 4 * segments; ++i) poses.push_back(pose_at(part.time(i / (4.0 * segments))));
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

std::shared_ptr<const DeformedMesh> make_mesh(const GeometryData& geometry, const Deformer& deformer, std::uint32_t number, const FittedPoses& fitted, std::uint64_t version) {
    auto mesh = std::make_shared<DeformedMesh>();
    const std::size_t count = geometry.positions.size();
    mesh->geometry = deformer.geometry;
    mesh->number = number;
    mesh->key_count = static_cast<std::uint32_t>(fitted.keys.size());
    mesh->version = version;
    mesh->error_px = fitted.error_px;
    mesh->vertices.resize(count * fitted.keys.size());
    mesh->tangents.resize(geometry.tangents.size() * fitted.keys.size());
    auto poses = std::make_shared<std::vector<VertexPose>>();
    for (const DeformationPose& key : fitted.keys) poses->emplace_back(key, deformer.skinning);
    mesh->poses = poses;
    for (std::size_t k = 0; k < fitted.keys.size(); ++k)
        deform_vertices(geometry, (*poses)[k], std::span(mesh->vertices).subspan(k * count, count),
                        std::span(mesh->tangents).subspan(k * geometry.tangents.size(), geometry.tangents.size()));
    return mesh;
}

/// A bent mesh and the instances of a snapshot that show it.
struct Shown {
    std::uint32_t number = 0;
    std::vector<std::size_t> instances;
};

std::vector<Shown> shown_meshes(const Bindings& bindings, const SceneSnapshot& snapshot) {
    std::map<std::uint32_t, std::vector<std::size_t>> by_number;
    for (std::size_t i = snapshot.instances.shared_size(); i < snapshot.instances.size(); ++i) {
        const Instance instance = bindings.instances[snapshot.instances[i].id];
        if (instance.seed->deformer >= 0) by_number[bindings.bent_mesh_of(instance)].push_back(i);
    }
    std::vector<Shown> shown;
    for (auto& [number, instances] : by_number) shown.push_back({number, std::move(instances)});
    return shown;
}

std::shared_ptr<const DeformedMesh> bend(const BoundShot& shot, const Shown& shown, Part& part, const MotionFrames& motion, double unit_m) {
    const Bindings& bindings = shot.bindings();
    const BentMesh bent = bindings.bent_mesh(shown.number);
    DeformationView view;
    view.enough_px = kMargin * kDeformationShare * shot.shot().render.motion_tolerance_px;
    const glm::dmat4 metres = glm::scale(glm::dmat4(1), glm::dvec3(unit_m));
    for (const std::size_t i : shown.instances) view.world_from_deformed.push_back(metres * interpolate(motion, i, 0));  // relative to the origin
    const FittedPoses fitted = fit_poses(shot, bent, part, view);
    const std::uint64_t version = version_of(fitted.keys);
    if (auto known = bindings.deformed->find(shown.number, version)) return known;
    auto mesh = make_mesh(shot.scene().geometries[bent.deformer->geometry], *bent.deformer, shown.number, fitted, version);
    bindings.deformed->keep(mesh);
    return mesh;
}

}  // namespace

DeformationPose finite_pose(const BoundShot& shot, const Bindings& bindings, const Deformer& deformer, double time_s, double clip_offset_s) {
    DeformationPose pose = deformer.pose(shot.scene(), bindings, time_s, clip_offset_s);
    if (!pose.finite()) refuse_infinite(shot, bindings, deformer, time_s);
    return pose;
}

void add_deformed(const BoundShot& shot, double open_s, double close_s, SceneSnapshot& snapshot) {
    const Bindings& bindings = shot.bindings();
    if (bindings.deformers.empty()) return;
    Part part(shot, open_s, close_s, snapshot.render_origin);
    const std::vector<Shown> shown = shown_meshes(bindings, snapshot);
    snapshot.deformed.resize(shown.size());
    // Each mesh is skinned in parallel, but most of a crowd's are too small for that.
    tbb::parallel_for(std::size_t{0}, shown.size(), [&](std::size_t i) { snapshot.deformed[i] = bend(shot, shown[i], part, snapshot.motion, snapshot.unit_m); });
    double error_px = 0;
    for (std::size_t i = 0; i < shown.size(); ++i) {
        for (const std::size_t instance : shown[i].instances) snapshot.instances.edit(instance).deformed = static_cast<int>(i);
        error_px = std::max(error_px, snapshot.deformed[i]->error_px);
    }
    snapshot.motion.max_error_px += error_px;
}

std::vector<std::vector<kernels::Vec3f>> deformed_positions(const BoundShot& shot, const SceneSnapshot& snapshot, double time_s) {
    std::vector<std::vector<kernels::Vec3f>> result;
    for (const auto& mesh : snapshot.deformed) {
        const auto [bent, clip_offset_s] = shot.bindings().bent_mesh(mesh->number);
        const Deformer& deformer = *bent;
        const GeometryData& geometry = shot.scene().geometries[deformer.geometry];
        std::vector<kernels::Vertex> vertices(geometry.positions.size());
        deform_vertices(geometry, VertexPose(finite_pose(shot, shot.bindings(), deformer, time_s, clip_offset_s), deformer.skinning), vertices, {});
        std::vector<kernels::Vec3f>& positions = result.emplace_back();
        for (const kernels::Vertex& vertex : vertices) positions.push_back(vertex.position);
    }
    return result;
}

}  // namespace kadr
