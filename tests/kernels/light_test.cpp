#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kernels/light/environment_tables.h"
#include "kernels/light/light.h"
#include "kernels/statistics.h"

namespace kadr::kernels {
namespace {

constexpr Vec3f kUp{0, 1, 0};

Light make(LightKind kind, float radius = 0.0f) {
    Light l;
    l.kind = kind;
    l.radiance = {2.0f, 4.0f, 8.0f};
    l.direction = {0, -1, 0};
    l.radius = radius;
    return l;
}

Light spot(SpotFalloff falloff, double inner, double outer) {
    Light l = make(LightKind::spot);
    l.falloff = falloff;
    l.inner_rad = static_cast<float>(inner), l.outer_rad = static_cast<float>(outer);
    l.cos_inner = static_cast<float>(std::cos(inner)), l.cos_outer = static_cast<float>(std::cos(outer));
    return l;
}

LightSample<float> sample(const Light& l, Vec3f p, Vec2f u = {0.5f, 0.5f}) { return sample_light(&l, 1, 0.0f, p, u); }

TEST(DeltaLights, DirectionalIsParallelAndInfinitelyFar) {
    const Light sun = make(LightKind::directional);
    const LightSample<float> s = sample(sun, {5, 6, 7});
    EXPECT_EQ(s.direction.y, 1.0f);
    EXPECT_EQ(s.distance, 1e30f);
    EXPECT_EQ(s.radiance.z, 8.0f);
    EXPECT_EQ(s.pdf, 1.0f);
    EXPECT_TRUE(is_delta(sun));
}

TEST(DeltaLights, PointFallsWithTheSquareAndEndsAtItsRange) {
    Light l = make(LightKind::point);
    for (const float d : {0.5f, 1.0f, 2.0f, 4.0f})
        EXPECT_NEAR(sample(l, {0, -d, 0}).radiance.x, 2.0 / (d * d), 1e-6 / (d * d));
    l.range = 3.0f;
    for (const double d : {0.5, 1.0, 2.0, 2.9, 3.0, 5.0}) {
        const double window = std::max(std::min(1.0 - std::pow(d / 3.0, 4), 1.0), 0.0);
        EXPECT_NEAR(sample(l, {static_cast<float>(d), 0, 0}).radiance.y, 4.0 * window / (d * d), 2e-6 / (d * d)) << d;
    }
}

/// What a spot at the origin sends at an angle from its axis, as a share of its intensity.
double spot_share(const Light& l, double angle) {
    const Vec3f p{static_cast<float>(std::sin(angle)) * 2.0f, static_cast<float>(-std::cos(angle)) * 2.0f, 0.0f};
    return sample(l, p).radiance.x * 4.0 / 2.0;
}

TEST(DeltaLights, SpotFallOffsMatchTheirFormulas) {
    const double outer = 25.0 * M_PI / 180.0, inner = outer * 0.6;
    const double co = std::cos(outer), ci = std::cos(inner);
    for (double degrees = 0.0; degrees < 30.0; degrees += 1.0) {
        const double angle = degrees * M_PI / 180.0, c = std::cos(angle);
        const auto unit = [](double x) { return std::min(1.0, std::max(0.0, x)); };
        const double gltf = std::pow(unit((c - co) / (ci - co)), 2);
        const double linear = unit((outer - angle) / (outer - inner));
        const double t = unit((c - co) / ((1 - co) * 0.4));  // Blender: blend = 1 - inner / outer = 0.4
        // Cosines carry 1e-7, divided by the difference of two of them (0.04).
        EXPECT_NEAR(spot_share(spot(SpotFalloff::gltf, inner, outer), angle), gltf, 2e-5) << degrees;
        EXPECT_NEAR(spot_share(spot(SpotFalloff::linear, inner, outer), angle), linear, 2e-5) << degrees;
        EXPECT_NEAR(spot_share(spot(SpotFalloff::blender, inner, outer), angle), t * t * (3 - 2 * t), 2e-5) << degrees;
    }
}

TEST(DeltaLights, SpotWithOneConeIsAStep) {
    for (const SpotFalloff f : {SpotFalloff::gltf, SpotFalloff::linear, SpotFalloff::blender}) {
        const Light l = spot(f, 0.5, 0.5);
        EXPECT_NEAR(spot_share(l, 0.45), 1.0, 1e-5);
        EXPECT_EQ(spot_share(l, 0.55), 0.0);
    }
}

struct NamedLight {
    const char* name;
    Light light;
    Vec3f p;
};

/// Lights that a ray can meet, with a place to look from.
std::vector<NamedLight> solid_lights() {
    Light sun = make(LightKind::directional);
    sun.one_minus_cos = static_cast<float>(1 - std::cos(0.2));
    Light small_sun = make(LightKind::directional);
    small_sun.one_minus_cos = static_cast<float>(1 - std::cos(0.265 * M_PI / 180.0));
    small_sun.direction = normalize(Vec3f{1, -2, 0.5f});
    Light bulb = make(LightKind::point, 0.5f);
    Light lamp = spot(SpotFalloff::gltf, 0.4, 0.9);
    lamp.radius = 0.1f;
    Light panel = make(LightKind::area);
    panel.axis_u = {0.5f, 0, 0}, panel.axis_v = {0, 0, 0.25f};
    Light turned = panel;
    turned.direction = {0, -0.8f, 0.6f};
    turned.axis_v = {0, 0.15f, 0.2f};
    return {{"sun", sun, {0, 0, 0}},
            {"small sun", small_sun, {0, 0, 0}},
            {"bulb", bulb, {0.3f, -1.5f, 0.2f}},
            {"near bulb", bulb, {0, -0.51f, 0}},
            {"far bulb", bulb, {0, -60, 10}},
            {"spot", lamp, {0.2f, -2, 0.1f}},
            {"panel", panel, {0.1f, -1, 0.3f}},
            {"turned panel", turned, {0.4f, -0.7f, -0.1f}},
            {"far panel", panel, {3, -20, 1}}};
}

/// Bins over the cap that the light fills, seen from p.
SphereBins bins_for(const NamedLight& n) {
    Vec3f axis{0, 0, 0};
    Random random(1);
    for (int i = 0; i < 1000; ++i) axis = axis + sample(n.light, n.p, random.pair()).direction;
    axis = normalize(axis);
    float widest = 0.0f;
    for (int i = 0; i < 4000; ++i) {
        const Vec3f chord = sample(n.light, n.p, random.pair()).direction - axis;
        widest = std::max(widest, 0.25f * dot(chord, chord));
    }
    return {axis, 1, std::min(1.0, widest * 1.1), 16, 16, 64};
}

TEST(SolidLights, SamplesFollowTheDensityOfTheHit) {
    const auto lights = solid_lights();
    for (const NamedLight& n : lights) {
        EXPECT_FALSE(is_delta(n.light)) << n.name;
        expect_directions_follow(
            n.name, bins_for(n), 40000, static_cast<int>(lights.size()),
            [&](Random& random, Vec3f& d) {
                const LightSample<float> s = sample(n.light, n.p, random.pair());
                d = s.direction;
                return s.pdf > 0.0f;
            },
            [&](Vec3f d) { return intersect_light(&n.light, 1, 0.0f, n.p, d).pdf; });
    }
}

TEST(SolidLights, HitsAgreeWithSamples) {
    for (const NamedLight& n : solid_lights()) {
        Random random(8);
        int hits = 0;
        for (int i = 0; i < 2000; ++i) {
            const LightSample<float> s = sample(n.light, n.p, random.pair());
            const LightHit<float> h = intersect_light(&n.light, 1, 0.0f, n.p, s.direction);
            if (h.pdf == 0.0f) continue;  // samples at the very edge round to either side
            ++hits;
            ASSERT_NEAR(h.pdf, s.pdf, 1e-4 * s.pdf) << n.name;
            ASSERT_NEAR(h.radiance.y, s.radiance.y, 1e-4 * s.radiance.y) << n.name;
            if (s.distance == 1e30f) continue;
            ASSERT_NEAR(h.distance, s.distance, 1e-3 * s.distance) << n.name;  // at the rim of a sphere
        }
        EXPECT_GT(hits, 1960) << n.name;
    }
}

/// Irradiance of a surface facing `n`, by samples.
double irradiance(const Light& l, Vec3f p, Vec3f n, int side = 400) {
    double sum = 0.0;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const LightSample<float> s = sample(l, p, {(i + 0.5f) / side, (j + 0.5f) / side});
            if (s.pdf > 0.0f) sum += s.radiance.x * std::max(0.0f, dot(n, s.direction)) / s.pdf;
        }
    }
    return sum / side / side;
}

TEST(SolidLights, IlluminateAsTheirUnitsSay) {
    Light sun = make(LightKind::directional);
    for (const double radius : {0.0046, 0.1, 1.0}) {
        sun.one_minus_cos = static_cast<float>(1 - std::cos(radius));
        EXPECT_NEAR(irradiance(sun, {0, 0, 0}, kUp), 2.0, 2e-4) << radius;  // E lux, whatever the size
    }
    for (const double d : {1.0, 3.0, 100.0}) {
        const Light bulb = make(LightKind::point, 0.4f);
        EXPECT_NEAR(irradiance(bulb, {0, static_cast<float>(-d), 0}, kUp) * d * d, 2.0, 2e-3)
            << d;  // I / d^2 outside a sphere
    }
    Light panel = make(LightKind::area);
    panel.axis_u = {0.5f, 0, 0}, panel.axis_v = {0, 0, 0.25f};
    // Parallel rectangle above a point under its centre: 4 quarters a x b at height h (Howell, factor B-3).
    const double a = 0.5, b = 0.25, h = 0.7;
    const double x = a / h, y = b / h;
    const double quarter = (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                            y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y))) /
                           (2 * M_PI);
    EXPECT_NEAR(irradiance(panel, {0, -0.7f, 0}, kUp), 2.0 * M_PI * 4 * quarter, 1e-4);
}

TEST(SolidLights, ShineOnOneSideOnly) {
    Light panel = make(LightKind::area);
    EXPECT_EQ(sample(panel, {0, 1, 0}).pdf, 0.0f);
    EXPECT_EQ(max_component(sample(panel, {0, 1, 0}).radiance), 0.0f);
    EXPECT_EQ(intersect_light(&panel, 1, 0.0f, Vec3f{0, 1, 0}, Vec3f{0, -1, 0}).pdf, 0.0f);
    const Light bulb = make(LightKind::point, 0.5f);
    EXPECT_EQ(sample(bulb, {0.1f, 0, 0}).pdf, 0.0f);  // inside
    EXPECT_EQ(intersect_light(&bulb, 1, 0.0f, Vec3f{0.1f, 0, 0}, kUp).pdf, 0.0f);
}

TEST(LightWeight, IsPositiveWhereverLightArrives) {
    auto lights = solid_lights();
    lights.push_back({"point", make(LightKind::point), {}});
    lights.push_back({"delta spot", spot(SpotFalloff::linear, 0.4, 0.9), {}});
    lights.push_back({"parallel", make(LightKind::directional), {}});
    Random random(12);
    for (const NamedLight& n : lights) {
        int arrived = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3f p{random() * 6 - 3, random() * 6 - 3, random() * 6 - 3};
            const Vec3f normal = normalize(sample_cone(2.0f, random.pair()));
            const LightSample<float> s = sample(n.light, p, random.pair());
            const float contribution =
                s.pdf > 0.0f ? luminance(s.radiance) * std::max(0.0f, dot(normal, s.direction)) : 0.0f;
            const float weight = light_weight(&n.light, 1, 0.0f, p, normal);
            ASSERT_GE(weight, 0.0f) << n.name;
            ASSERT_TRUE(contribution == 0.0f || weight > 0.0f) << n.name;
            ASSERT_TRUE(!is_delta(n.light) || std::abs(weight - contribution) <= 1e-5f * contribution) << n.name;
            arrived += contribution > 0.0f;
        }
        EXPECT_GT(arrived, 50) << n.name;
    }
}

TEST(LightKeys, MoveOverTheShutter) {
    Light keys[3] = {make(LightKind::point), make(LightKind::point), make(LightKind::point)};
    keys[1].position = {1, 0, 0}, keys[2].position = {1, 2, 0};
    keys[2].radiance = {0, 0, 0};
    const auto at = [&](float time) { return light_at(keys, 3, time); };
    EXPECT_FLOAT_EQ(at(0.25f).position.x, 0.5f);
    EXPECT_FLOAT_EQ(at(0.75f).position.y, 1.0f);
    EXPECT_FLOAT_EQ(at(0.75f).radiance.y, 2.0f);
    EXPECT_FLOAT_EQ(at(1.0f).position.y, 2.0f);
    const LightSample<float> s = sample_light(keys, 3, 0.25f, Vec3f{0.5f, -2, 0}, Vec2f{0.5f, 0.5f});
    EXPECT_FLOAT_EQ(s.direction.y, 1.0f);
    EXPECT_FLOAT_EQ(s.distance, 2.0f);
}

TEST(LightExtremes, AreFinite) {
    for (const NamedLight& n : solid_lights()) {
        const LightSample<float> s = sample(n.light, n.light.position, {0.0f, kOneMinusEpsilon});
        EXPECT_TRUE(is_finite(s.radiance) && is_finite(s.pdf)) << n.name;
        EXPECT_TRUE(is_finite(light_weight(&n.light, 1, 0.0f, n.light.position, kUp))) << n.name;
    }
    const LightSample<float> s = sample(make(LightKind::point), {0, 0, 0});
    EXPECT_TRUE(is_finite(s.direction)) << "the point light's own place";
}

/// An image of random brightness with a black part and a bright spot, and its tables.
class Image {
public:
    Image(int width, int height, bool bright = true) : width_(width), height_(height), texels_(count(width, height)) {
        Random random(31);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const float black = x > width / 2 && y > height / 2 ? 0.0f : 1.0f;
                at(x, y) = {random() * black, random() * black, random() * black};
            }
        }
        if (bright) at(width / 3, height / 4) = {300, 200, 100};
        marginal_.resize(static_cast<std::size_t>(height) + 1);
        conditional_.resize(count(width + 1, height));
        build();
    }
    Vec3f& at(int x, int y) { return texels_[static_cast<std::size_t>(y) * width_ + x]; }
    float build() {
        return build_environment_tables(texels_.data(), width_, height_, marginal_.data(), conditional_.data());
    }
    EnvironmentMap map(float rotate = 0.0f) const {
        return {texels_.data(), width_, height_, marginal_.data(), conditional_.data(), rotate, {1, 1, 1}, 1.0f};
    }

private:
    static std::size_t count(int a, int b) { return static_cast<std::size_t>(a) * static_cast<std::size_t>(b); }
    int width_, height_;
    std::vector<Vec3f> texels_;
    std::vector<float> marginal_, conditional_;
};

TEST(Environment, DirectionsMapAsDocumented) {
    const EnvironmentMap map = Image(8, 4).map();
    EXPECT_NEAR(environment_uv(map, Vec3f{0, 0, -1}).x, 0.5f, 1e-6);
    EXPECT_NEAR(environment_uv(map, Vec3f{1, 0, 0}).x, 0.75f, 1e-6);
    EXPECT_NEAR(environment_uv(map, Vec3f{-1, 0, 0}).x, 0.25f, 1e-6);
    EXPECT_NEAR(environment_uv(map, Vec3f{0, 1, 0}).y, 0.0f, 1e-6);
    EXPECT_NEAR(environment_uv(map, Vec3f{0, -1, 0}).y, 1.0f, 1e-6);
    // Turned counter-clockwise about +y by 90 degrees, the centre of the image is seen along -x.
    EXPECT_NEAR(environment_uv(Image(8, 4).map(static_cast<float>(M_PI / 2)), Vec3f{-1, 0, 0}).x, 0.5f, 1e-6);
}

TEST(Environment, SamplesFollowTheDensity) {
    constexpr int kCount = 100000;
    for (const int height : {1, 2, 8, 16}) {
        for (const float rotate : {0.0f, 2.0f, -9.0f}) {
            const int width = 2 * height;
            Image image(width, height);
            const EnvironmentMap map = image.map(rotate), upright = image.map();
            // Two bins a texel; the density in image coordinates is that per steradian times 2 pi^2 sin.
            const int columns = 2 * width, rows = 2 * height;
            std::vector<double> expected(static_cast<std::size_t>(columns) * rows), counts(expected.size(), 0.0);
            double total = 0.0;
            for (int i = 0; i < rows; ++i) {
                for (int j = 0; j < columns; ++j) {
                    const double theta = M_PI * (i + 0.5) / rows, phi = 2.0 * M_PI * ((j + 0.5) / columns - 0.5);
                    const Vec3f d{static_cast<float>(std::sin(theta) * std::sin(phi)),
                                  static_cast<float>(std::cos(theta)),
                                  static_cast<float>(-std::sin(theta) * std::cos(phi))};
                    const double p =
                        environment_pdf(upright, d) * 2.0 * M_PI * M_PI * std::sin(theta) / (rows * columns);
                    total += p;
                    expected[static_cast<std::size_t>(i) * columns + j] = p * kCount;
                }
            }
            EXPECT_NEAR(total, 1.0, 1e-4);
            Random random(2);
            for (int n = 0; n < kCount; ++n) {
                Vec3f direction, radiance;
                float pdf;
                sample_environment(map, random.pair(), direction, radiance, pdf);
                const Vec2f uv = environment_uv(map, direction);
                const int i = std::min(rows - 1, static_cast<int>(uv.y * rows)),
                          j = std::min(columns - 1, static_cast<int>(uv.x * columns));
                ++counts[static_cast<std::size_t>(i) * columns + j];
                ASSERT_NEAR(length(direction), 1.0f, 1e-6);
            }
            EXPECT_GT(chi2_p_value(counts, expected), sidak(12)) << height << " rows, turned by " << rotate;
        }
    }
}

TEST(Environment, SamplesCarryTheirOwnRadianceAndDensity) {
    Image image(32, 16, false);
    const EnvironmentMap map = image.map(0.8f);
    Random random(5);
    int differing = 0;
    for (int i = 0; i < 5000; ++i) {
        Vec3f direction, radiance;
        float pdf;
        sample_environment(map, random.pair(), direction, radiance, pdf);
        ASSERT_GT(pdf, 0.0f);
        const Vec3f again = environment_radiance(map, direction);
        ASSERT_NEAR(radiance.x, again.x, 2e-4);  // image coordinates carry 4e-7 turns, 32 texels, slope 1 a texel
        differing += std::abs(environment_pdf(map, direction) - pdf) > 1e-3f * pdf;
    }
    EXPECT_LT(differing, 10) << "only samples at a texel's very edge may land beside it";
}

TEST(Environment, DensityIsPositiveWhereLightIs) {
    Image image(16, 8);
    const EnvironmentMap map = image.map();
    Random random(6);
    int dark = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f d = normalize(sample_cone(2.0f, random.pair()));
        const Vec3f radiance = environment_radiance(map, d);
        dark += max_component(radiance) == 0.0f;
        ASSERT_TRUE(max_component(radiance) == 0.0f || environment_pdf(map, d) > 0.0f);
    }
    EXPECT_GT(dark, 500);
}

TEST(Environment, IntegratesToItsMeanLuminance) {
    Image image(64, 32);
    const float mean = image.build();
    const EnvironmentMap map = image.map(1.0f);
    double sum = 0.0;
    constexpr int kSide = 400;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            Vec3f direction, radiance;
            float pdf;
            sample_environment(map, Vec2f{(i + 0.5f) / kSide, (j + 0.5f) / kSide}, direction, radiance, pdf);
            sum += luminance(radiance) / pdf;
        }
    }
    EXPECT_NEAR(sum / (kSide * kSide) / (4.0 * M_PI), mean,
                0.02 * mean);  // the sine over a row: midpoint against integral
}

TEST(Environment, BlackAndConstantImagesHaveTables) {
    for (const float value : {0.0f, 1.0f}) {
        Image image(4, 2);
        for (int y = 0; y < 2; ++y) {
            for (int x = 0; x < 4; ++x) image.at(x, y) = {value, value, value};
        }
        EXPECT_NEAR(image.build(), value, 1e-6);
        Vec3f direction, radiance;
        float pdf;
        sample_environment(image.map(), Vec2f{0.3f, 0.6f}, direction, radiance, pdf);
        EXPECT_TRUE(is_finite(pdf) && pdf > 0.0f);
        EXPECT_NEAR(radiance.x, value, 1e-6);
    }
}

}  // namespace
}  // namespace kadr::kernels
