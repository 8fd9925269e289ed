// What the GPU's tracer asks of HIPRT, and what it makes of the answers.
#include "gpu/fake_hiprt_device.h"

// After HIPRT's interface.
#include "kernels/gpu/hiprt_tracer.h"

#include <gtest/gtest.h>

#include <utility>

namespace kadr::test {
namespace {

using namespace kernels;

constexpr float kRoot = 0.70710678f;

/// One triangle, in two instances that HIPRT knows under other numbers.
struct World {
    FakeScene top;
    FakeTable table;
    LaunchParams params{};
    LaunchCounters counters{};
    Vertex vertices[6] = {{{0, 0, 0}, {}, {}}, {{1, 0, 0}, {}, {}}, {{0, 1, 0}, {}, {}},
                          {{0, 0, 2}, {}, {}}, {{1, 0, 2}, {}, {}}, {{0, 1, 2}, {}, {}}};
    unsigned indices[3] = {0, 1, 2};
    Geometry geometry{};
    Instance instances[3] = {{0, 0, 0}, {0, 0, 1}, {0, 1, 2}};
    Material materials[2];
    unsigned instance_of[2] = {2, 1};

    World() {
        geometry.vertices = vertices;
        geometry.indices = indices;
        geometry.vertex_count = 3;
        geometry.triangle_count = 1;
        params.scene.geometries = &geometry;
        params.scene.instances = instances;
        params.scene.materials = materials;
        params.top = &top;
        params.functions = &table;
        params.instance_of = instance_of;
        params.ray_mask = 5;
    }
    HiprtTracer tracer(bool keep_blend = false) { return {params, keep_blend, counters}; }
    RayPayload payload(float time = 0) const { return {&params, time, {}}; }
    static PathState<float> path(Vec3f direction) {
        PathState<float> p{};
        p.origin = {1, 2, 3};
        p.direction = direction;
        p.time = 0.25f;
        p.sampler_key = 11;
        p.sample = 12;
        p.bounces = 13;
        return p;
    }
    static ShadowRay<float> shadow(Vec3f direction) { return {{1, 2, 3}, direction, 7, {1, 1, 1}, true}; }
};

hiprtHit hit_at(unsigned instance, unsigned primitive, float u, float v, float t) {
    return {instance, primitive, {u, v}, {0, 0, 1}, t};
}

TEST(HiprtTracer, AsksForTheClosestHitAtTheRaysTime) {
    World w;
    Hit<float> hit{-1, -1, 0, 0, kInfinity};
    CoverageRay seen;
    w.top.answer = [&](const FakeQuery& q) {
        seen = static_cast<const RayPayload*>(q.payload)->coverage;
        return hiprtHit{};
    };
    EXPECT_TRUE(w.tracer(true).closest(World::path({kRoot, 0.5f, 0.5f}), hit));
    ASSERT_EQ(w.top.queries.size(), 1u);
    const FakeQuery& q = w.top.queries[0];
    EXPECT_FALSE(q.any_hit);
    EXPECT_EQ(q.time, 0.25f);
    EXPECT_EQ(q.mask, 5u);
    EXPECT_EQ(q.table, &w.table);
    EXPECT_EQ(q.ray.origin.z, 3);
    EXPECT_EQ(q.ray.direction.x, kRoot);
    EXPECT_EQ(q.ray.minT, 0);
    EXPECT_EQ(q.ray.maxT, kInfinity);
    EXPECT_EQ(seen.key, coverage_key(11, 12, 13));
    EXPECT_TRUE(seen.keep_blend);
    EXPECT_FALSE(seen.shadow);
    EXPECT_EQ(hit.distance, kInfinity);  // nothing was met
}

TEST(HiprtTracer, NeverSendsADirectionOfExactlyZero) {
    World w;
    Hit<float> hit{};
    float transmittance = 1;
    w.tracer().closest(World::path({0.0f, -0.0f, 1}), hit);
    w.tracer().shadow(World::shadow({1, 0.0f, -0.0f}), 0, transmittance);
    EXPECT_EQ(w.top.queries[0].ray.direction.x, 1e-20f);
    EXPECT_EQ(w.top.queries[0].ray.direction.y, -1e-20f);
    EXPECT_EQ(w.top.queries[0].ray.direction.z, 1);
    EXPECT_EQ(w.top.queries[1].ray.direction.y, 1e-20f);
    EXPECT_EQ(w.top.queries[1].ray.direction.z, -1e-20f);
}

TEST(HiprtTracer, TranslatesHitsToTheScenesInstances) {
    World w;
    w.top.answer = [](const FakeQuery&) { return hit_at(0, 4, 0.25f, 0.5f, 9); };
    Hit<float> hit{0, 0, 0, 0, kInfinity};
    EXPECT_TRUE(w.tracer().closest(World::path({0, 0, 1}), hit));
    EXPECT_EQ(hit.instance, 2);
    EXPECT_EQ(hit.primitive, 4);
    EXPECT_EQ(hit.u, 0.25f);
    EXPECT_EQ(hit.v, 0.5f);
    EXPECT_EQ(hit.distance, 9);
}

TEST(HiprtTracer, ShadowsAreAnyHitUpToTheLight) {
    World w;
    float transmittance = 1;
    EXPECT_TRUE(w.tracer().shadow(World::shadow({0, 0, 1}), 0.75f, transmittance));
    EXPECT_EQ(transmittance, 1);
    const FakeQuery& q = w.top.queries[0];
    EXPECT_TRUE(q.any_hit);
    EXPECT_EQ(q.ray.maxT, 7);
    EXPECT_EQ(q.time, 0.75f);
    EXPECT_EQ(q.mask, 5u);
    EXPECT_EQ(q.table, &w.table);
    w.top.answer = [](const FakeQuery& query) {
        CoverageRay& ray = static_cast<RayPayload*>(query.payload)->coverage;
        EXPECT_TRUE(ray.shadow);
        ray.transmittance *= 0.25f;
        return hiprtHit{};
    };
    w.tracer().shadow(World::shadow({0, 0, 1}), 0, transmittance);
    EXPECT_EQ(transmittance, 0.25f);
    w.top.answer = [](const FakeQuery&) { return hit_at(0, 0, 0, 0, 1); };
    w.tracer().shadow(World::shadow({0, 0, 1}), 0, transmittance);
    EXPECT_EQ(transmittance, 0);
}

TEST(HiprtTracer, CountsOverflowsAndGivesTheRayUp) {
    World w;
    w.top.state = hiprtTraversalStateStackOverflow;
    w.top.answer = [](const FakeQuery&) { return hit_at(0, 0, 0, 0, 1); };
    Hit<float> hit{0, 0, 0, 0, kInfinity};
    float transmittance = 1;
    EXPECT_FALSE(w.tracer().closest(World::path({0, 0, 1}), hit));
    EXPECT_FALSE(w.tracer().shadow(World::shadow({0, 0, 1}), 0, transmittance));
    EXPECT_EQ(w.counters.stack_overflows, 2u);
}

TEST(HiprtTracer, MeetsNothingInAnEmptyScene) {
    World w;
    w.params.top = nullptr;
    Hit<float> hit{0, 0, 0, 0, kInfinity};
    float transmittance = 1;
    EXPECT_TRUE(w.tracer().closest(World::path({0, 0, 1}), hit));
    EXPECT_TRUE(w.tracer().shadow(World::shadow({0, 0, 1}), 0, transmittance));
    EXPECT_EQ(hit.distance, kInfinity);
    EXPECT_EQ(transmittance, 1);
}

hiprtRay ray_along(float z) {
    hiprtRay ray;
    ray.origin = {0.25f, 0.5f, -5 * z};
    ray.direction = {1e-20f, 1e-20f, z};
    ray.maxT = 100;
    return ray;
}

TEST(HiprtFunctions, RaysStopAtWhatCoversThem) {
    World w;
    RayPayload payload = w.payload();
    const hiprtHit opaque = hit_at(1, 0, 0.25f, 0.5f, 5), cut = hit_at(0, 0, 0.25f, 0.5f, 5);  // materials 0 and 1
    w.materials[1].alpha_mode = AlphaMode::mask;
    w.materials[1].alpha = 0.4f;
    EXPECT_FALSE(passes(ray_along(1), payload, opaque));
    EXPECT_TRUE(passes(ray_along(1), payload, cut));
    w.materials[1].alpha = 0.6f;
    EXPECT_FALSE(passes(ray_along(1), payload, cut));
}

TEST(HiprtFunctions, ShadowRaysAreDimmed) {
    World w;
    RayPayload payload = w.payload();
    payload.coverage.shadow = true;
    w.materials[1].alpha_mode = AlphaMode::blend;
    w.materials[1].alpha = 0.75f;
    EXPECT_TRUE(passes(ray_along(1), payload, hit_at(0, 0, 0.25f, 0.5f, 5)));
    EXPECT_EQ(payload.coverage.transmittance, 0.25f);
}

TEST(HiprtFunctions, CulledFacesLetRaysPassFromBehindAlone) {
    World w;
    RayPayload payload = w.payload();
    const hiprtHit hit = hit_at(1, 0, 0.25f, 0.5f, 5);
    EXPECT_FALSE(passes(ray_along(1), payload, hit));
    w.params.scene.settings.cull_backfaces = true;
    EXPECT_TRUE(passes(ray_along(1), payload, hit));    // along the normal, +z: from behind
    EXPECT_FALSE(passes(ray_along(-1), payload, hit));  // towards the front
    w.materials[0].double_sided = true;
    EXPECT_FALSE(passes(ray_along(1), payload, hit));
}

TEST(HiprtFunctions, FacesThatTurnAreCulledByWhereTheyAre) {
    World w;
    w.params.scene.settings.cull_backfaces = true;
    w.geometry.key_count = 2;
    std::swap(w.vertices[4], w.vertices[5]);  // turned over at the shutter's closing
    const hiprtHit hit = hit_at(1, 0, 0.25f, 0.5f, 5);
    RayPayload opening = w.payload(0), closing = w.payload(1);
    EXPECT_TRUE(passes(ray_along(1), opening, hit));
    EXPECT_FALSE(passes(ray_along(1), closing, hit));
}

TEST(HiprtFunctions, MovingTrianglesAreMetWhereTheyAre) {
    World w;
    w.geometry.key_count = 2;  // from z = 0 to z = 2
    hiprtHit hit = hit_at(0, 0, 0, 0, 0);
    ASSERT_TRUE(meets_moving(ray_along(1), w.payload(0.5f), hit));
    EXPECT_EQ(hit.t, 6);
    EXPECT_FLOAT_EQ(hit.uv.x, 0.25f);
    EXPECT_FLOAT_EQ(hit.uv.y, 0.5f);
    EXPECT_EQ(hit.normal.z, 1);
    hiprtRay ray = ray_along(1);
    ray.maxT = 5.5f;  // something nearer was met
    EXPECT_FALSE(meets_moving(ray, w.payload(0.5f), hit));
    EXPECT_TRUE(meets_moving(ray, w.payload(0.1f), hit));
}

}  // namespace
}  // namespace kadr::test
