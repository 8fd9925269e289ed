#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kernels/camera/camera.h"
#include "kernels/camera/filter_table.h"
#include "kernels/statistics.h"

namespace kadr::kernels {
namespace {

struct Ray {
    Vec3f origin, direction;
};

Ray ray(const Camera& camera, int width, int height, Vec2f px, float time = 0.0f, Vec2f lens = {0.5f, 0.5f}) {
    Ray r;
    camera_ray(camera, width, height, px, time, lens, r.origin, r.direction);
    return r;
}

CameraKey upright(double fov_y, double aspect) {
    CameraKey key{};
    key.rotation[3] = 1.0f;
    key.tan_half_height = static_cast<float>(std::tan(0.5 * fov_y));
    key.tan_half_width = static_cast<float>(std::tan(0.5 * fov_y) * aspect);
    key.focus_distance = 1.0f;
    return key;
}

Camera one_key(const CameraKey& key) { return {&key, 1, false, 0, 0.0f, 1e30f}; }

TEST(Camera, FollowsTheAnalyticModel) {
    const int width = 60, height = 40;
    const double fov_y = 0.7, pixel_aspect = 1.25, a = 60.0 / 40.0 * pixel_aspect;
    const double sh = 2.0 / (1.0 + a), sw = 2.0 - sh;
    const CameraKey key = upright(fov_y, a);
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
            const double x = column + 0.5, y = height - row - 0.5;  // the model's y points upward
            const double d[3] = {x / width * sw - sw / 2, y / height * sh - sh / 2, -(sh / 2) / std::tan(fov_y / 2)};
            const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            const Ray r = ray(one_key(key), width, height, {column + 0.5f, row + 0.5f});
            EXPECT_NEAR(r.direction.x, d[0] / length, 3e-7);  // a few roundings of numbers below 1
            EXPECT_NEAR(r.direction.y, d[1] / length, 3e-7);
            EXPECT_NEAR(r.direction.z, d[2] / length, 3e-7);
        }
    }
}

TEST(Camera, RotatesByItsQuaternion) {
    CameraKey key = upright(1.0, 1.0);
    key.rotation[1] = key.rotation[3] = static_cast<float>(std::sqrt(0.5));  // 90 degrees about +y: -z becomes -x
    const Ray r = ray(one_key(key), 2, 2, {1.0f, 1.0f});
    EXPECT_NEAR(r.direction.x, -1.0f, 1e-6);
    EXPECT_NEAR(r.direction.y, 0.0f, 1e-6);
    EXPECT_NEAR(r.direction.z, 0.0f, 1e-6);
}

/// Quaternion of an angle about a unit axis.
void set_rotation(CameraKey& key, const double axis[3], double angle) {
    for (int i = 0; i < 3; ++i) key.rotation[i] = static_cast<float>(axis[i] * std::sin(0.5 * angle));
    key.rotation[3] = static_cast<float>(std::cos(0.5 * angle));
}

TEST(Camera, TurnsAtConstantSpeedBetweenKeys) {
    const double axis[3] = {0.0, 1.0, 0.0};
    const double step = 10.0 * M_PI / 180.0;
    for (const int count : {2, 4}) {
        std::vector<CameraKey> keys(static_cast<std::size_t>(count), upright(1.0, 1.0));
        for (int i = 0; i < count; ++i) {
            set_rotation(keys[i], axis, i * step);
            keys[i].position = {static_cast<float>(i), 0.0f, 0.0f};
            if (i % 2 == 1)
                for (float& q : keys[i].rotation) q = -q;  // the same rotation, the other sign
        }
        const Camera camera{keys.data(), count, false, 0, 0.0f, 1e30f};
        for (int i = 0; i <= 100; ++i) {
            const float time = static_cast<float>(i) / 100.0f;
            const Ray r = ray(camera, 2, 2, {1.0f, 1.0f}, time);
            const double angle = time * (count - 1) * step;
            EXPECT_NEAR(r.direction.x, -std::sin(angle), 4e-7);  // slerp below 1e-9; roundings
            EXPECT_NEAR(r.direction.z, -std::cos(angle), 4e-7);
            EXPECT_NEAR(r.origin.x, time * (count - 1), 1e-6);
        }
    }
}

TEST(Camera, SlerpWeightsHoldUpToAQuarterTurn) {
    for (const double half_angle : {0.01, 5.0, 30.0, 45.0}) {
        const double a = half_angle * M_PI / 180.0;
        for (double t = 0.0; t <= 1.0; t += 0.125) {
            const double weight = slerp_weight(t, std::cos(a) - 1.0) - std::sin(t * a) / std::sin(a);
            EXPECT_LT(std::abs(weight), half_angle <= 5.0    ? 1e-9
                                        : half_angle <= 30.0 ? 1e-6
                                                             : 2e-5)
                << half_angle << " at " << t;
        }
    }
}

TEST(Camera, LensRaysMeetAtTheFocusDistance) {
    CameraKey key = upright(0.8, 1.5);
    key.position = {1.0f, 2.0f, 3.0f};
    key.focus_distance = 4.0f;
    const Vec2f px{37.3f, 11.9f};
    const Ray pinhole = ray(one_key(key), 60, 40, px);
    const Vec3f focus = pinhole.origin + pinhole.direction * (4.0f / -pinhole.direction.z);
    key.lens_radius = 0.5f;
    Random random(1);
    for (const bool orthographic : {false, true}) {
        Camera camera = one_key(key);
        camera.orthographic = orthographic;
        camera.blades = orthographic ? 5 : 0;
        CameraKey sharp = key;
        sharp.lens_radius = 0.0f;
        Camera sharp_camera = one_key(sharp);
        sharp_camera.orthographic = orthographic;
        const Ray centre = ray(sharp_camera, 60, 40, px);
        const Vec3f expected = orthographic ? centre.origin + centre.direction * 4.0f : focus;
        for (int i = 0; i < 200; ++i) {
            const Ray r = ray(camera, 60, 40, px, 0.0f, random.pair());
            const Vec3f at = r.origin + r.direction * (4.0f / -r.direction.z);
            EXPECT_LT(length(at - expected), 4e-6f);  // roundings of coordinates of order 8
            EXPECT_LE(length(r.origin - centre.origin), 0.500001f);
        }
    }
}

TEST(Camera, ProjectUndoesCameraRay) {
    Random random(23);
    for (int i = 0; i < 2000; ++i) {
        CameraKey keys[2] = {upright(0.9, 1.3), upright(0.8, 1.3)};
        const double axis[3] = {0.6, 0.0, 0.8};
        set_rotation(keys[1], axis, 0.17);
        keys[1].position = {0.1f, -0.2f, 0.3f};
        const Camera camera{keys, 1 + i % 2, i % 3 == 0, 0, 0.0f, 1e30f};
        const float time = random();
        const Vec2f px{64.0f * random(), 48.0f * random()};
        const Ray r = ray(camera, 64, 48, px, time);
        const Vec2f back = project(camera, 64, 48, r.origin + r.direction * (0.5f + 20.0f * random()), time);
        // The point's coordinates (up to 20) carry 1e-6; magnified by 64 pixels over the smallest distance.
        ASSERT_NEAR(back.x, px.x, 1e-3f) << i;
        ASSERT_NEAR(back.y, px.y, 1e-3f) << i;
    }
}

/// A ray that starts ahead of the camera is a later part of the ray that starts at it.
TEST(Camera, RaysMayStartAheadOfIt) {
    Random random(29);
    for (int i = 0; i < 2000; ++i) {
        const bool orthographic = i % 3 == 0;
        CameraKey from_camera[2] = {upright(0.9, 1.3), upright(0.8, 1.3)}, ahead[2];
        const double axis[3] = {0.6, 0.0, 0.8};
        for (int k = 0; k < 2; ++k) {
            CameraKey& key = from_camera[k];
            if (i % 2 == 0 || k == 0) set_rotation(key, axis, 0.3);
            key.lens_radius = i % 5 == 0 ? 0.0f : 0.3f;
            key.focus_distance = 9.0f + static_cast<float>(k);
            key.position = {0.1f, -0.2f + static_cast<float>(k), 0.3f};
            ahead[k] = key;
            ahead[k].start = 6.0f;
            ahead[k].focus_distance = key.focus_distance - 6.0f;
            const Quaternion<float> q{key.rotation[0], key.rotation[1], key.rotation[2], key.rotation[3]};
            ahead[k].position = key.position + rotate(q, Vec3f{0, 0, -6});
        }
        // Two keys of one rotation, or one.
        const int count = i % 2 == 0 ? 2 : 1;
        Camera camera{from_camera, count, orthographic, 0, 0.0f, 1e30f}, later{ahead, count, orthographic, 0, 0.0f, 1e30f};
        const float time = random();
        const Vec2f px{64.0f * random(), 48.0f * random()}, lens = random.pair();
        const Ray a = ray(camera, 64, 48, px, time, lens), b = ray(later, 64, 48, px, time, lens);
        ASSERT_LT(length(a.direction - b.direction), 1e-6f) << i;
        const Vec3f between = b.origin - a.origin;
        const Vec3f axis_of_view = rotate(camera_at(camera, time).rotation, Vec3f{0, 0, -1});
        ASSERT_NEAR(dot(between, axis_of_view), 6.0f, 1e-5f) << i;
        ASSERT_LT(length(between - a.direction * dot(between, a.direction)), 1e-5f) << i;  // roundings of coordinates of order 8
        const Vec3f point = b.origin + b.direction * (0.5f + 20.0f * random());
        const Vec2f seen = project(camera, 64, 48, point, time), seen_later = project(later, 64, 48, point, time);
        ASSERT_NEAR(seen.x, seen_later.x, 1e-3f) << i;
        ASSERT_NEAR(seen.y, seen_later.y, 1e-3f) << i;
    }
}

struct NamedFilter {
    const char* name;
    FilterKind kind;
    float radius;
};
const NamedFilter kFilters[] = {{"box", FilterKind::box, 0.5f},
                                {"wide box", FilterKind::box, 1.0f},
                                {"gaussian", FilterKind::gaussian, 1.5f},
                                {"mitchell", FilterKind::mitchell, 2.0f},
                                {"blackman-harris", FilterKind::blackman_harris, 0.75f}};

TEST(Filter, SamplesFollowTheFilter) {
    constexpr int kBins = 40, kCount = 100000, kSteps = 200;
    for (const NamedFilter& f : kFilters) {
        FilterTable table;
        build_filter(f.kind, f.radius, table);
        std::vector<double> expected(kBins, 0.0), x_counts(kBins, 0.0), y_counts(kBins, 0.0);
        double total = 0.0;
        for (int i = 0; i < kBins * kSteps; ++i) {
            const double x = ((i + 0.5) / (kBins * kSteps) * 2.0 - 1.0) * f.radius;
            const double value = std::abs(filter_value(f.kind, f.radius, std::abs(x)));
            expected[i / kSteps] += value;
            total += value;
        }
        for (double& e : expected) e *= kCount / total;
        Random random(77);
        for (int i = 0; i < kCount; ++i) {
            Vec2f offset;
            float weight;
            sample_filter(table, random.pair(), offset, weight);
            const auto bin = [&](float x) {
                return std::min(kBins - 1, static_cast<int>((x / f.radius + 1.0f) * 0.5f * kBins));
            };
            ++x_counts[bin(offset.x)], ++y_counts[bin(offset.y)];
        }
        EXPECT_GT(chi2_p_value(x_counts, expected), sidak(10)) << f.name;
        EXPECT_GT(chi2_p_value(y_counts, expected), sidak(10)) << f.name;
    }
}

TEST(Filter, WeightsAverageToOneAndMomentsFit) {
    constexpr int kSide = 1000;
    for (const NamedFilter& f : kFilters) {
        FilterTable table;
        build_filter(f.kind, f.radius, table);
        double sum = 0.0, second = 0.0, mean = 0.0;
        for (int i = 0; i < kSide; ++i) {
            float weight;
            const float x = sample_filter_1d(table, (i + 0.5f) / kSide, weight);
            sum += weight, mean += weight * x, second += weight * x * x;
        }
        double norm = 0.0, expected = 0.0;
        for (int i = 0; i < 20000; ++i) {
            const double x = (i + 0.5) / 20000 * f.radius;
            norm += filter_value(f.kind, f.radius, x);
            expected += filter_value(f.kind, f.radius, x) * x * x;
        }
        EXPECT_NEAR(sum / kSide, 1.0, f.kind == FilterKind::mitchell ? 3e-3 : 1e-6)
            << f.name;  // sign change within 1/1000
        EXPECT_NEAR(mean / kSide, 0.0, 1e-3) << f.name;
        EXPECT_NEAR(second / kSide, expected / norm, 0.01 * f.radius * f.radius) << f.name;  // straight segments
    }
}

TEST(Filter, BoxIsExactAndEndsAreInside) {
    FilterTable box;
    build_filter(FilterKind::box, 0.5f, box);
    Vec2f offset;
    float weight;
    sample_filter(box, Vec2f{0.25f, 0.875f}, offset, weight);
    EXPECT_EQ(offset.x, -0.25f);
    EXPECT_EQ(offset.y, 0.375f);
    EXPECT_EQ(weight, 1.0f);
    for (const NamedFilter& f : kFilters) {
        FilterTable table;
        build_filter(f.kind, f.radius, table);
        for (const float u : {0.0f, 0.5f, kOneMinusEpsilon}) {
            sample_filter(table, Vec2f{u, u}, offset, weight);
            EXPECT_LE(std::abs(offset.x), f.radius) << f.name;
        }
    }
}

}  // namespace
}  // namespace kadr::kernels
