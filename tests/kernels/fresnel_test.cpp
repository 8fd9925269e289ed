// Dielectrics by Fresnel's equations: against Snell's law in double, against quadrature, and beside Schlick's term.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "kernels/bsdf/analytic.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/statistics.h"

namespace kadr::kernels {
namespace {

constexpr unsigned kExact = requirement::kFresnel, kExactMirrors = requirement::kFresnel | requirement::kMirrors;
constexpr double kIndices[] = {1.0, 1.0001, 1.33, 1.5, 2.42, 5.0};

double f0_of(double index) { return std::pow((index - 1) / (index + 1), 2); }
Vec3f viewer(float cos_o) { return {std::sqrt((1.0f - cos_o) * (1.0f + cos_o)), 0.0f, cos_o}; }

/// By Snell's law and the amplitudes of both polarisations.
double textbook(double x, double index) {
    const double sin_t = std::sqrt(1 - x * x) / index, cos_t = std::sqrt(1 - sin_t * sin_t);
    const double s = (x - index * cos_t) / (x + index * cos_t), p = (index * x - cos_t) / (index * x + cos_t);
    return (s * s + p * p) / 2;
}

TEST(Fresnel, IsThatOfSnellsLaw) {
    for (const double index : kIndices)
        for (int i = 1; i <= 1000; ++i) {
            const double x = i / 1000.0, expected = textbook(x, index);
            EXPECT_NEAR(dielectric_fresnel(x, std::sqrt(f0_of(index))), expected, 1e-12) << index << ' ' << x;
            // In float the root of f0 is known to 3e-8 of itself, and F is steepest where light grazes: F' = 4 / sqrt(n^2 - 1).
            const auto root = static_cast<float>(std::sqrt(f0_of(index)));
            EXPECT_NEAR(dielectric_fresnel(static_cast<float>(x), root), expected, 3e-6 * expected + 1e-7) << index << ' ' << x;
        }
}

TEST(Fresnel, HoldsAtBothEndsOfTheIndexAndTheAngle) {
    for (const float x : {1e-6f, 0.1f, 1.0f}) {
        EXPECT_EQ(dielectric_fresnel(x, 0.0f), 0.0f);  // index 1: there is no surface
        EXPECT_NEAR(dielectric_fresnel(x, 1.0f), 1.0f, 1e-6f);
    }
    for (const double index : kIndices) EXPECT_TRUE(is_finite(dielectric_fresnel(0.0f, static_cast<float>(std::sqrt(f0_of(index))))));
    for (const double index : {1.33, 1.5, 2.42}) EXPECT_NEAR(dielectric_fresnel(0.0, std::sqrt(f0_of(index))), 1, 1e-12);
}

/// Mean weight of the lobe's samples and of the base's over a grid (see bsdf_test.cpp).
double albedo(const Bsdf<float>& b, Vec3f wo, int n = 96) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double t = (j + 0.5) / n, v = t * t * (3 - 2 * t), dv = 6 * t * (1 - t);
            const Vec2f u{(i + 0.5f) / n, static_cast<float>(v)};
            const double p = b.specular_probability;
            sum += dv * p * sample_bsdf<kExactMirrors>(b, wo, u, 0.0f).weight.x;
            if (p < 1) sum += dv * (1 - p) * sample_bsdf<kExactMirrors>(b, wo, u, kOneMinusEpsilon).weight.x;
        }
    return sum / n / n;
}

TEST(Fresnel, WhiteFurnaceIsOne) {
    double worst = 0;
    for (const double index : kIndices)
        for (const float metallic : {0.0f, 0.4f})
            for (const float roughness : {0.0f, 0.01f, 0.04f, 0.13f, 0.25f, 0.5f, 1.0f})
                for (const float cos_o : {0.003f, 0.02f, 0.07f, 0.2f, 0.45f, 0.7f, 1.0f}) {
                    const Bsdf<float> b =
                        make_bsdf<kExactMirrors>(Vec3f{1, 1, 1}, metallic, roughness, cos_o, static_cast<float>(f0_of(index)), true);
                    const double a = albedo(b, viewer(cos_o));
                    worst = std::max(worst, std::abs(a - 1));
                    // The error of the albedo tables is 0.003; that of the table of the excess 0.003, and 0.01 for indices near 1.
                    EXPECT_NEAR(a, 1, index < 1.07 ? 0.013 : 0.006) << "index " << index << ", metallic " << metallic << ", roughness " << roughness << ", cos " << cos_o;
                }
    RecordProperty("worst", std::to_string(worst));
}

TEST(Fresnel, ReflectsNothingWhereThereIsNoSurface) {
    for (const float roughness : {0.0f, 0.1f, 1.0f}) {
        const Bsdf<float> b = make_bsdf<kExactMirrors>(Vec3f{0.5f, 0.5f, 0.5f}, 0.0f, roughness, 0.1f, 0.0f, true);
        const BsdfSample<float> s = sample_bsdf<kExactMirrors>(b, viewer(0.1f), Vec2f{0.3f, 0.8f}, 0.0f);
        // What is left is the base that is met in the lobe's direction, weighed by both ways to draw it.
        EXPECT_LT(s.weight.x, roughness == 0 ? 1e-6f : 0.6f) << roughness;
        EXPECT_NEAR(albedo(b, viewer(0.1f)), 0.5, 0.013);
    }
    const Bsdf<float> schlick = make_bsdf<kExactMirrors>(Vec3f{0.5f, 0.5f, 0.5f}, 0.0f, 0.1f, 0.1f, 0.0f, false);
    EXPECT_GT(albedo(schlick, viewer(0.1f)), 0.7);
}

TEST(Fresnel, IsSchlicksToTheLastBitWhereNobodyAsks) {
    Random random(3);
    const auto bits_of = [](const auto& value) {
        std::vector<unsigned char> bytes(sizeof value);
        std::memcpy(bytes.data(), &value, sizeof value);
        return bytes;
    };
    for (int trial = 0; trial < 2000; ++trial) {
        const Vec3f color{random(), random(), random()};
        const float metallic = trial % 3 == 0 ? 0 : random(), roughness = random(), cos_o = 0.001f + 0.999f * random(), f0 = random();
        const Bsdf<float> a = make_bsdf(color, metallic, roughness, cos_o, f0), b = make_bsdf<kExact>(color, metallic, roughness, cos_o, f0, false);
        ASSERT_EQ(bits_of(a), bits_of(b));
        const Vec3f wi = normalize(sample_cone(1.0f, random.pair()));
        ASSERT_EQ(bits_of(evaluate_bsdf(a, viewer(cos_o), wi)), bits_of(evaluate_bsdf<kExact>(b, viewer(cos_o), wi)));
    }
}

TEST(Fresnel, LeavesMetalsAlone) {
    Random random(4);
    for (int trial = 0; trial < 2000; ++trial) {
        const Vec3f color{random(), random(), random()};
        const float roughness = 0.05f + 0.95f * random(), cos_o = 0.001f + 0.999f * random();
        const Bsdf<float> a = make_bsdf(color, 1.0f, roughness, cos_o), b = make_bsdf<kExact>(color, 1.0f, roughness, cos_o, kDielectricF0, true);
        const Vec3f wi = normalize(sample_cone(1.0f, random.pair()));
        const Vec3f is = evaluate_bsdf<kExact>(b, viewer(cos_o), wi).f_cos, was = evaluate_bsdf(a, viewer(cos_o), wi).f_cos;
        // What a lerp to 1 rounds away of the dielectric.
        ASSERT_NEAR(is.x, was.x, 1e-6f * was.x + 1e-7f);
        ASSERT_NEAR(is.y, was.y, 1e-6f * was.y + 1e-7f);
    }
}

TEST(Fresnel, InFloatIsThatInDouble) {
    Random random(5);
    for (int trial = 0; trial < 20000; ++trial) {
        const float metallic = trial % 2 == 0 ? 0.0f : 0.5f * random(), roughness = 0.1f + 0.9f * random(), cos_o = 0.01f + 0.99f * random();
        const auto f0 = static_cast<float>(f0_of(1.01 + 3.0 * random()));
        const Bsdf<float> b = make_bsdf<kExact>(Vec3f{0.8f, 0.5f, 0.3f}, metallic, roughness, cos_o, f0, true);
        Bsdf<double> exact{splat<double>(b.f0), splat<double>(b.diffuse), splat<double>(b.specular_scale), b.alpha, b.specular_probability,
                           1.0 - metallic, std::sqrt(static_cast<double>(f0))};
        const Vec3f wi = normalize(sample_cone(1.0f, random.pair()));
        const double is = evaluate_bsdf<kExact>(b, viewer(cos_o), wi).f_cos.y;
        const double wanted = evaluate_bsdf<kExact>(exact, splat<double>(viewer(cos_o)), splat<double>(wi)).f_cos.y;
        // As many roundings as without (NarrowLobe, 1e-6), and one difference of terms below 1.
        ASSERT_NEAR(is, wanted, 3e-6 * (wanted + 1)) << roughness << ' ' << cos_o << ' ' << f0;
    }
}

TEST(Fresnel, AnalyticModelTakesItToo) {
    const Vec3f n{0, 0, 1}, wo = viewer(0.3f), wi{-wo.x, 0, wo.z};  // h is n
    for (const double index : kIndices) {
        const auto f0 = static_cast<float>(f0_of(index));
        const Vec3f f = analytic_brdf<kExact>(Vec3f{0.5f, 0.5f, 0.5f}, 0.0f, 0.5f, f0, n, wo, wi, true);
        const double alpha = 0.25, k = alpha / 2, fresnel = textbook(0.3f, index), g1 = 0.3f / (0.3f * (1 - k) + k);
        const double expected = (1 - fresnel) * 0.5 / M_PI + g1 * g1 * fresnel / (M_PI * alpha * alpha) / (4 * 0.3f * 0.3f);
        EXPECT_NEAR(f.x, expected, 1e-5 * expected) << index;
    }
}

}  // namespace
}  // namespace kadr::kernels
