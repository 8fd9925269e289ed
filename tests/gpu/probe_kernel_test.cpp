// The GPU's kernel of single rays, built for the host over Embree: the answers of the processor's probe to the last bit.
#include <gtest/gtest.h>

#include <xmmintrin.h>

#include <cstring>

#include "device/embree/embree_tracer.h"
#include "device/tables/scene_probe.h"
#include "device/varied_scenes.h"
#include "kernels/gpu/entry_points.h"

namespace kadr::test {
namespace {

constexpr unsigned kTransforms = kernels::requirement::kTransforms, kDeformation = kernels::requirement::kDeformation;

/// As a grid of blocks answers it, by the kernel for exactly the set.
void launch(unsigned set, const kernels::ProbeParams& params, const EmbreeScene& scene) {
    EmbreeTracer tracer(scene, true);
    const unsigned saved = _mm_getcsr();
    _mm_setcsr(saved | 0x8040);  // the device flushes denormals while it traces
    for (unsigned i = 0; i < params.count; ++i) switch (set) {
            case 0: kernels::answer_probe<0>(params, tracer, i); break;
            case kTransforms: kernels::answer_probe<kTransforms>(params, tracer, i); break;
            case kDeformation: kernels::answer_probe<kDeformation>(params, tracer, i); break;
            default: kernels::answer_probe<kTransforms | kDeformation>(params, tracer, i);
        }
    _mm_setcsr(saved);
}

bool same_bits(const SurfaceHit& a, const SurfaceHit& b) {
    const double x[] = {a.u, a.v, a.distance_m, a.position.x, a.position.y, a.position.z, a.normal.x, a.normal.y, a.normal.z},
                 y[] = {b.u, b.v, b.distance_m, b.position.x, b.position.y, b.position.z, b.normal.x, b.normal.y, b.normal.z};
    return a.instance == b.instance && a.primitive == b.primitive && std::memcmp(x, y, sizeof x) == 0;
}

/// No tolerance: one template, one tracer. The kernel is compiled for what geometry needs, where the probe has all.
void expect_same(const std::string& name, SmallScene& s) {
    s.snapshot.geometry_key = 1;
    DeviceRequest request;
    request.name = "cpu";
    request.width = 1;
    const DeviceChoice cpu = make_device(request);
    const Image* sky = s.environment.width > 0 ? &s.environment : nullptr;
    cpu.device->load(s.scene, sky);
    cpu.device->set_frame(s.snapshot);
    const EmbreeDeviceHandle embree(rtcNewDevice(nullptr));
    EmbreeScene scene(embree.get(), s.scene, sky);
    scene.set_frame(s.snapshot);
    const unsigned set = kernels::kernel_requirements(kernels::Kernel::probe, scene.requirements());

    std::vector<kernels::Vec2f> points;
    for (int i = 0; i < 64 * 64; ++i)
        points.push_back({static_cast<float>(i % 64) * 0.5f + 0.1f, static_cast<float>(i / 64) * 0.5f + 0.2f});
    std::vector<kernels::ProbeHit> hits(points.size());
    kernels::ProbeParams params{};
    params.frame.scene = scene.view();
    params.time = 0.3f;
    params.count = static_cast<unsigned>(points.size());
    params.film_px = points.data();
    params.hits = hits.data();
    launch(set, params, scene);
    const std::vector<SurfaceHit> expected = cpu.device->probe()->look(points, params.time);
    std::vector<SurfaceRay> rays;
    std::size_t met = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        EXPECT_TRUE(same_bits(surface_hit_of(hits[i]), expected[i])) << name << ", ray " << i;
        if (!expected[i].met()) continue;
        ++met;
        rays.push_back({expected[i], kernels::splat<float>(expected[i].normal), {0.6f, 0.64f, 0.48f}, 1e30f});
    }
    EXPECT_GT(met, 200u) << name;

    std::vector<kernels::ProbeShadow> shadows;
    for (const SurfaceRay& ray : rays) shadows.push_back(probe_shadow_of<float>(ray));
    std::vector<unsigned char> answers(rays.size(), 7);
    params.film_px = nullptr;
    params.count = static_cast<unsigned>(rays.size());
    params.shadows = shadows.data();
    params.occluded = answers.data();
    launch(set, params, scene);
    const std::vector<char> in_shadow = cpu.device->probe()->occluded(rays, params.time);
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(answers[i], in_shadow[i]) << name << ", shadow ray " << i;
}

TEST(ProbeKernel, AnswersAsTheProcessorsProbe) {
    for (const VariedScene& content : varied_scenes()) {
        SmallScene s = sunlit(kernels::IntegratorKind::path);
        content.add(s);
        expect_same(content.name, s);
    }
}

}  // namespace
}  // namespace kadr::test
