// The list of requirement sets that tools/check_gpu_kernels compiles is that of the samples, and the set of everything.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "device/embree/embree_scene.h"
#include "device/embree/frame_facts.h"
#include "device/requirement_names.h"
#include "frame/snapshot.h"
#include "kernels/gpu/entry_points.h"
#include "render/loaded_shot.h"
#include "shot/shot_parser.h"

namespace kadr::test {
namespace {

namespace fs = std::filesystem;

/// As in the list: the kernel and the names of its requirements.
std::string name_of(kernels::Kernel kernel, unsigned required) {
    const std::string name = kernels::entry_point(kernel).name;
    return name.substr(name.find('_') + 1) + ": " + names_of_requirements(kernels::kernel_requirements(kernel, required));
}

std::set<std::string> listed() {
    std::ifstream file(fs::path(KADR_SOURCE_DIR) / "tests/gpu/sample_sets.txt");
    std::set<std::string> sets;
    for (std::string line; std::getline(file, line);)
        if (!line.empty() && line[0] != '#') sets.insert(line);
    return sets;
}

/// Of the first, a middle and the last frame.
std::set<std::string> required(RTCDevice device, const fs::path& file) {
    const LoadedShot loaded(parse_shot(file));
    const Image sky{1, 1, {"R", "G", "B"}, {1, 1, 1}};
    const bool has_image = loaded.shot().environment.image.has_value();
    EmbreeScene scene(device, loaded.scene(), has_image ? &sky : nullptr);
    const std::vector<int>& frames = loaded.shot().timing.frames;
    std::set<std::string> sets;
    for (const int frame : {frames.front(), frames[frames.size() / 2], frames.back()})
        for (const SceneSnapshot& part : make_snapshots(loaded.bound(), loaded.bound().sequence().frame(frame))) {
            scene.set_frame(part);
            EXPECT_EQ(kernel_requirements_of(loaded.scene(), part), scene.requirements()) << file << ", frame " << frame << ", found without building it";
            const unsigned needs = scene.requirements() | kernels::requirement::kTransforms;
            sets.insert(name_of(kernels::kernel_of(part.settings.integrator), needs));
            sets.insert(name_of(kernels::Kernel::probe, needs));
            if (part.deformed.empty()) continue;
            sets.insert(name_of(kernels::Kernel::bend, needs));
            sets.insert(name_of(kernels::Kernel::boxes, needs));
        }
    return sets;
}

TEST(SampleSets, AreThoseThatAreCompiledForGpus) {
    const EmbreeDeviceHandle device(rtcNewDevice(nullptr));
    const std::set<std::string> compiled = listed();
    std::set<std::string> all{name_of(kernels::Kernel::path, kernels::requirement::kAll)};
    for (const auto& entry : fs::directory_iterator(fs::path(KADR_SOURCE_DIR) / "shots")) {
        if (entry.path().extension() != ".yaml" || entry.path().stem() == "reel") continue;
        for (const std::string& set : required(device.get(), entry.path())) {
            EXPECT_TRUE(compiled.count(set))
                << entry.path() << " requires \"" << set << "\"; add it to sample_sets.txt";
            all.insert(set);
        }
    }
    EXPECT_EQ(all, compiled) << "sample_sets.txt lists what no sample requires";
}

}  // namespace
}  // namespace kadr::test
