#include <string>

#include <benchmark/benchmark.h>

#include "frame/frame_state.h"
#include "frame/snapshot.h"
#include "scene/scene.h"
#include "shot/shot_parser.h"

namespace kadr {
namespace {

const std::string kShots = KADR_SOURCE_DIR "/shots/";

void load(benchmark::State& state, const char* file, bool decode_textures) {
    LoadOptions options;
    options.decode_textures = decode_textures;
    for (auto _ : state) benchmark::DoNotOptimize(load_scene({{"scene", kShots + "assets/" + file, {}}}, options));
}
BENCHMARK_CAPTURE(load, robot, "robot.glb", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(load, robot_without_textures, "robot.glb", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(load, spheres, "spheres.glb", true)->Unit(benchmark::kMillisecond);

/// Copies the first mesh of a loaded scene onto many root nodes.
void multiply_nodes(Scene& scene, int count) {
    Node copy;
    for (const Node& node : scene.nodes)
        if (!node.primitives.empty()) copy = node;
    copy.parent = -1;
    copy.children.clear();
    for (int i = 0; i < count; ++i) {
        copy.name = "copy " + std::to_string(i);
        copy.translation = {i % 100, 0, i / 100};
        scene.files[0].roots.push_back(static_cast<int>(scene.nodes.size()));
        scene.nodes.push_back(copy);
    }
    scene.files[0].node_count += count;
}

/// One snapshot of N instances: still, or all of them turning with their scene.
void snapshot(benchmark::State& state, const char* transform) {
    const std::string text = std::string("kadr: 1\nscenes:\n  - { id: solids, gltf: assets/solids.glb") + transform +
                             " }\ncamera: { position: [0, 20, 60] }\nrender: { integrator: direct }\n";
    const Shot shot = parse_shot_text(text, kShots + "snapshot.yaml");
    Scene scene = load_scene({{"solids", shot.scenes[0].gltf, {}}});
    multiply_nodes(scene, static_cast<int>(state.range(0)));
    const BoundShot bound(shot, scene);
    const FrameTime frame = bound.sequence().frame(1);
    for (auto _ : state) benchmark::DoNotOptimize(make_snapshots(bound, frame));
    state.SetItemsProcessed(state.iterations() * state.range(0));
}
constexpr char kStill[] = "";
constexpr char kTurning[] =
    ", transform: { rotate: { axis: [0, 1, 0], angle: { keys: { 0 s: 0 deg, 1 s: 90 deg } } } }";
BENCHMARK_CAPTURE(snapshot, still, kStill)->Arg(100)->Arg(10000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(snapshot, turning, kTurning)->Arg(100)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kadr
