// Structures of a bending mesh in Embree: what an update takes, and what rays take then, for a tree that is refitted,
// one that is built at low quality and one at default quality; and for vertices with several keys.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "device/embree/deforming_meshes.h"
#include "device/tables/bounds_tree.h"

namespace kadr {
namespace {

constexpr int kRings = 160;  // of a sphere: 102,400 triangles
constexpr int kRays = 100'000;

std::vector<std::uint32_t> sphere_indices() {
    std::vector<std::uint32_t> indices;
    for (unsigned r = 0; r < kRings; ++r)
        for (unsigned c = 0; c < 2 * kRings; ++c) {
            const unsigned a = r * (2 * kRings + 1) + c, b = a + 2 * kRings + 1;
            for (const unsigned i : {a, a + 1, b, a + 1, b + 1, b}) indices.push_back(i);
        }
    return indices;
}

/// The sphere, sheared into an S around z the more the higher.
std::vector<kernels::Vertex> bent_sphere(double bend) {
    std::vector<kernels::Vertex> vertices;
    for (int r = 0; r <= kRings; ++r)
        for (int c = 0; c <= 2 * kRings; ++c) {
            const double theta = std::numbers::pi * r / kRings, phi = std::numbers::pi * c / kRings;
            const double x = std::sin(theta) * std::cos(phi), y = std::cos(theta), z = std::sin(theta) * std::sin(phi),
                         angle = bend * y;
            vertices.push_back({{static_cast<float>(x * std::cos(angle) - y * std::sin(angle)),
                                 static_cast<float>(x * std::sin(angle) + y * std::cos(angle)), static_cast<float>(z)},
                                {0, 0, 0},
                                {0, 0}});
        }
    return vertices;
}

/// The most that the rule for refits lets the sphere bend.
double largest_bend(const std::vector<std::uint32_t>& indices) {
    BoundsTree tree;
    tree.order(bent_sphere(0), indices);
    const double rest = tree.cost(bent_sphere(0), indices);
    double bend = 0;
    while (bend < 3 && tree.cost(bent_sphere(bend + 0.02), indices) <= kMostGrowth * rest) bend += 0.02;
    return bend;
}

struct Structure {
    EmbreeDeviceHandle device{rtcNewDevice(nullptr)};
    EmbreeSceneHandle scene{rtcNewScene(device.get())};
    EmbreeGeometryHandle triangles{rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE)};
    std::vector<std::uint32_t> indices = sphere_indices();
    std::vector<std::vector<kernels::Vertex>> keys;

    Structure(RTCBuildQuality quality, std::size_t key_count) {
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_DYNAMIC);
        rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_LOW);
        rtcSetGeometryBuildQuality(triangles.get(), quality);
        rtcSetGeometryTimeStepCount(triangles.get(), static_cast<unsigned>(key_count));
        rtcSetSharedGeometryBuffer(triangles.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0, 12,
                                   indices.size() / 3);
        rtcAttachGeometry(scene.get(), triangles.get());
        keys.resize(key_count);
    }
    void bend(double amount) {
        for (std::size_t k = 0; k < keys.size(); ++k) {
            keys[k] = bent_sphere(amount + 0.02 * static_cast<double>(k));
            rtcSetSharedGeometryBuffer(triangles.get(), RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(k),
                                       RTC_FORMAT_FLOAT3, keys[k].data(), 0, sizeof(kernels::Vertex), keys[k].size());
        }
    }
    void commit() {
        rtcCommitGeometry(triangles.get());
        rtcCommitScene(scene.get());
    }
};

void update_structure(benchmark::State& state, RTCBuildQuality quality, std::size_t key_count) {
    Structure structure(quality, key_count);
    structure.bend(0);
    structure.commit();
    double amount = 0;
    for (auto _ : state) {
        state.PauseTiming();
        structure.bend(amount = std::fmod(amount + 0.01, 0.2));
        state.ResumeTiming();
        structure.commit();
    }
}
BENCHMARK_CAPTURE(update_structure, refit, RTC_BUILD_QUALITY_REFIT, 1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(20);
BENCHMARK_CAPTURE(update_structure, low, RTC_BUILD_QUALITY_LOW, 1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(20);
BENCHMARK_CAPTURE(update_structure, standard, RTC_BUILD_QUALITY_MEDIUM, 1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(20);
BENCHMARK_CAPTURE(update_structure, two_keys_refit, RTC_BUILD_QUALITY_REFIT, 2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(10);
BENCHMARK_CAPTURE(update_structure, two_keys_low, RTC_BUILD_QUALITY_LOW, 2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(10);
BENCHMARK_CAPTURE(update_structure, two_keys_standard, RTC_BUILD_QUALITY_MEDIUM, 2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(10);
BENCHMARK_CAPTURE(update_structure, five_keys_standard, RTC_BUILD_QUALITY_MEDIUM, 5)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(5);

/// Rays from all sides, one thread. A refitted tree was built for the sphere at rest and has bent as far as refits may
/// go.
void trace_structure(benchmark::State& state, RTCBuildQuality quality) {
    Structure structure(quality, 1);
    const double bend = largest_bend(structure.indices);
    for (const double amount : {0.0, bend}) {
        structure.bend(amount);
        structure.commit();
    }
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::vector<RTCRay> rays(kRays);
    for (RTCRay& ray : rays) {
        const kernels::Vec3f from{unit(random) * 4, unit(random) * 4, unit(random) * 4},
            to{unit(random), unit(random), unit(random)};
        ray = {from.x,
               from.y,
               from.z,
               0,
               to.x - from.x,
               to.y - from.y,
               to.z - from.z,
               0,
               std::numeric_limits<float>::infinity(),
               0xffffffffu,
               0,
               0};
    }
    for (auto _ : state) {
        QueryContext context;
        for (const RTCRay& ray : rays) {
            RTCRayHit hit{ray, {}};
            hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            intersect1(structure.scene.get(), context, hit, false);
            benchmark::DoNotOptimize(hit.ray.tfar);
        }
    }
    state.counters["bend"] = bend;
}
BENCHMARK_CAPTURE(trace_structure, refitted, RTC_BUILD_QUALITY_REFIT)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trace_structure, low, RTC_BUILD_QUALITY_LOW)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trace_structure, standard, RTC_BUILD_QUALITY_MEDIUM)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kadr
