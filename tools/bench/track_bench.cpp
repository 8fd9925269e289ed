// What it costs to evaluate the tracks of a large shot: ten keys each, every kind of value and interpolation.
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "anim/transform.h"

namespace kadr {
namespace {

constexpr int kKeys = 10;

template <class T, class Value>
Track<T> track_of(Interpolation interpolation, Value value) {
    Track<T> track;
    for (int i = 0; i < kKeys; ++i) {
        Key<T> key;
        key.time_s = i * 0.5;
        key.value = value();
        key.in_tangent = key.out_tangent = value();
        if (i % 3 == 0) key.ease = Ease{0.42, 0, 0.58, 1};
        track.keys.push_back(key);
    }
    track.interpolation = interpolation;
    return track;
}

/// A quarter each of numbers, vectors, rotations and positions on paths; a third of their segments is eased.
struct Tracks {
    std::vector<Track<double>> numbers;
    std::vector<Track<glm::dvec3>> vectors;
    std::vector<Track<glm::dquat>> rotations;
    std::vector<PositionTrack> paths;

    explicit Tracks(int count) {
        std::mt19937 random(7);
        const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
        const auto vector = [&] { return glm::dvec3(number(), number(), number()); };
        const auto rotation = [&] { return glm::normalize(glm::dquat(number(), number(), number(), number())); };
        for (int i = 0; i < count / 4; ++i) {
            const auto kind = static_cast<Interpolation>(i % 4);
            numbers.push_back(track_of<double>(kind, number));
            vectors.push_back(track_of<glm::dvec3>(kind, vector));
            rotations.push_back(track_of<glm::dquat>(kind, rotation));
            std::vector<glm::dvec3> points;
            for (int p = 0; p < kKeys; ++p) points.push_back(vector());
            PositionTrack path;
            path.path = PathMotion{Path(points, false), track_of<double>(Interpolation::linear, [&] { return 0.5 + 0.5 * number(); }), false, {0, 1, 0}, {}};
            paths.push_back(std::move(path));
        }
    }
};

template <class T>
void evaluate_all(const std::vector<T>& tracks, double time_s) {
    for (const T& track : tracks) {
        auto value = evaluate(track, time_s);
        benchmark::DoNotOptimize(value);
    }
}

double next_time(double& time_s) { return time_s = time_s < 4.4 ? time_s + 1.0 / 24 : 0.01; }

void evaluate_ten_thousand_tracks(benchmark::State& state) {
    const Tracks tracks(10000);
    double time_s = 0;
    for (auto _ : state) {
        next_time(time_s);
        evaluate_all(tracks.numbers, time_s);
        evaluate_all(tracks.vectors, time_s);
        evaluate_all(tracks.rotations, time_s);
        evaluate_all(tracks.paths, time_s);
    }
    state.SetItemsProcessed(state.iterations() * 10000);
}
BENCHMARK(evaluate_ten_thousand_tracks)->Unit(benchmark::kMillisecond);

/// One kind alone, for the share of each.
template <class T>
void evaluate_kind(benchmark::State& state, std::vector<T> Tracks::*kind) {
    const Tracks tracks(10000);
    double time_s = 0;
    for (auto _ : state) evaluate_all(tracks.*kind, next_time(time_s));
    state.SetItemsProcessed(state.iterations() * 2500);
}
BENCHMARK_CAPTURE(evaluate_kind, numbers, &Tracks::numbers)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(evaluate_kind, vectors, &Tracks::vectors)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(evaluate_kind, rotations, &Tracks::rotations)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(evaluate_kind, paths, &Tracks::paths)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kadr
