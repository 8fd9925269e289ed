// The triangles that a GPU's rays meet by a function of ours: closed, and where they are at the ray's time.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "device/small_scene.h"
#include "kernels/gpu/moving_triangle.h"

namespace kadr::test {
namespace {

using kernels::TriangleHit;
using kernels::Vec3f;

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float uniform(float low = -1, float high = 1) { return std::uniform_real_distribution<float>(low, high)(engine_); }
    Vec3f vector() { return {uniform(), uniform(), uniform()}; }

private:
    std::mt19937 engine_;
};

TEST(MovingTriangle, MeetsThePointThatARayIsAimedAt) {
    Random random(1);
    for (int i = 0; i < 100'000; ++i) {
        const Vec3f corners[3] = {random.vector(), random.vector(), random.vector()};
        const Vec3f normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
        float u = random.uniform(0.01f, 0.98f), v = random.uniform(0.01f, 0.98f);
        if (u + v > 0.99f) u = 0.99f - u * 0.5f, v = 0.3f * (1 - u);
        const Vec3f target = corners[0] * (1 - u - v) + corners[1] * u + corners[2] * v;
        const Vec3f origin = random.vector() * 3.0f, direction = target - origin;
        // A ray within a degree of the plane, or a sliver, is a matter of rounding.
        const float slant = std::abs(dot(direction, normal)) / (length(direction) * length(normal));
        if (slant < 0.02f || length(normal) < 0.05f) continue;
        TriangleHit hit{};
        ASSERT_TRUE(intersect_triangle(origin, direction, corners, 0, 10, hit)) << i;
        EXPECT_NEAR(hit.distance, 1, 1e-4f);  // rounding to 6e-8 over the least slant and area, 1e-3
        EXPECT_NEAR(hit.u, u, 1e-3f);
        EXPECT_NEAR(hit.v, v, 1e-3f);
        EXPECT_FALSE(intersect_triangle(origin, direction, corners, 0, 0.99f, hit));
        EXPECT_FALSE(intersect_triangle(origin, direction, corners, 1.01f, 10, hit));
    }
}

TEST(MovingTriangle, LetsNoRayBetweenNeighbours) {
    Random random(2);
    for (int i = 0; i < 100'000; ++i) {
        // Four triangles around a common corner; a ray aimed exactly at the corner, or at a point of an inner edge.
        const Vec3f middle{random.uniform(-0.2f, 0.2f), random.uniform(-0.2f, 0.2f), random.uniform(-0.1f, 0.1f)};
        const Vec3f ring[4] = {{1, random.uniform(-0.3f, 0.3f), 0},
                               {random.uniform(-0.3f, 0.3f), 1, 0},
                               {-1, random.uniform(-0.3f, 0.3f), 0},
                               {random.uniform(-0.3f, 0.3f), -1, 0}};
        const float along = i % 2 == 0 ? 0 : random.uniform(0.1f, 0.9f);
        const Vec3f target = middle + (ring[i % 4] - middle) * along;
        const Vec3f origin{random.uniform(), random.uniform(), 2};
        bool met = false;
        for (int k = 0; k < 4; ++k) {
            const Vec3f corners[3] = {middle, ring[k], ring[(k + 1) % 4]};
            TriangleHit hit{};
            met = met || intersect_triangle(origin, target - origin, corners, 0, 10, hit);
        }
        ASSERT_TRUE(met) << i;
    }
}

TEST(MovingTriangle, OwnsItsEdgesAndCorners) {
    const Vec3f corners[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Vec3f turned[3] = {corners[0], corners[2], corners[1]};
    for (const auto& [x, y] :
         {std::pair{0.5f, 0.0f}, {0.0f, 0.5f}, {0.5f, 0.5f}, {0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}}) {
        TriangleHit hit{};
        EXPECT_TRUE(intersect_triangle({x, y, 1}, {0, 0, -1}, corners, 0, 2, hit)) << x << ' ' << y;
        EXPECT_TRUE(intersect_triangle({x, y, 1}, {0, 0, -1}, turned, 0, 2, hit)) << x << ' ' << y;
    }
}

TEST(MovingTriangle, HasNoSideAndNoThickness) {
    const Vec3f corners[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Vec3f turned[3] = {corners[0], corners[2], corners[1]};
    TriangleHit front{}, back{};
    ASSERT_TRUE(intersect_triangle({0.25f, 0.5f, 1}, {0, 0, -1}, corners, 0, 2, front));
    ASSERT_TRUE(intersect_triangle({0.25f, 0.5f, 1}, {0, 0, -1}, turned, 0, 2, back));
    EXPECT_EQ(front.u, 0.25f);
    EXPECT_EQ(front.v, 0.5f);
    EXPECT_EQ(back.u, 0.5f);
    EXPECT_EQ(back.v, 0.25f);
    EXPECT_FALSE(intersect_triangle({-1, 0.25f, 0}, {1, 0, 0}, corners, 0, 2, front));  // along its plane
}

TEST(MovingTriangle, IsWhereItsKeysAreAtTheRaysTime) {
    // Two segments of the shutter: to +x, then to +y.
    std::vector<kernels::Vertex> vertices;
    for (const Vec3f shift : {Vec3f{0, 0, 0}, Vec3f{2, 0, 0}, Vec3f{2, 2, 0}})
        for (const Vec3f p : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}}) vertices.push_back({p + shift, {}, {}});
    const unsigned indices[] = {0, 1, 2};
    kernels::Geometry g{};
    g.vertices = vertices.data();
    g.indices = indices;
    g.vertex_count = 3;
    g.triangle_count = 1;
    g.key_count = 3;
    for (const auto& [time, x, y] : {std::tuple{0.0f, 0.0f, 0.0f},
                                     {0.25f, 1.0f, 0.0f},
                                     {0.5f, 2.0f, 0.0f},
                                     {0.75f, 2.0f, 1.0f},
                                     {1.0f, 2.0f, 2.0f}}) {
        Vec3f corners[3];
        corners_at(g, 0, time, corners);
        EXPECT_EQ(corners[0].x, x) << time;
        EXPECT_EQ(corners[0].y, y) << time;
        EXPECT_EQ(corners[1].x, x + 1) << time;
        EXPECT_EQ(corners[2].y, y + 1) << time;
    }
}

}  // namespace
}  // namespace kadr::test
