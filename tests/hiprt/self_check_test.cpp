// The self-check that `auto` asks before it takes a GPU: it passes what is right, and finds what is not.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "device/broken_device.h"
#include "device/gpu_choice.h"
#include "device/self_check.h"
#include "tracing_gpu.h"

namespace kadr::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

std::unique_ptr<Device> make_cpu() {
    DeviceRequest request;
    request.name = "cpu";
    request.threads = 1;
    request.width = 1;
    return make_device(request).device;
}

std::string fault_of_broken(const std::function<void(BrokenDevice&)>& break_it) {
    BrokenDevice broken(make_cpu());
    break_it(broken);
    return find_fault(broken, *make_cpu());
}

TEST(SelfCheck, FindsNothingWrongWithTheProcessorAndAGpuThatTraces) {
    EXPECT_EQ(find_fault(*make_cpu(), *make_cpu()), "");
    TracingGpu gpu;
    {
        const std::unique_ptr<Device> device = gpu.make();
        EXPECT_EQ(find_fault(*device, *make_cpu()), "");
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(SelfCheck, SeesEnoughOfEverything) {
    const CheckScene check = make_check_scene();
    const std::unique_ptr<Device> cpu = make_cpu();
    cpu->load(check.scene, nullptr);
    cpu->set_frame(check.snapshot);
    std::vector<kernels::Vec2f> points;
    for (int i = 0; i < 400; ++i) points.push_back({static_cast<float>(i % 20) + 0.437f, static_cast<float>(i / 20) + 0.571f});
    std::vector<int> seen(check.snapshot.instances.size());
    for (const SurfaceHit& hit : cpu->probe()->look(points, 0.6))
        if (hit.met()) ++seen[static_cast<std::size_t>(hit.instance)];
    for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_GE(seen[i], 8) << "instance " << i;
}

TEST(SelfCheck, FindsWhatIsWrong) {
    FakeGpu blind;
    {
        const std::unique_ptr<Device> device = blind.make();
        EXPECT_THAT(find_fault(*device, *make_cpu()), MatchesRegex("gave [0-9]{3} wrong hits of [0-9]{3}"));
    }
    for (const std::size_t instance : {0u, 1u, 2u, 3u, 4u})
        EXPECT_THAT(fault_of_broken([&](BrokenDevice& broken) {
                        broken.break_frame = [&](SceneSnapshot& snapshot) { move_instance(snapshot, instance, 0.1f); };
                    }),
                    HasSubstr(instance == 0 ? " wrong shadows of " : " wrong hits of "))  // a floor is a floor when it slides
            << "instance " << instance;
    EXPECT_THAT(fault_of_broken([](BrokenDevice& broken) { broken.break_scene = [](Scene& scene) { drop_triangle(scene, 1, 0); }; }),
                HasSubstr(" wrong hits of "));
    EXPECT_EQ(fault_of_broken([](BrokenDevice& broken) { broken.break_frame = [](SceneSnapshot& snapshot) { scale_lights(snapshot, 1.2f); }; }),
              "gave a picture 1.2 times as bright as the CPU's");
    EXPECT_THAT(fault_of_broken([](BrokenDevice& broken) {
                    broken.break_frame = [](SceneSnapshot& snapshot) { snapshot.settings.max_bounces = 0; };
                }),
                StartsWith("gave a picture 0."));
}

struct KeptFile {
    fs::path folder = fs::temp_directory_path() / ("kadr_self_check_test." + std::to_string(::getpid()));
    fs::path file = folder / "checks/abc";
    ~KeptFile() { fs::remove_all(folder); }
};

void be_slow() { ::usleep(1'050'000); }

TEST(KeptFault, OfASlowCheckIsAskedOnce) {
    const KeptFile kept;
    int asked = 0;
    const auto check = [&] {
        ++asked;
        be_slow();
        return std::string("gave 3 wrong hits of 400");
    };
    EXPECT_EQ(kept_fault(kept.file, check), "gave 3 wrong hits of 400");
    EXPECT_EQ(kept_fault(kept.file, check), "gave 3 wrong hits of 400");
    EXPECT_EQ(asked, 1);
    EXPECT_EQ(std::distance(fs::directory_iterator(kept.file.parent_path()), fs::directory_iterator()), 1);
}

TEST(KeptFault, OfAQuickCheckOrOneThatFailedIsAskedAgain) {
    const KeptFile kept;
    int asked = 0;
    const auto quick = [&] { return ++asked, std::string(); };
    EXPECT_EQ(kept_fault(kept.file, quick), "");
    EXPECT_EQ(kept_fault(kept.file, quick), "");
    EXPECT_EQ(kept_fault("", quick), "");
    EXPECT_EQ(asked, 3);
    const auto failing = []() -> std::string {
        be_slow();
        throw RenderError("cannot start a kernel on the GPU: no device");
    };
    EXPECT_EQ(kept_fault(kept.file, failing), "failed: cannot start a kernel on the GPU: no device");
    EXPECT_FALSE(fs::exists(kept.file));
}

Found<StartedGpu> started() { return StartedGpu{make_cpu(), "X", ""}; }
std::string right(const StartedGpu&) { return ""; }
std::string wrong(const StartedGpu& gpu) { return "the GPU " + gpu.name + " gave 3 wrong hits of 400"; }
std::unique_ptr<Device> no_cpu() {
    ADD_FAILURE() << "the CPU is not to be taken";
    return nullptr;
}

TEST(GpuChoice, AutoTakesAGpuThatIsRightElseTheCpuAndSaysWhy) {
    EXPECT_EQ(take_best(started(), right, no_cpu).why, "the GPU works, its self-check included; --device cpu takes the CPU");
    const DeviceChoice refused = take_best(started(), wrong, make_cpu);
    EXPECT_NE(refused.device, nullptr);
    EXPECT_EQ(refused.why, "the GPU X gave 3 wrong hits of 400 in its self-check; --device hiprt takes it all the same");
    const DeviceChoice missing = take_best(std::string("the driver finds no GPU"), wrong, make_cpu);
    EXPECT_EQ(missing.why, "the driver finds no GPU");
    EXPECT_EQ(missing.warning, "");
}

TEST(GpuChoice, AGpuThatWasAskedForIsTakenWithAWarning) {
    EXPECT_EQ(take_gpu(started(), "hiprt", right).warning, "");
    const DeviceChoice doubtful = take_gpu(started(), "hiprt", wrong);
    EXPECT_EQ(doubtful.why, "asked for by --device hiprt");
    EXPECT_EQ(doubtful.warning, "the GPU X gave 3 wrong hits of 400 in its self-check: its pictures may be wrong; --device cpu does without it");
    EXPECT_THROW(take_gpu(std::string("the driver finds no GPU"), "hiprt", right), InputError);
}

TEST(GpuChoice, TheSentenceNamesTheGpu) {
    FakeGpu blind;
    EXPECT_THAT(fault_of({blind.make(), "X", ""}), MatchesRegex("the GPU X gave [0-9]{3} wrong hits of [0-9]{3}"));
    FakeGpu failing;
    StartedGpu gpu{failing.make(), "X", ""};
    failing.runtime->failing_call = static_cast<int>(failing.runtime->calls.size()) + 40;
    EXPECT_THAT(fault_of(gpu), StartsWith("the GPU X failed: cannot "));
}

}  // namespace
}  // namespace kadr::test
