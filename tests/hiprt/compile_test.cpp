// Kernels are compiled while the scene is copied; a frame waits for them, says so, and can be cancelled.

#include <atomic>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/detached_work.h"
#include "device/small_scene.h"
#include "fake_gpu.h"

namespace kadr::test {
namespace {

using kernels::requirement::kEmitters;
using kernels::requirement::kTransforms;

/// A GPU whose compiler takes until it is told to end.
struct SlowCompiler : FakeGpu {
    std::atomic<int> began{0};
    std::atomic<bool> end{false};
    SlowCompiler() {
        hiprt.while_compiling = [this] {
            ++began;
            while (!end) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        };
    }
    ~SlowCompiler() {
        end = true;
        wait();
    }
    void wait() const {
        while (DetachedWork::is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
};

SmallScene one_square() {
    SmallScene s;
    s.add_instance(s.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
    s.snapshot.geometry_key = 1;
    return s;
}

TEST(CompilingOnGpu, GoesOnWhileTheSceneIsCopiedAndTheFrameSaysThatItWaits) {
    SlowCompiler gpu;
    SmallScene s = one_square();
    {
        const std::unique_ptr<Device> device = gpu.make();
        std::vector<double> told;
        device->watch({[&](double seconds) {
                           told.push_back(seconds);
                           // Nothing is built meanwhile: it would wait for the compiler inside HIPRT.
                           EXPECT_EQ(gpu.runtime->count("build_scene"), 0u);
                           gpu.end = told.size() == 2;
                       },
                       nullptr});
        EXPECT_TRUE(device->compiles());
        device->prepare({kernels::IntegratorKind::path, kTransforms | kEmitters, true});
        while (gpu.began == 0) std::this_thread::yield();
        device->load(s.scene, nullptr);  // does not wait
        EXPECT_TRUE(told.empty());
        device->set_frame(s.snapshot);
        EXPECT_GE(told.size(), 2u);
        EXPECT_EQ(device->statistics().required, kTransforms);
        EXPECT_EQ(device->statistics().compiled, kTransforms | kEmitters);  // what the shot was said to need
        Film film(32, 32, {});
        film.clear();
        device->begin_film(film);
        device->render({}, film);
        device->read_film(film);
        EXPECT_EQ(film.samples(3, 3), 1u);
        EXPECT_NE(gpu.launches.back().functions,
                  nullptr);  // the kernel asks, whether or not this frame has anything to answer
        EXPECT_EQ(gpu.runtime->count("build_trace_kernels"), 1u);
    }
    gpu.wait();
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(CompilingOnGpu, WhoCancelsDoesNotWaitForTheCompiler) {
    SlowCompiler gpu;
    SmallScene s = one_square();
    std::atomic<bool> cancel{false};
    std::unique_ptr<Device> device = gpu.make();
    device->watch({[&](double) { cancel = true; }, &cancel});
    device->prepare({kernels::IntegratorKind::path, kTransforms, false});
    device->load(s.scene, nullptr);
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THROW(device->set_frame(s.snapshot), Interrupted);
    device.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - begin,
              std::chrono::seconds(5));  // the compiler has not ended, and will not
    EXPECT_TRUE(DetachedWork::is_running());
    EXPECT_TRUE(gpu.hiprt.has_context);
    gpu.end = true;
    gpu.wait();
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(CompilingOnGpu, WhatAFrameNeedsBeyondTheShotsSetIsCompiledForIt) {
    FakeGpu gpu;
    SmallScene s = one_square();
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->prepare({kernels::IntegratorKind::path, 0, false});
        device->load(s.scene, nullptr);
        device->set_frame(s.snapshot);
        EXPECT_EQ(device->statistics().compiled, kTransforms);
        EXPECT_EQ(gpu.runtime->count("build_trace_kernels"), 2u);
        device->set_frame(s.snapshot);
        EXPECT_EQ(gpu.runtime->count("build_trace_kernels"), 2u);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(CompilingOnGpu, AFailureIsSaidByTheFrameThatWaits) {
    FakeGpu gpu;
    SmallScene s = one_square();
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(s.scene, nullptr);
        gpu.runtime->failing_call =
            static_cast<int>(gpu.runtime->calls.size()) + 1;  // after make_current, by the compiling thread
        device->prepare({kernels::IntegratorKind::path, kTransforms, false});
        while (gpu.runtime->count("build_trace_kernels") == 0) std::this_thread::yield();
        try {
            device->set_frame(s.snapshot);
            FAIL();
        } catch (const RenderError& error) {
            EXPECT_THAT(error.what(),
                        ::testing::StartsWith(
                            "cannot compile the kernel kadr_path for transforms (what HIPRT printed above says why): "
                            "HIPRT reports an internal error"));
        }
    }
    EXPECT_EQ(gpu.complaints(), "");
}

}  // namespace
}  // namespace kadr::test
