// The samples in shots/: the kernels that their frames need leave the same pixels as the one that can do everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "device/embree/embree_device.h"
#include "device/same_picture.h"
#include "render/environment_image.h"
#include "render/frame_renderer.h"
#include "shot/shot_parser.h"

namespace kadr::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> sample_shots() {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(KADR_SOURCE_DIR) / "shots"))
        if (entry.path().extension() == ".yaml" && entry.path().stem() != "reel") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

Shot small(const fs::path& file) {
    Shot shot = parse_shot(file);
    shot.image = limited_width(shot.image, 40);
    shot.render.fix_samples(4);
    return shot;
}

/// The middle frame.
RenderedFrame render(const LoadedShot& loaded, const BoundShot& bound, int width, KernelChoice kernels) {
    DeviceRequest request{"cpu", 2, width, kernels};
    const DeviceChoice choice = make_device(request);
    load_device(*choice.device, loaded);
    FrameRequest frame;
    frame.layers.albedo = frame.layers.normal = frame.layers.depth = frame.layers.motion = true;
    const std::vector<int>& frames = bound.timing().frames;
    return FrameRenderer(*choice.device).render(bound, bound.sequence().frame(frames[frames.size() / 2]), frame);
}

class SampleKernels : public testing::TestWithParam<fs::path> {};

/// Nothing where the integrator does not have what the shot asks for. @param shot  outlives it
std::unique_ptr<BoundShot> bind(const Shot& shot, const Scene& scene) {
    try {
        return std::make_unique<BoundShot>(shot, scene);
    } catch (const InputError&) {
        return nullptr;
    }
}

TEST_P(SampleKernels, LeaveTheSamePixelsAsTheLargestOne) {
    const LoadedShot loaded(small(GetParam()));
    for (const Integrator integrator : {Integrator::path, Integrator::direct}) {
        Shot shot = loaded.shot();
        shot.render.integrator = integrator;
        const std::unique_ptr<BoundShot> bound = bind(shot, loaded.scene());
        ASSERT_TRUE(bound || integrator != loaded.shot().render.integrator);
        for (const int width : {1, 8}) {
            if (!bound || width > best_width()) continue;
            const RenderedFrame needed = render(loaded, *bound, width, KernelChoice::needed),
                                all = render(loaded, *bound, width, KernelChoice::all);
            EXPECT_TRUE(same_bits(needed.image, all.image)) << width << " lanes, set " << needed.statistics.compiled;
            EXPECT_EQ(needed.statistics.rays, all.statistics.rays);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Shots, SampleKernels, testing::ValuesIn(sample_shots()),
                         [](const auto& shot) { return shot.param.stem().string(); });

}  // namespace
}  // namespace kadr::test
