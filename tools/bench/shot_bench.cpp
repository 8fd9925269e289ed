#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "shot/shot_parser.h"

namespace kadr {
namespace {

const std::string kShots = KADR_SOURCE_DIR "/shots/";

void parse_turntable(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(parse_shot(kShots + "turntable.yaml"));
}
BENCHMARK(parse_turntable)->Unit(benchmark::kMicrosecond);

/// A camera track of many keys, as an exporter would write it.
void parse_many_keys(benchmark::State& state) {
    std::string keys;
    for (int i = 0; i < state.range(0); ++i) keys += fmt::format("      {} f: [{}, 1, 5]\n", i, i * 0.01);
    const std::string text =
        "kadr: 1\nscenes:\n  - { id: solids, gltf: assets/solids.glb }\ncamera:\n  position:\n    keys:\n" + keys;
    for (auto _ : state) benchmark::DoNotOptimize(parse_shot_text(text, kShots + "keys.yaml"));
    state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(parse_many_keys)->Arg(10)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kadr
