// The fakes see what a GPU would punish: each fault is committed here once. Without this, a test that finds no faults
// would say nothing.

#include <cmath>
#include <cstring>
#include <functional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_hiprt.h"
#include "kernels/gpu/launch_params.h"
#include "recording_runtime.h"

namespace kadr {
namespace {

using test::FakeHiprt;
using test::RecordingRuntime;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr float kPi = 3.14159265f;

/// A GPU with a triangle and a scene that shows it, made by hand.
struct ByHand {
    RecordingRuntime runtime;
    FakeHiprt fake{runtime};
    hiprt::Api api = FakeHiprt::api();
    hiprt::Context context = nullptr;
    GpuStreamHandle stream = nullptr;
    hiprt::GeometryBuildInput input;
    hiprt::BuildOptions options;
    hiprt::Geometry geometry = nullptr;

    ByHand() {
        (void)runtime.make_current();
        (void)runtime.create_stream(stream);
        api.create_context(hiprt::kApiVersion, {runtime.native_context(), 0, hiprt::DeviceType::nvidia}, context);
        input.mesh = {put<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}), 3, 12, put<std::uint32_t>({0, 1, 2}), 1, 12, nullptr, 0};
    }
    template <class T>
    void* put(const std::vector<T>& values) {
        DeviceAddress address = 0;
        (void)runtime.allocate(values.size() * sizeof(T), address);
        std::memcpy(reinterpret_cast<void*>(address), values.data(), values.size() * sizeof(T));
        return reinterpret_cast<void*>(address);
    }
    void wait() { (void)runtime.synchronize_all(); }
    void create() {
        hiprt::Geometry* created[] = {&geometry};
        api.create_geometries(context, 1, &input, options, created);
    }
    void build(hiprt::BuildOperation operation = hiprt::BuildOperation::build) {
        std::size_t bytes = 0;
        api.geometries_temporary_size(context, 1, &input, options, bytes);
        api.build_geometries(context, operation, 1, &input, options, put<std::byte>(std::vector<std::byte>(bytes)),
                             stream, &geometry);
        wait();
    }
    void make_geometry() {
        create();
        build();
    }
    template <class Frame>
    void show(const std::vector<Frame>& frames, std::vector<kernels::TransformHeader> headers,
              hiprt::FrameType type = hiprt::FrameType::srt) {
        hiprt::SceneBuildInput scene;
        scene.instances = put<hiprt::Instance>(
            std::vector<hiprt::Instance>(headers.size(), {hiprt::InstanceType::geometry, geometry}));
        scene.masks = put<std::uint32_t>(std::vector<std::uint32_t>(headers.size(), ~0u));
        scene.instance_count = static_cast<std::uint32_t>(headers.size());
        scene.headers = put(headers);
        scene.frames = put(frames);
        scene.frame_count = static_cast<std::uint32_t>(frames.size());
        scene.frame_type = type;
        hiprt::Scene created = nullptr;
        std::size_t bytes = 0;
        api.create_scene(context, scene, options, created);
        api.scene_temporary_size(context, scene, options, bytes);
        api.build_scene(context, hiprt::BuildOperation::build, scene, options,
                        put<std::byte>(std::vector<std::byte>(bytes)), stream, created);
        wait();
    }
};

kernels::FrameSrt frame(float time, float angle = 0, float scale = 1) {
    return {{0, 0, 1}, angle, {scale, scale, scale}, {0, 0, 0}, time, 0};
}

/// The first fault of what a test does by hand.
template <class Action>
std::string fault(const Action& action) {
    ByHand hand;
    action(hand);
    return hand.runtime.faults.empty() ? "" : hand.runtime.faults.front();
}

TEST(Fakes, WhatIsRightHasNoFault) {
    EXPECT_EQ(
        fault([](ByHand& h) {
            h.make_geometry();
            h.build(hiprt::BuildOperation::update);
            h.show<kernels::FrameSrt>({frame(0), frame(0, 0.1f), frame(0.5f, 0.2f), frame(1, 0.3f)}, {{0, 1}, {1, 3}});
        }),
        "");
}

TEST(Fakes, Memory) {
    EXPECT_THAT(fault([](ByHand& h) {
                    void* pinned = nullptr;
                    (void)h.runtime.allocate_pinned(16, pinned);
                    (void)h.runtime.upload(reinterpret_cast<DeviceAddress>(h.input.mesh.indices), pinned, 16, h.stream);
                }),
                HasSubstr("upload: 16 bytes are not inside one allocation"));
    EXPECT_THAT(fault([](ByHand& h) {
                    (void)h.runtime.upload(reinterpret_cast<DeviceAddress>(h.input.mesh.indices), &h, 4, h.stream);
                }),
                HasSubstr("upload: 4 bytes are not inside pinned memory"));
    EXPECT_THAT(fault([](ByHand& h) {
                    const auto a = reinterpret_cast<DeviceAddress>(h.input.mesh.indices);
                    (void)h.runtime.fill(a, 0, 4, h.stream);
                    (void)h.runtime.release(a);
                }),
                HasSubstr("freed while work on it is pending"));
    EXPECT_THAT(fault([](ByHand& h) {
                    const auto a = reinterpret_cast<DeviceAddress>(h.input.mesh.indices);
                    (void)h.runtime.release(a);
                    (void)h.runtime.fill(a, 0, 4, h.stream);
                }),
                HasSubstr("used after it was freed"));
    EXPECT_THAT(fault([](ByHand& h) {
                    const auto a = reinterpret_cast<DeviceAddress>(h.input.mesh.indices);
                    (void)h.runtime.release(a);
                    (void)h.runtime.release(a);
                }),
                HasSubstr("freed before"));
    ByHand hand;
    EXPECT_THAT(hand.runtime.leaks(), Contains("a stream"));
    EXPECT_THAT(hand.runtime.leaks(), Contains("12 bytes of device memory"));
}

/// Streams, an event and memory, to race with.
struct TwoStreams : ByHand {
    GpuStreamHandle other = nullptr;
    GpuEventHandle event = nullptr;
    DeviceAddress target = 0;
    void* pinned = nullptr;
    kernels::LaunchParams params{};
    DeviceAddress list = 0;  ///< of instances, which the launch reads through its argument

    TwoStreams() {
        (void)runtime.create_stream(other);
        (void)runtime.create_event(event);
        (void)runtime.allocate(64, list);
        (void)runtime.allocate(64, target);
        (void)runtime.allocate_pinned(64, pinned);
        std::memset(pinned, 0, 64);
        std::memset(reinterpret_cast<void*>(target), 0, 64);
        // A table that leads to another: what a launch reads by way of it.
        std::memcpy(reinterpret_cast<void*>(list), &target, sizeof target);
        params.scene.instances = reinterpret_cast<const kernels::Instance*>(list);
    }
    void launch(GpuStreamHandle on) {
        void* const arguments[] = {&params};
        (void)runtime.launch(runtime.make_function("kernel"), {}, arguments, on);
    }
    void overwrite(GpuStreamHandle on) { (void)runtime.upload(target, pinned, 8, on); }
};

std::string race(const std::function<void(TwoStreams&)>& action) {
    TwoStreams hand;
    action(hand);
    hand.wait();
    return hand.runtime.faults.empty() ? "" : hand.runtime.faults.front();
}

TEST(Fakes, StreamsThatDoNotWaitForEachOther) {
    const auto kNoWait = HasSubstr("use the same memory on two streams, and neither waits for the other");
    EXPECT_THAT(race([](TwoStreams& h) { h.launch(h.stream), h.overwrite(h.other); }), kNoWait);
    EXPECT_THAT(race([](TwoStreams& h) { h.overwrite(h.other), h.launch(h.stream); }), kNoWait);
    EXPECT_THAT(race([](TwoStreams& h) { h.overwrite(h.stream), h.overwrite(h.other); }), kNoWait);
    // An event that was recorded too early, or that the wrong stream waits for, orders nothing.
    EXPECT_THAT(race([](TwoStreams& h) {
                    (void)h.runtime.record(h.event, h.other);
                    h.overwrite(h.other);
                    (void)h.runtime.make_wait(h.stream, h.event);
                    h.launch(h.stream);
                }),
                kNoWait);
    EXPECT_THAT(race([](TwoStreams& h) {
                    h.overwrite(h.other);
                    (void)h.runtime.record(h.event, h.other);
                    h.launch(h.stream);
                    (void)h.runtime.make_wait(h.stream, h.event);
                }),
                kNoWait);
    // Running is not enough: the host did not wait for it.
    EXPECT_THAT(race([](TwoStreams& h) {
                    h.launch(h.stream);
                    (void)h.runtime.record(h.event, h.stream);
                    GpuStreamHandle third = nullptr;
                    (void)h.runtime.create_stream(third);
                    (void)h.runtime.make_wait(third, h.event);
                    h.launch(third);
                    h.overwrite(h.other);
                }),
                kNoWait);
}

TEST(Fakes, StreamsThatWaitForEachOther) {
    EXPECT_EQ(race([](TwoStreams& h) { h.launch(h.stream), h.overwrite(h.stream); }), "");
    EXPECT_EQ(race([](TwoStreams& h) { h.launch(h.stream), h.launch(h.other); }), "");
    EXPECT_EQ(race([](TwoStreams& h) { h.launch(h.stream), h.wait(), h.overwrite(h.other); }), "");
    EXPECT_EQ(race([](TwoStreams& h) {
                  h.overwrite(h.other);
                  (void)h.runtime.record(h.event, h.other);
                  (void)h.runtime.make_wait(h.stream, h.event);
                  h.launch(h.stream);
              }),
              "");
    EXPECT_EQ(race([](TwoStreams& h) {
                  h.launch(h.stream);
                  (void)h.runtime.record(h.event, h.stream);
                  (void)h.runtime.wait_for(h.event);
                  h.overwrite(h.other);
              }),
              "");
}

TEST(Fakes, WhatTheHostDidNotWaitForIsPending) {
    TwoStreams h;
    h.launch(h.stream);
    (void)h.runtime.release(h.list);
    EXPECT_THAT(h.runtime.faults, Contains(HasSubstr("freed while work on it is pending")));
}

TEST(Fakes, ThreadsWithoutContext) {
    EXPECT_THAT(fault([](ByHand& h) {
                    std::thread([&] {
                        DeviceAddress address = 0;
                        (void)h.runtime.allocate(4, address);
                    }).join();
                }),
                HasSubstr("this thread never called make_current"));
}

TEST(Fakes, Geometries) {
    EXPECT_THAT(fault([](ByHand& h) {
                    h.input.mesh.vertex_count = 4;
                    h.create();
                }),
                HasSubstr("vertices: 48 bytes are not inside one allocation"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.input.mesh.indices = h.put<std::uint32_t>({0, 1, 3});
                    h.make_geometry();
                }),
                HasSubstr("an index is beyond the vertices"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.input.mesh.vertices = h.put<float>({0, 0, 0, 1, NAN, 0, 0, 1, 0});
                    h.make_geometry();
                }),
                HasSubstr("a vertex is not finite"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.create();
                    h.options.flags = hiprt::build_flag::kHighQuality;
                    h.build();
                }),
                HasSubstr("other flags than it was created with"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.create();
                    h.api.build_geometries(h.context, hiprt::BuildOperation::build, 1, &h.input, h.options,
                                           h.put<std::byte>(std::vector<std::byte>(4096)), h.stream, &h.geometry);
                }),
                HasSubstr("its temporary size was never asked for"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.create();
                    std::size_t bytes = 0;
                    h.api.geometries_temporary_size(h.context, 1, &h.input, h.options, bytes);
                    h.api.build_geometries(h.context, hiprt::BuildOperation::build, 1, &h.input, h.options,
                                           h.put<std::byte>(std::vector<std::byte>(bytes - 1)), h.stream, &h.geometry);
                }),
                HasSubstr("temporary buffer"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.make_geometry();
                    h.input.mesh.indices = h.put<std::uint32_t>({0, 2, 1});
                    h.build(hiprt::BuildOperation::update);
                }),
                HasSubstr("updated with other triangles"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.create();
                    h.build(hiprt::BuildOperation::update);
                }),
                HasSubstr("updated before it was built"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.input.geometry_type = 0;
                    h.options.flags = hiprt::build_flag::kHighQuality;
                    h.create();
                }),
                HasSubstr("spatial splits"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.make_geometry();
                    h.show<kernels::FrameSrt>({frame(0)}, {{0, 1}});
                    h.api.destroy_geometry(h.context, h.geometry);
                }),
                HasSubstr("a scene still shows it"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.make_geometry();
                    h.api.destroy_context(h.context);
                }),
                HasSubstr("there is still a geometry"));
}

std::string fault_of_frames(const std::vector<kernels::FrameSrt>& frames) {
    return fault([&](ByHand& h) {
        h.make_geometry();
        h.show(frames, {{0, static_cast<unsigned>(frames.size())}});
    });
}

TEST(Fakes, Frames) {
    EXPECT_EQ(fault_of_frames({frame(0), frame(1)}), "");
    EXPECT_THAT(fault_of_frames({frame(0), frame(0.5f), frame(0.5f), frame(1)}),
                HasSubstr("times of frames do not increase"));
    EXPECT_THAT(fault_of_frames({frame(0), frame(1.5f)}), HasSubstr("outside [0, 1]"));
    EXPECT_THAT(fault_of_frames({frame(0), frame(0.9f)}), HasSubstr("do not span the shutter"));
    EXPECT_THAT(fault_of_frames({frame(0), frame(1, 11 * kPi / 180)}),
                HasSubstr("a turn of 11.000 degrees between two frames"));
    EXPECT_EQ(fault_of_frames({frame(0), frame(1, 10 * kPi / 180)}), "");
    EXPECT_THAT(fault_of_frames({frame(0, 0, 0)}), HasSubstr("zero scale"));
    EXPECT_THAT(fault_of_frames({frame(0), frame(1, 0, -1)}), HasSubstr("a scale passes through zero"));
    EXPECT_THAT(fault_of_frames({frame(0, NAN)}), HasSubstr("not finite"));
    EXPECT_THAT(fault_of_frames({frame(0, 4)}), HasSubstr("beyond pi"));
    EXPECT_THAT(fault([](ByHand& h) {
                    h.make_geometry();
                    h.show<kernels::FrameSrt>({frame(0)}, {{0, 2}});
                }),
                HasSubstr("a transform header beyond the frames"));
}

TEST(Fakes, ShearedMotion) {
    kernels::FrameMatrix a{{{1, 0.5f, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, 0, {}}, b = a;
    b.time = 1;
    const auto show = [&](const std::vector<kernels::FrameMatrix>& frames) {
        return fault([&](ByHand& h) {
            h.make_geometry();
            h.show(frames, {{0, static_cast<unsigned>(frames.size())}}, hiprt::FrameType::matrix);
        });
    };
    EXPECT_EQ(show({a}), "");
    EXPECT_THAT(show({a, b}), HasSubstr("a moving instance is sheared"));
}

TEST(Fakes, Modules) {
    const auto compile = [](ByHand& h, const char* source) {
        const char *name = "kernel", *option = "-std=c++17";
        hiprt::Function function = nullptr;
        h.api.build_trace_kernels(h.context, 1, &name, source, "module", 0, nullptr, nullptr, 1, &option, 0, 0, nullptr,
                                  &function, nullptr, true);
    };
    EXPECT_THAT(fault([&](ByHand& h) { compile(h, "a"); }), HasSubstr("compile errors would not be seen"));
    EXPECT_THAT(fault([&](ByHand& h) {
                    h.api.set_log_level(h.context, hiprt::log_level::kErrors);
                    compile(h, "a");
                    compile(h, "b");
                }),
                HasSubstr("one module name for two sources"));
}

TEST(Fakes, AnyCallFailsOnDemand) {
    RecordingRuntime runtime;
    (void)runtime.make_current();
    runtime.failing_call = 2;
    DeviceAddress address = 0;
    EXPECT_EQ(runtime.allocate(4, address).kind, GpuResult::Kind::success);
    EXPECT_EQ(runtime.allocate(4, address).kind, GpuResult::Kind::failure);
    EXPECT_EQ(runtime.allocate(4, address).kind, GpuResult::Kind::success);
}

}  // namespace
}  // namespace kadr
