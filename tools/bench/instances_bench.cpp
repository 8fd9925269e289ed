// From frame to frame with many copies of one mesh: what make_snapshots (frame/) and set_frame (the CPU device) cost.
#include <fstream>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "device/device.h"
#include "frame/frame_state.h"
#include "frame/snapshot.h"

namespace kadr {
namespace {

/// A small tetrahedron, `count` times in a cube, 24 frames a second with a half open shutter. Where it drifts, the whole
/// scene moves; where each sways, every copy plays a clip at a time of its own.
struct Field {
    enum class Moves { nothing, scene, clips };
    Shot shot;
    Scene scene;

    Field(int count, Moves moves) {
        shot.file = "field.yaml";
        shot.frames_given = true;
        shot.timing.fps = {24, 1};
        shot.timing.frames = {0, 1, 2, 3};
        shot.shutter.close_frames = 0.5;
        shot.image = {640, 360, 1};
        shot.camera.position = Track<glm::dvec3>(glm::dvec3(0, 0, 150));
        add_scene();
        place(count);
        if (moves == Moves::scene) shot.scenes[0].transform.translate = keyed(glm::dvec3(0), glm::dvec3(4, 1, 0));
        if (moves == Moves::clips) {
            NodeChannels sway;
            sway.node = 0;
            sway.translation = keyed(glm::dvec3(0), glm::dvec3(2, 0, 0));
            scene.clips.push_back({"sway", 0, 8, {sway}});
            scene.files[0].clip_count = 1;
        }
    }

private:
    static Track<glm::dvec3> keyed(const glm::dvec3& from, const glm::dvec3& to) {
        Track<glm::dvec3> track;
        track.keys = {{0, from, {}, {}, {}}, {8, to, {}, {}, {}}};
        return track;
    }
    void add_scene() {
        GeometryData g;
        g.name = "tetrahedron";
        g.positions = {{-1, -1, -1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, -1}};
        g.indices = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
        scene.geometries.push_back(std::move(g));
        scene.materials.resize(1);
        Node node;
        node.primitives.push_back({0, 0});
        scene.nodes.push_back(node);
        SceneFile file;
        file.id = "field";
        file.roots = {0};
        file.node_count = 1;
        scene.files.push_back(file);
        shot.scenes.resize(1);
        shot.scenes[0].id = "field";
    }
    void place(int count) {
        InstancesSpec spec;
        for (int i = 0; i < count; ++i) {
            PlacementSpec place;
            place.translate_m = {i % 47 * 4 - 92.0, i / 47 % 47 * 4 - 92.0, i / 2209 * -4.0};
            place.scale = glm::dvec3(0.8);
            place.rotate = glm::angleAxis(0.37 * i, glm::normalize(glm::dvec3(1, 2, 3)));
            place.offset_s = 0.001 * (i % 1000);
            spec.list.push_back(place);
        }
        shot.scenes[0].instances = std::move(spec);
    }
};

std::vector<SceneSnapshot> frames_of(const BoundShot& bound) {
    std::vector<SceneSnapshot> frames;
    for (int frame = 0; frame < 4; ++frame) frames.push_back(std::move(make_snapshots(bound, bound.sequence().frame(frame)).front()));
    return frames;
}

void snapshots(benchmark::State& state, Field::Moves moves) {
    const Field field(static_cast<int>(state.range(0)), moves);
    const BoundShot bound(field.shot, field.scene);
    int frame = 0;
    for (auto _ : state) benchmark::DoNotOptimize(make_snapshots(bound, bound.sequence().frame(frame++ % 4)));
}

void set_frame(benchmark::State& state, Field::Moves moves) {
    const Field field(static_cast<int>(state.range(0)), moves);
    const BoundShot bound(field.shot, field.scene);
    const std::vector<SceneSnapshot> frames = frames_of(bound);
    DeviceRequest request;
    request.name = "cpu";
    const DeviceChoice choice = make_device(request);
    choice.device->load(field.scene, nullptr);
    choice.device->set_frame(frames[3]);
    std::size_t frame = 0;
    for (auto _ : state) choice.device->set_frame(frames[frame++ % 4]);
}

/// Kilobytes of this process that lie in memory.
double resident_kib() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6));
    return 0;
}

/// Memory of a bound shot and one snapshot, an instance.
void memory(benchmark::State& state) {
    const double before = resident_kib();
    const Field field(static_cast<int>(state.range(0)), Field::Moves::scene);
    const double with_field = resident_kib();
    const BoundShot bound(field.shot, field.scene);
    const std::vector<SceneSnapshot> frame = make_snapshots(bound, bound.sequence().frame(0));
    const double after = resident_kib();
    for (auto _ : state) benchmark::DoNotOptimize(frame.data());
    const double count = static_cast<double>(state.range(0));
    state.counters["shot_bytes"] = 1024 * (with_field - before) / count;
    state.counters["bound_and_snapshot_bytes"] = 1024 * (after - with_field) / count;
}
BENCHMARK(memory)->Arg(100000)->Iterations(1);

void each_count(benchmark::internal::Benchmark* bench) {
    for (const int count : {1, 100, 10000, 100000}) bench->Arg(count);
    bench->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
}
BENCHMARK_CAPTURE(snapshots, drifting, Field::Moves::scene)->Apply(each_count);
BENCHMARK_CAPTURE(snapshots, swaying, Field::Moves::clips)->Apply(each_count);
BENCHMARK_CAPTURE(snapshots, still, Field::Moves::nothing)->Apply(each_count);
BENCHMARK_CAPTURE(set_frame, drifting, Field::Moves::scene)->Apply(each_count);
BENCHMARK_CAPTURE(set_frame, swaying, Field::Moves::clips)->Apply(each_count);
BENCHMARK_CAPTURE(set_frame, still, Field::Moves::nothing)->Apply(each_count);

}  // namespace
}  // namespace kadr
