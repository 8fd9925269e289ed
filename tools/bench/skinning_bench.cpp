// Bending meshes: what their vertices cost, and what a refitted structure costs its rays against a new one.
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include <benchmark/benchmark.h>
#include <glm/gtc/matrix_transform.hpp>

#include "device/device.h"
#include "frame/deform_fit.h"
#include "frame/frame_state.h"
#include "frame/skinning.h"
#include "frame/snapshot.h"
#include "shot/shot_parser.h"

namespace kadr {
namespace {

constexpr std::size_t kVertices = 100'000, kJoints = 50, kInfluences = 4;

/// Points of a helix, each carried by four neighbouring joints.
GeometryData helix() {
    GeometryData g;
    g.skin.per_vertex = kInfluences;
    for (std::size_t i = 0; i < kVertices; ++i) {
        const double t = static_cast<double>(i) / kVertices, angle = 400 * std::numbers::pi * t;
        const auto x = static_cast<float>(std::cos(angle)), z = static_cast<float>(std::sin(angle));
        g.positions.push_back({x, static_cast<float>(2 * t - 1), z});
        g.normals.push_back({x, 0, z});
        for (std::size_t k = 0; k < kInfluences; ++k) {
            g.skin.joints.push_back(static_cast<std::uint16_t>(std::min(static_cast<std::size_t>(t * kJoints) + k, kJoints - 1)));
            g.skin.weights.push_back(0.25f);
        }
    }
    return g;
}

void skin_vertices(benchmark::State& state, Skinning skinning) {
    const GeometryData geometry = helix();
    DeformationPose pose;
    for (std::size_t j = 0; j < kJoints; ++j) pose.joints.push_back(glm::rotate(glm::dmat4(1), 0.02 * static_cast<double>(j), glm::dvec3(0, 1, 0)));
    std::vector<kernels::Vertex> vertices(kVertices);
    for (auto _ : state) {
        deform_vertices(geometry, VertexPose(pose, skinning), vertices, {});
        benchmark::DoNotOptimize(vertices.data());
    }
}
BENCHMARK_CAPTURE(skin_vertices, linear, Skinning::linear)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(skin_vertices, dual_quaternion, Skinning::dual_quaternion)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// A segment of an exposure of a mesh that bends by dual quaternions: its fit is measured, its two keys are made.
void blur_vertices(benchmark::State& state) {
    const GeometryData geometry = helix();
    Deformer deformer;
    deformer.skinning = Skinning::dual_quaternion;
    Scene scene;
    scene.nodes.emplace_back();
    scene.skins.push_back({"", {0}, {glm::dmat4(1)}, 0});
    deformer.skeleton = Skeleton(scene, 0);
    std::vector<DeformationPose> poses(5);
    for (std::size_t i = 0; i < poses.size(); ++i)
        for (std::size_t j = 0; j < kJoints; ++j)
            poses[i].joints.push_back(glm::rotate(glm::dmat4(1), 0.02 * static_cast<double>(j) + 1e-4 * static_cast<double>(i), glm::dvec3(0, 1, 0)));
    CameraState camera;
    camera.position = {0, 0, 5};
    const std::vector<PixelScale> scales(5, PixelScale(camera, 720));
    std::vector<kernels::Vertex> vertices(2 * kVertices);
    for (auto _ : state) {
        benchmark::DoNotOptimize(deformation_error_px(geometry, deformer, poses, {{glm::dmat4(1)}, scales, INFINITY}));
        for (std::size_t key = 0; key < 2; ++key)
            deform_vertices(geometry, VertexPose(poses[4 * key], deformer.skinning), std::span(vertices).subspan(key * kVertices, kVertices), {});
        benchmark::DoNotOptimize(vertices.data());
    }
}
BENCHMARK(blur_vertices)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// Rays through the sample `skin` without motion blur, after its structure was refitted from frame to frame, or built at once.
void render_bent(benchmark::State& state, bool refitted) {
    const std::string file = KADR_SOURCE_DIR "/shots/skin.yaml";
    ShotOverrides overrides;
    overrides.set = {{"shutter", "0"}, {"render.bounces", "0"}};
    overrides.width = 320, overrides.height = 180;
    const Shot shot = parse_shot(file, overrides);
    std::vector<SceneFileRequest> requests;
    for (const SceneSpec& spec : shot.scenes) requests.push_back({spec.id, spec.gltf, spec.where});
    const Scene scene = load_scene(requests);
    const BoundShot bound(shot, scene);
    const DeviceChoice choice = make_device({});
    choice.device->load(scene, nullptr);
    std::uint64_t updated = 0;
    for (int frame = refitted ? 0 : 20; frame <= 20; ++frame) {
        choice.device->set_frame(make_snapshots(bound, bound.sequence().frame(frame)).front());
        updated += choice.device->statistics().structures.updated;
    }
    Film film(320, 180, {});
    Pass pass;
    pass.sample_count = pass.total_samples = 16;
    for (auto _ : state) {
        film.clear();
        choice.device->render(pass, film);
    }
    state.counters["refits"] = static_cast<double>(updated);
}
BENCHMARK_CAPTURE(render_bent, refitted, true)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(render_bent, rebuilt, false)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace kadr
