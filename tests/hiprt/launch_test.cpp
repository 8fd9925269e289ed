// Cutting passes into launches, and the names under which kernels are compiled and kept.

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/detached_work.h"
#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/kernel_cache.h"
#include "device/hiprt/launch_planner.h"
#include "device/hiprt/launch_queue.h"
#include "device/hiprt/trace_kernels.h"
#include "fake_hiprt.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

/// Hands a pass out under a budget that changes from launch to launch, and checks what comes.
void expect_whole_cover(const LaunchPiece& pass, std::vector<std::int64_t> budgets) {
    const int width = pass.x1, height = pass.y1;
    std::vector<int> next(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), pass.first_sample);
    LaunchPlanner planner(pass);
    std::size_t launches = 0;
    while (true) {
        LaunchBudget budget;
        // A launch of that many samples took what one may take: the budget is then that many, or four times the first.
        budget.measured(budgets[launches % budgets.size()], LaunchBudget::kTarget_s);
        const std::optional<LaunchPiece> piece = planner.next(budget);
        if (!piece) break;
        ++launches;
        ASSERT_LT(launches, 100000u);
        EXPECT_GT(piece->pixel_samples(), 0);
        // One block of pixels is the least that a launch takes.
        EXPECT_LE(piece->pixel_samples(),
                  std::max<std::int64_t>(budget.pixel_samples(), std::int64_t{64} * piece->sample_count));
        for (int y = piece->y0; y < piece->y1; ++y)
            for (int x = piece->x0; x < piece->x1; ++x) {
                int& sample =
                    next[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
                ASSERT_EQ(sample, piece->first_sample) << x << ", " << y;  // in order, none twice
                sample += piece->sample_count;
            }
    }
    EXPECT_EQ(planner.done(), 1.0);
    for (int y = pass.y0; y < pass.y1; ++y)
        for (int x = pass.x0; x < pass.x1; ++x)
            ASSERT_EQ(next[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)],
                      pass.first_sample + pass.sample_count);
}

TEST(LaunchPlanner, EverySampleOnceAndInOrder) {
    for (const std::int64_t budget : {1, 64, 500, 10'000, 1'000'000})
        for (const auto& [width, height] : {std::pair{1, 1}, {8, 8}, {100, 30}, {7, 200}, {333, 1}}) {
            expect_whole_cover({0, 0, width, height, 0, 5}, {budget});
            expect_whole_cover({0, 0, width, height, 3, 70}, {budget, 64, 100'000, 3});
        }
    expect_whole_cover({0, 16, 64, 40, 0, 3}, {1000});  // some rows of an image
}

TEST(LaunchPlanner, NothingToDo) {
    LaunchPlanner planner({0, 0, 10, 10, 0, 0});
    EXPECT_EQ(planner.next({}), std::nullopt);
}

TEST(LaunchBudget, FollowsWhatLaunchesTake) {
    LaunchBudget budget;
    EXPECT_EQ(budget.pixel_samples(), LaunchBudget::kFirst);
    budget.measured(LaunchBudget::kFirst, LaunchBudget::kTarget_s / 100);  // much faster than it may be
    EXPECT_EQ(budget.pixel_samples(), 4 * LaunchBudget::kFirst);
    budget.measured(4 * LaunchBudget::kFirst, 10 * LaunchBudget::kTarget_s);
    EXPECT_EQ(budget.pixel_samples(), 4 * LaunchBudget::kFirst / 10);
    budget.measured(1, 1e9);
    EXPECT_EQ(budget.pixel_samples(), 1);
    for (int i = 0; i < 40; ++i) budget.measured(budget.pixel_samples(), 0);
    EXPECT_EQ(budget.pixel_samples(), LaunchBudget::kMost);
}

TEST(LaunchQueue, NothingRunsAnyMoreAfterItHasBeenCancelled) {
    test::RecordingRuntime runtime;
    check(runtime.make_current(), "use the GPU");
    runtime.on_launch = [](const std::string&, const std::byte*) { return 0.01; };
    const GpuStream stream(runtime);
    LaunchQueue queue(runtime, stream);
    const GpuFunctionHandle kernel = runtime.make_function("kernel");
    std::atomic<bool> cancel{false};
    const auto progress = [&](double) { cancel = runtime.count("launch") == 3; };
    EXPECT_FALSE(queue.run(kernel, {}, {0, 0, 1000, 1000, 0, 100}, &cancel, progress));
    EXPECT_EQ(runtime.count("launch"), 3u);
    EXPECT_TRUE(runtime.is_idle());
    EXPECT_EQ(runtime.launch_s.size(), 3u);
    cancel = false;
    EXPECT_TRUE(queue.run(kernel, {}, {0, 0, 10, 10, 0, 1}, &cancel, {}));
    EXPECT_THAT(runtime.faults, ::testing::IsEmpty());
}

/// A folder that is gone after the test.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("kadr_launch_test." + std::to_string(::getpid()));
    Folder() { fs::create_directories(path / "kernels/gpu"); }
    ~Folder() { fs::remove_all(path); }
    void write(const std::string& name, const std::string& text) const { std::ofstream(path / name) << text; }
};

struct Compiler {
    test::RecordingRuntime runtime;
    test::FakeHiprt fake{runtime};
    hiprt::Api api = test::FakeHiprt::api();
    std::shared_ptr<HiprtContext> context;
    explicit Compiler(GpuVendor vendor = GpuVendor::nvidia) {
        runtime.vendor = vendor;
        check(runtime.make_current(), "use the GPU");
        context = std::make_shared<HiprtContext>(api, runtime, "");
    }
    std::shared_ptr<HiprtContext> shared() const { return context; }
};

TEST(TraceKernels, NamesChangeWithEverySourceAndOption) {
    const Folder folder;
    folder.write("kernels/a.h", "a");
    folder.write("kernels/gpu/b.h", "b");
    Compiler compiler;
    const auto module = [&](const KernelNeed& need) {
        return TraceKernels(compiler.shared(), folder.path).source_of(need).module;
    };
    const KernelNeed plain{kernels::Kernel::path, 2, false};
    const std::string first = module(plain);
    EXPECT_EQ(module(plain), first);
    std::set<std::string> names{first, module({kernels::Kernel::direct, 2, false}),
                                module({kernels::Kernel::path, 3, false}),
                                module({kernels::Kernel::probe, 2, false}),
                                module({kernels::Kernel::path, 2, true})};
    folder.write("kernels/gpu/b.h", "c");
    names.insert(module(plain));
    folder.write("kernels/gpu/b.h", "b");
    EXPECT_EQ(module(plain), first);
    folder.write("kernels/new.h", "");
    names.insert(module(plain));
    EXPECT_EQ(names.size(), 7u);
}

TEST(TraceKernels, CompiledOnceWithExactlyWhatIsNeeded) {
    Compiler compiler;
    TraceKernels kernels(compiler.shared(), KADR_SOURCE_DIR);
    const KernelNeed need{kernels::Kernel::path, 6, true};
    const hiprt::Function function = kernels.get(need).function;
    EXPECT_EQ(kernels.get(need).function, function);
    EXPECT_NE(kernels.get({kernels::Kernel::direct, 2, false}).function, function);
    EXPECT_EQ(compiler.runtime.count("build_trace_kernels"), 2u);
    ASSERT_EQ(compiler.fake.modules.size(), 2u);
    const test::FakeHiprt::ModuleRecord& module = compiler.fake.modules.at(kernels.source_of(need).module);
    EXPECT_EQ(module.source, "#define KADR_REQUIREMENTS 6u\n#include \"kernels/gpu/path_entry.h\"\n");
    EXPECT_THAT(module.functions,
                ::testing::ElementsAre("", "kadr_alpha_filter", "kadr_moving_triangle", "kadr_alpha_filter"));
    EXPECT_THAT(module.options, ::testing::ElementsAre(std::string("-I") + KADR_SOURCE_DIR,
                                                       "--gpu-architecture=compute_75", "--fmad=false", "--ftz=true"));
    EXPECT_THAT(compiler.runtime.faults, ::testing::IsEmpty());
}

KernelSource source_for(GpuVendor vendor) {
    Compiler compiler(vendor);
    return TraceKernels(compiler.shared(), KADR_SOURCE_DIR).source_of({kernels::Kernel::path, 2, false});
}

TEST(TraceKernels, EachVendorsCompilerGetsItsOptions) {
    const KernelSource nvidia = source_for(GpuVendor::nvidia), amd = source_for(GpuVendor::amd);
    EXPECT_THAT(amd.options, ::testing::ElementsAre(std::string("-I") + KADR_SOURCE_DIR, "-ffp-contract=off",
                                                    "-fgpu-flush-denormals-to-zero"));
    EXPECT_EQ(nvidia.text, amd.text);
    EXPECT_NE(nvidia.module, amd.module);
}

TEST(TraceKernels, WhatCoversANeedServesIt) {
    using kernels::Kernel;
    Compiler compiler;
    TraceKernels kernels(compiler.shared(), KADR_SOURCE_DIR);
    kernels.begin({Kernel::path, 7, true});
    const TraceKernel shot = kernels.get({Kernel::path, 7, true});
    for (const KernelNeed& need : {KernelNeed{Kernel::path, 3, false}, {Kernel::path, 6, true}}) {
        EXPECT_EQ(kernels.get(need).function, shot.function);
        EXPECT_EQ(kernels.get(need).compiled_for.requirements, 7u);
    }
    EXPECT_EQ(compiler.runtime.count("build_trace_kernels"), 1u);
    EXPECT_NE(kernels.get({Kernel::path, 11, false}).function, shot.function);  // more than the shot was said to need
    EXPECT_NE(kernels.get({Kernel::direct, 3, false}).function, shot.function);
    EXPECT_EQ(compiler.runtime.count("build_trace_kernels"), 3u);
}

/// A compilation that takes until it is told to end.
struct LongCompilation : Compiler {
    std::atomic<bool> began{false}, end{false};
    LongCompilation() {
        fake.while_compiling = [this] {
            began = true;
            while (!end) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        };
    }
    static void wait_for_detached() {
        while (DetachedWork::is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
};

TEST(TraceKernels, AreCompiledInTheBackgroundAndTheOneWhoWaitsIsToldForHowLong) {
    LongCompilation compiler;
    TraceKernels kernels(compiler.shared(), KADR_SOURCE_DIR);
    const KernelNeed need{kernels::Kernel::path, 2, false};
    kernels.begin(need);
    kernels.begin(need);  // it is on its way
    while (!compiler.began) std::this_thread::yield();
    EXPECT_TRUE(kernels.is_compiling());
    std::vector<double> told;
    EXPECT_TRUE(kernels
                    .get(need,
                         [&](double seconds) {
                             told.push_back(seconds);
                             compiler.end = told.size() == 3;
                         })
                    .function);
    ASSERT_GE(told.size(), 3u);
    EXPECT_GE(told[0], 0.1);
    EXPECT_GT(told[1], told[0]);
    EXPECT_FALSE(kernels.is_compiling());
    kernels.wait([](double) { FAIL(); });
    EXPECT_EQ(compiler.runtime.count("build_trace_kernels"), 1u);
    compiler.wait_for_detached();
    EXPECT_THAT(compiler.runtime.faults, ::testing::IsEmpty());
}

TEST(TraceKernels, NobodyWaitsForACompilationThatIsNotWantedAnyMore) {
    LongCompilation compiler;
    const std::weak_ptr<HiprtContext> context = compiler.shared();
    {
        TraceKernels kernels(compiler.shared(), KADR_SOURCE_DIR);
        kernels.begin({kernels::Kernel::path, 2, false});
        while (!compiler.began) std::this_thread::yield();
        EXPECT_THROW(kernels.wait([](double) { throw Interrupted(); }), Interrupted);
        compiler.context.reset();
    }
    // The device is gone, but not what the compiler works on.
    EXPECT_TRUE(DetachedWork::is_running());
    EXPECT_FALSE(context.expired());
    EXPECT_TRUE(compiler.fake.has_context);
    compiler.end = true;
    compiler.wait_for_detached();
    EXPECT_TRUE(context.expired());
    EXPECT_FALSE(compiler.fake.has_context);
    EXPECT_THAT(compiler.runtime.faults, ::testing::IsEmpty());
}

TEST(TraceKernels, AFailedCompilationIsAnError) {
    Compiler compiler;
    TraceKernels kernels(compiler.shared(), KADR_SOURCE_DIR);
    compiler.runtime.failing_call = static_cast<int>(compiler.runtime.calls.size()) + 1;  // the first makes the context current
    try {
        kernels.get({kernels::Kernel::direct, 2, false});
        FAIL();
    } catch (const RenderError& error) {
        EXPECT_THAT(error.what(),
                    ::testing::StartsWith("cannot compile the kernel kadr_direct for transforms (what HIPRT "
                                          "printed above says why): HIPRT reports an internal error"));
    }
}

TEST(KernelCache, KeepsTheNewestWithinItsLimit) {
    const Folder folder;
    const fs::path cache = folder.path / "new/cache";
    EXPECT_EQ(prepare_kernel_cache(cache), cache);
    const auto now = fs::file_time_type::clock::now();
    for (int i = 0; i < 5; ++i) {
        const fs::path file = cache / std::to_string(i);
        std::ofstream(file) << std::string(100, 'x');
        fs::last_write_time(file, now - std::chrono::hours(i));
    }
    prepare_kernel_cache(cache, 250);
    EXPECT_TRUE(fs::exists(cache / "0") && fs::exists(cache / "1"));
    EXPECT_FALSE(fs::exists(cache / "2") || fs::exists(cache / "3") || fs::exists(cache / "4"));
    std::ofstream(folder.path / "file") << "in the way";
    EXPECT_EQ(prepare_kernel_cache(folder.path / "file/cache"), fs::path());
}

TEST(HiprtContext, AnotherVersionIsRefusedByName) {
    test::RecordingRuntime runtime;
    check(runtime.make_current(), "use the GPU");
    hiprt::Api api;
    api.create_context = [](std::uint32_t, const hiprt::ContextCreationInput&, hiprt::Context&) {
        return hiprt::Error::invalid_api_version;
    };
    try {
        const HiprtContext context(api, runtime, "");
        FAIL();
    } catch (const RenderError& error) {
        EXPECT_STREQ(error.what(), "cannot use this libhiprt: it is not of API 3001; install HIPRT 3.1");
    }
}

}  // namespace
}  // namespace kadr
