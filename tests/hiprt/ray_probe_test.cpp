// Single rays of the GPU device, over the fakes: what is launched, what comes back, what is freed.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/hiprt/ray_probe.h"
#include "device/varied_scenes.h"
#include "tracing_gpu.h"

namespace kadr::test {
namespace {

std::vector<kernels::Vec2f> grid(const SmallScene& s) {
    std::vector<kernels::Vec2f> points;
    for (int y = 0; y < s.snapshot.settings.height; ++y)
        for (int x = 0; x < s.snapshot.settings.width; ++x)
            points.push_back({static_cast<float>(x) + 0.437f, static_cast<float>(y) + 0.571f});
    return points;
}

void show(Device& device, SmallScene& s) {
    s.snapshot.geometry_key = 1;
    device.load(s.scene, s.environment.width > 0 ? &s.environment : nullptr);
    device.set_frame(s.snapshot);
}

std::vector<SurfaceRay> rays_from(const std::vector<SurfaceHit>& hits, const SmallScene& s) {
    const kernels::Vec3f eye = s.snapshot.camera_keys[0].position;
    std::vector<SurfaceRay> rays;
    for (const SurfaceHit& hit : hits) {
        if (!hit.met()) continue;
        const kernels::Vec3f p = kernels::splat<float>(hit.position);
        for (const kernels::Vec3f direction : {kernels::Vec3f{0.3f, 0.5f, 0.8124f}, kernels::Vec3f{-0.8f, 0.6f, 0}})
            rays.push_back({hit, normalize(eye - p), direction, 1e30f});
    }
    return rays;
}

/// Both trace the same surfaces in floats, by other formulas: an edge may lie on either side of a ray, which a grid of
/// 0.1 px finds about once in a thousand rays; where both meet the same triangle, it is in the same place to 1e-5.
void expect_same_answers(const std::string& name, SmallScene& s) {
    DeviceRequest request;
    request.name = "cpu";
    request.width = 1;
    const DeviceChoice cpu = make_device(request);
    TracingGpu gpu;
    gpu.hiprt.most_degrees_a_step = 45;  // its bounds would be too small, but here every triangle is looked at
    {
        const std::unique_ptr<Device> device = gpu.make();
        show(*cpu.device, s);
        show(*device, s);
        for (const double time : {0.0, 0.4}) {
            const std::vector<kernels::Vec2f> points = grid(s);
            const auto expected = cpu.device->probe()->look(points, time), found = device->probe()->look(points, time);
            ASSERT_EQ(found.size(), points.size());
            std::size_t other = 0, met = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                met += expected[i].met() ? 1 : 0;
                if (found[i].instance != expected[i].instance || found[i].primitive != expected[i].primitive) {
                    ++other;
                    continue;
                }
                EXPECT_NEAR(found[i].distance_m, expected[i].distance_m, 1e-4) << name;
                EXPECT_NEAR(found[i].position.x, expected[i].position.x, 1e-4) << name;
                EXPECT_NEAR(found[i].normal.z, expected[i].normal.z, 1e-4) << name;
            }
            EXPECT_GT(met, points.size() / 5) << name << ": there is hardly anything to meet";
            EXPECT_LE(other, points.size() / 250) << name;
            const std::vector<SurfaceRay> rays = rays_from(expected, s);
            const std::vector<char> shadows = cpu.device->probe()->occluded(rays, time),
                                    seen = device->probe()->occluded(rays, time);
            std::size_t wrong = 0;
            for (std::size_t i = 0; i < rays.size(); ++i) wrong += shadows[i] != seen[i] ? 1 : 0;
            EXPECT_LE(wrong, rays.size() / 250) << name;
        }
    }
    EXPECT_EQ(gpu.complaints(), "") << name;
}

TEST(RayProbeOfGpu, AnswersAsTheProcessorDoes) {
    for (const VariedScene& content : varied_scenes()) {
        SmallScene s = sunlit(kernels::IntegratorKind::path);
        content.add(s);
        expect_same_answers(content.name, s);
    }
}

TEST(RayProbeOfGpu, IsCompiledForTheGeometryAlone) {
    SmallScene s = sunlit(kernels::IntegratorKind::path);
    s.scene.textures.push_back(chequered());
    s.add_instance(s.add_mesh(unit_square()), textured(kernels::AlphaMode::mask), place({0, 0, 0}));
    FakeGpu gpu;
    {
        const std::unique_ptr<Device> device = gpu.make();
        show(*device, s);
        const std::vector<kernels::Vec2f> point{{16, 16}};
        EXPECT_FALSE(device->probe()->look(point, 0.25)[0].met());  // the fake meets nothing
        EXPECT_TRUE(device->probe()->occluded(std::vector<SurfaceRay>(1), 0.5)[0]);
        const FakeHiprt::ModuleRecord* module = nullptr;
        for (const auto& [name, record] : gpu.hiprt.modules)
            if (name.starts_with("kadr_probe")) module = &record;
        ASSERT_NE(module, nullptr);
        EXPECT_EQ(module->source, "#define KADR_REQUIREMENTS 2u\n#include \"kernels/gpu/probe_entry.h\"\n");
        ASSERT_EQ(gpu.probes.size(), 2u);
        EXPECT_EQ(gpu.probes[0].time, 0.25f);
        EXPECT_EQ(gpu.probes[1].film_px, nullptr);
        EXPECT_NE(gpu.probes[0].frame.functions, nullptr) << "rays ask about what is cut out";
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(RayProbeOfGpu, ManyRaysGoInBatches) {
    SmallScene s = sunlit(kernels::IntegratorKind::path);
    s.add_instance(s.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), place({0, 0, 0}));
    FakeGpu gpu;
    {
        const std::unique_ptr<Device> device = gpu.make();
        show(*device, s);
        const std::size_t before = gpu.runtime->count("launch");
        const std::vector<kernels::Vec2f> points(2 * RayProbe::kBatch + 5, {1, 1});
        EXPECT_EQ(device->probe()->look(points, 0).size(), points.size());
        EXPECT_EQ(gpu.runtime->count("launch") - before, 3u);
        EXPECT_EQ(gpu.probes.back().count, 5u);
        EXPECT_TRUE(device->probe()->look({}, 0).empty());
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(RayProbeOfGpu, WhicheverCallFailsTheErrorIsClear) {
    SmallScene s = sunlit(kernels::IntegratorKind::path);
    s.add_instance(s.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), place({0, 0, 0}));
    FakeGpu right;
    std::size_t first = 0, last = 0;
    {
        const std::unique_ptr<Device> device = right.make();
        show(*device, s);
        first = right.runtime->calls.size();
        device->probe()->look(grid(s), 0);
        device->probe()->occluded(std::vector<SurfaceRay>(3), 0);
        last = right.runtime->calls.size();
    }
    ASSERT_GT(last, first + 5);
    for (std::size_t n = first; n < last; ++n) {
        FakeGpu gpu;
        {
            const std::unique_ptr<Device> device = gpu.make();
            show(*device, s);
            gpu.runtime->failing_call = static_cast<int>(n);
            std::string message;
            try {
                device->probe()->look(grid(s), 0);
                device->probe()->occluded(std::vector<SurfaceRay>(3), 0);
            } catch (const RenderError& error) {
                message = error.what();
            }
            EXPECT_THAT(message, ::testing::StartsWith("cannot ")) << right.runtime->calls[n];
            EXPECT_EQ(device->probe()->look(grid(s), 0).size(), grid(s).size());  // it goes on afterwards
        }
        EXPECT_EQ(gpu.complaints(), "") << right.runtime->calls[n];
    }
}

}  // namespace
}  // namespace kadr::test
