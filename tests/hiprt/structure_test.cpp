// Structures and the work on them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/hiprt/gpu_mesh.h"
#include "device/hiprt/structure_builder.h"
#include "fake_hiprt.h"

namespace kadr::test {
namespace {

/// A GPU with the triangle of one mesh on its way.
struct Triangle {
    RecordingRuntime runtime;
    FakeHiprt fake{runtime};
    hiprt::Api api = FakeHiprt::api();
    std::vector<kernels::Vertex> vertices{
        {{0, 0, 0}, {0, 0, 1}, {0, 0}}, {{1, 0, 0}, {0, 0, 1}, {0, 0}}, {{0, 1, 0}, {0, 0, 1}, {0, 0}}};
    std::vector<unsigned> indices{0, 1, 2};
    kernels::Geometry host{};
    GpuMemory memory{current(runtime)};
    GpuStream stream{runtime};
    UploadQueue uploads{runtime, stream};
    HiprtContext context{api, runtime, ""};
    StructureBuilder builder{context, memory, stream};
    GpuMesh mesh;

    Triangle() {
        host.vertices = vertices.data();
        host.vertex_count = 3;
        host.indices = indices.data();
        host.triangle_count = 1;
        mesh = GpuMesh(memory, uploads, host);
    }
    static RecordingRuntime& current(RecordingRuntime& runtime) {
        check(runtime.make_current(), "use the GPU");
        return runtime;
    }
    HiprtGeometry build() {
        HiprtGeometry structure;
        const StructureJob job{mesh.build_input(host, false), &structure};
        builder.build({&job, 1}, build_options(StructureQuality::fast, false));
        return structure;
    }
};

TEST(Structures, AreNotFreedWhileTheyAreBuilt) {
    Triangle t;
    { const HiprtGeometry structure = t.build(); }
    EXPECT_THAT(t.runtime.faults, ::testing::IsEmpty());
    EXPECT_TRUE(t.fake.geometries.empty());
    EXPECT_EQ(t.memory.taken(MemoryUse::structures), 0u);
}

TEST(Structures, OfAllInstancesAreNotFreedWhileTheyAreBuilt) {
    Triangle t;
    const HiprtGeometry structure = t.build();
    const DeviceBuffer<hiprt::Instance> instances(t.memory, 1, MemoryUse::motion);
    const DeviceBuffer<kernels::TransformHeader> headers(t.memory, 1, MemoryUse::motion);
    const DeviceBuffer<kernels::FrameSrt> frames(t.memory, 1, MemoryUse::motion);
    const DeviceBuffer<std::uint32_t> masks(t.memory, 1, MemoryUse::motion);
    const hiprt::Instance instance{hiprt::InstanceType::geometry, structure.handle()};
    const kernels::TransformHeader header{0, 1};
    const kernels::FrameSrt frame{{0, 0, 1}, 0, {1, 1, 1}, {0, 0, 0}, 0, 0};
    const std::uint32_t mask = ~0u;
    t.uploads.add(instances, {&instance, 1});
    t.uploads.add(headers, {&header, 1});
    t.uploads.add(frames, {&frame, 1});
    t.uploads.add(masks, {&mask, 1});
    hiprt::SceneBuildInput input;
    input.instances = instances.pointer();
    input.headers = headers.pointer();
    input.frames = frames.pointer();
    input.masks = masks.pointer();
    input.instance_count = input.frame_count = 1;
    {
        const hiprt::BuildOptions options = build_options(StructureQuality::fast, false);
        HiprtTopLevel level;
        t.builder.build_top_level(level, input, options);
        const hiprt::Scene first = level.handle();
        t.builder.build_top_level(level, input, options);  // the next frame, of the same size: in the same memory
        EXPECT_EQ(level.handle(), first);
        EXPECT_EQ(t.runtime.count("create_scene"), 1u);
        EXPECT_TRUE(level.fits(input, options));
        hiprt::SceneBuildInput other = input;
        other.frame_count = 2;
        EXPECT_FALSE(level.fits(other, options));
        EXPECT_FALSE(level.fits(input, build_options(StructureQuality::high, false)));
    }
    EXPECT_THAT(t.runtime.faults, ::testing::IsEmpty());
    EXPECT_TRUE(t.fake.scenes.empty());
}

TEST(Structures, TakeWhatTheLedgerSays) {
    Triangle t;
    HiprtGeometry structure = t.build();
    const std::size_t bytes = t.fake.geometries.begin()->second.bytes;
    EXPECT_EQ(t.memory.taken(MemoryUse::structures), bytes);
    HiprtGeometry* const all[] = {&structure};
    t.builder.compact(all);
    EXPECT_LT(t.fake.geometries.begin()->second.bytes, bytes);
    EXPECT_EQ(t.memory.taken(MemoryUse::structures), t.fake.geometries.begin()->second.bytes);
    EXPECT_THAT(t.runtime.faults, ::testing::IsEmpty());
}

}  // namespace
}  // namespace kadr::test
