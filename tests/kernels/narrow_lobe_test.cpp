// Lobes narrower than kMinAlpha, down to the delta: against quadrature, against double, and across the cut.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "kernels/bsdf/bsdf.h"
#include "kernels/statistics.h"

namespace kadr::kernels {
namespace {

constexpr float kNarrow[] = {0.0f, 0.001f, 0.0033f, 0.005f, 0.01f, 0.02f, 0.0315f};  // roughness
/// The last is 1e-6 rad above the horizon.
constexpr float kCosines[] = {1.0f, 0.9f, 0.5f, 0.1f, 0.03f, 0.01f, 1e-3f, 1e-4f, 1e-6f};

template <class F>
Vec3<F> viewer(F cos_o) {
    return {std::sqrt((F(1) - cos_o) * (F(1) + cos_o)), F(0), cos_o};
}
Vec3<double> in_double(Vec3f v) { return splat<double>(v); }

template <class F>
Bsdf<F> metal(float roughness, F cos_o) {
    return make_bsdf<requirement::kMirrors>(Vec3<F>{F(0.9f), F(0.6f), F(0.3f)}, F(1), F(roughness), cos_o);
}

/// Mean weight of the lobe's samples, and of the base's, over a grid (see bsdf_test.cpp).
double albedo(const Bsdf<float>& b, Vec3f wo, int n = 96) {
    double sum = 0;
    for (int lobe = 0; lobe < 2; ++lobe) {
        const double share = lobe == 0 ? b.specular_probability : 1 - b.specular_probability;
        if (share == 0) continue;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const double t = (j + 0.5) / n, v = t * t * (3 - 2 * t), dv = 6 * t * (1 - t);
                const float u_lobe = lobe == 0 ? 0.0f : kOneMinusEpsilon;
                sum += share * dv *
                       sample_bsdf<requirement::kMirrors>(b, wo, Vec2f{(i + 0.5f) / n, static_cast<float>(v)}, u_lobe).weight.x;
            }
    }
    return sum / n / n;
}

TEST(NarrowLobe, WhiteFurnaceIsOne) {
    for (const float f0 : {0.0f, kDielectricF0, 0.444f, 1.0f})
        for (const float metallic : {0.0f, 0.4f, 1.0f})
            for (const float roughness : kNarrow)
                for (const float cos_o : {1.0f, 0.5f, 0.1f, 0.01f, 1e-3f}) {
                    const Bsdf<float> b = make_bsdf<requirement::kMirrors>(Vec3f{1, 1, 1}, metallic, roughness, cos_o, f0);
                    // The table's error, as for wider lobes.
                    EXPECT_NEAR(albedo(b, viewer(cos_o)), 1, 0.003)
                        << "f0 " << f0 << ", metallic " << metallic << ", roughness " << roughness << ", cos " << cos_o;
                }
}

TEST(NarrowLobe, WiderDielectricsOfEveryIndexAreWhiteToo) {
    for (const float f0 : {0.0f, 2.5e-9f, 0.444f, 1.0f})  // indices 1, 1.0001, 5, infinite
        for (const float roughness : {0.1f, 0.4f, 1.0f})
            for (const float cos_o : {1.0f, 0.5f, 0.1f, 0.01f})
                EXPECT_NEAR(albedo(make_bsdf(Vec3f{1, 1, 1}, 0.0f, roughness, cos_o, f0), viewer(cos_o)), 1, 0.003)
                    << "f0 " << f0 << ", roughness " << roughness << ", cos " << cos_o;
}

TEST(NarrowLobe, ADeltaReflectsItsFresnelTerm) {
    for (const float f0 : {0.0f, kDielectricF0, 0.444f, 1.0f})
        for (const float cos_o : kCosines) {
            const Bsdf<float> b = make_bsdf<requirement::kMirrors>(Vec3f{0, 0, 0}, 0.0f, 0.0f, cos_o, f0);
            const Vec3f wo = viewer(cos_o);
            const BsdfSample<float> s = sample_bsdf<requirement::kMirrors>(b, wo, Vec2f{0.3f, 0.8f}, 0.0f);
            const double fresnel = f0 + (1.0 - f0) * std::pow(1.0 - cos_o, 5);
            EXPECT_EQ(b.specular_probability, 1.0f);
            EXPECT_NEAR(s.weight.x, fresnel, 4e-7 * (0.1 + fresnel)) << f0 << ' ' << cos_o;  // a few roundings
            EXPECT_EQ(s.pdf, 0.0f);
            EXPECT_TRUE(s.glossy);
            EXPECT_TRUE(s.wi.x == -wo.x && s.wi.y == -wo.y && s.wi.z == wo.z);
        }
}

TEST(NarrowLobe, ADeltaLeavesTheBaseToLightSampling) {
    Random random(3);
    const Bsdf<float> b = make_bsdf<requirement::kMirrors>(Vec3f{0.8f, 0.5f, 0.2f}, 0.0f, 0.0f, 0.7f);
    const Vec3f wo = viewer(0.7f);
    EXPECT_EQ(b.alpha, 0.0f);
    for (int i = 0; i < 1000; ++i) {
        const BsdfSample<float> s = sample_bsdf<requirement::kMirrors>(b, wo, random.pair(), kOneMinusEpsilon);
        EXPECT_NEAR(s.pdf, kInvPi * s.wi.z * (1 - b.specular_probability), 1e-6);
        EXPECT_NEAR(s.weight.x, b.diffuse.x / (1 - b.specular_probability), 1e-6);
    }
    const BsdfValue<float> mirrored = evaluate_bsdf<requirement::kMirrors>(b, wo, Vec3f{-wo.x, 0, wo.z});
    EXPECT_NEAR(mirrored.f_cos.x, b.diffuse.x * kInvPi * wo.z, 1e-6);
}

/// What a table of another shape would show: a step where the lobe becomes a delta.
TEST(NarrowLobe, AlbedosGoOverIntoThoseOfTheDelta) {
    for (const float cos_o : {1.0f, 0.5f, 0.1f, 0.01f, 1e-3f}) {
        const float cut = std::sqrt(kDeltaAlpha);
        const Bsdf<float> below = metal(cut * 0.999f, cos_o), above = metal(cut * 1.001f, cos_o);
        EXPECT_EQ(below.alpha, 0.0f);
        EXPECT_GT(above.alpha, 0.0f);
        // Masking of alpha 1e-5 under a cosine of 1e-3: 2e-5 and less.
        EXPECT_NEAR(above.specular_scale.x, below.specular_scale.x, 1e-4) << cos_o;
        const Bsdf<float> first = metal(std::sqrt(kMinAlpha) * 0.9999f, cos_o),
                          row = metal(std::sqrt(kMinAlpha) * 1.0001f, cos_o);
        EXPECT_NEAR(first.specular_scale.x, row.specular_scale.x, 1e-3) << cos_o;  // the row is interpolated
    }
}

TEST(NarrowLobe, WiderLobesKeepEveryBit) {
    Random random(8);
    for (int i = 0; i < 20000; ++i) {
        const float cos_o = i % 7 == 0 ? 1e-3f * random() + 1e-6f : 0.001f + 0.999f * random();
        const Vec3f color{random(), random(), random()};
        const float metallic = i % 3 == 0 ? 0.0f : random(), roughness = 0.03163f + 0.96837f * random();
        const Bsdf<float> a = make_bsdf(color, metallic, roughness, cos_o),
                          b = make_bsdf<requirement::kMirrors>(color, metallic, roughness, cos_o);
        ASSERT_EQ(std::memcmp(&a, &b, sizeof a), 0);
        const Vec3f wo = viewer(cos_o);
        const Vec2f u = random.pair();
        const float u_lobe = random();
        const BsdfSample<float> s = sample_bsdf(a, wo, u, u_lobe), t = sample_bsdf<requirement::kMirrors>(b, wo, u, u_lobe);
        ASSERT_TRUE(std::memcmp(&s.wi, &t.wi, sizeof s.wi) == 0 &&
                    std::memcmp(&s.weight, &t.weight, sizeof s.weight) == 0 && s.pdf == t.pdf && s.glossy == t.glossy);
    }
}

/// Directions of light within and beside a lobe: slopes of the half vector from 0 to 1000 alpha.
template <class Visit>
void for_directions_of(float alpha, Vec3f wo, Visit visit) {
    const Vec3<double> o = in_double(wo);
    for (const double slopes : {0.0, 0.3, 1.0, 3.0, 30.0, 1000.0})
        for (const double turn : {0.0, 0.13, 0.25, 0.37, 0.5}) {
            const double t = slopes * alpha;
            const Vec3<double> h =
                normalize(Vec3<double>{t * std::cos(2 * M_PI * turn), t * std::sin(2 * M_PI * turn), 1.0});
            const Vec3<double> wi = h * (2 * dot(h, o)) - o;
            if (wi.z > 0) visit(Vec3f{static_cast<float>(wi.x), static_cast<float>(wi.y), static_cast<float>(wi.z)});
        }
}

/// The same floats go into both: what is compared is the arithmetic, not how finely a float tells directions apart.
TEST(NarrowLobe, ValuesAndDensitiesAreThoseOfDouble) {
    double worst = 0;
    int compared = 0;
    for (const float roughness : {0.0033f, 0.005f, 0.01f, 0.02f, 0.0315f, 0.1f, 0.5f})
        for (const float cos_o : kCosines) {
            const Vec3f wo = viewer(cos_o);
            const Bsdf<float> b = metal<float>(roughness, cos_o);
            Bsdf<double> exact = metal<double>(roughness, cos_o);
            exact.specular_scale = in_double(b.specular_scale);  // the tables have a test of their own
            for_directions_of(b.alpha, wo, [&](Vec3f wi) {
                const BsdfValue<float> is = evaluate_bsdf<requirement::kMirrors>(b, wo, wi);
                const BsdfValue<double> wanted = evaluate_bsdf<requirement::kMirrors>(exact, in_double(wo), in_double(wi));
                ASSERT_GT(wanted.pdf, 0);
                worst = std::max({worst, std::abs(is.pdf / wanted.pdf - 1), std::abs(is.f_cos.x / wanted.f_cos.x - 1)});
                ++compared;
            });
        }
    EXPECT_GT(compared, 1000);
    // 2^-24 from each of some twenty roundings, doubled where t is squared.
    EXPECT_LT(worst, 40 * 0x1p-24);
    RecordProperty("worst", std::to_string(worst));
}

TEST(NarrowLobe, SamplesAreThoseOfDouble) {
    double direction = 0, weight = 0;
    for (const float roughness : kNarrow)
        for (const float cos_o : kCosines) {
            const Vec3f wo = viewer(cos_o);
            const Bsdf<float> b = metal<float>(roughness, cos_o);
            Bsdf<double> exact = metal<double>(roughness, cos_o);
            exact.specular_scale = in_double(b.specular_scale);
            for (int i = 0; i < 8; ++i)
                for (int j = 0; j < 8; ++j) {
                    const Vec2f u{(i + 0.5f) / 8, (j + 0.5f) / 8};
                    const BsdfSample<float> is = sample_bsdf<requirement::kMirrors>(b, wo, u, 0.0f);
                    const BsdfSample<double> wanted =
                        sample_bsdf<requirement::kMirrors>(exact, in_double(wo), Vec2<double>{u.x, u.y}, 0.0);
                    const Vec3<double> off = in_double(is.wi) - wanted.wi;
                    direction = std::max(direction, length(off));
                    if (wanted.weight.x > 0) weight = std::max(weight, std::abs(is.weight.x / wanted.weight.x - 1));
                }
        }
    EXPECT_LT(direction, 5e-7);  // radians: the sine's 4e-7 of a narrow lobe, and a rounding of each product
    EXPECT_LT(weight, 2e-5);     // masking, under cosines that cancelled
}

TEST(NarrowLobe, SamplesFollowTheDensity) {
    constexpr float kRoughness[] = {0.0033f, 0.01f, 0.025f};
    constexpr float kViews[] = {0.3f, 0.95f};
    for (const float roughness : kRoughness)
        for (const float cos_o : kViews) {
            const Vec3<double> wo = viewer<double>(cos_o);
            const Bsdf<double> b = metal<double>(roughness, cos_o);
            Random random(5);
            // By the radius in slopes: half within alpha, P(slope < s) = s^2 / (s^2 + alpha^2) seen straight on.
            int within = 0;
            constexpr int kSamples = 20000;
            double density = 0;
            for (int i = 0; i < kSamples; ++i) {
                const Vec2f u = random.pair();
                const BsdfSample<double> s = sample_bsdf<requirement::kMirrors>(b, wo, Vec2<double>{u.x, u.y}, 0.0);
                const Vec3<double> h = normalize(wo + s.wi);
                within += std::hypot(h.x, h.y) / h.z < b.alpha;
                density += 1 / (s.pdf * b.alpha * b.alpha) * (std::hypot(h.x, h.y) / h.z < b.alpha);
            }
            // 4 sigma of a fair coin, and what masking shifts at these angles.
            EXPECT_NEAR(within / static_cast<double>(kSamples), 0.5, 4 * 0.5 / std::sqrt(kSamples) + 1e-3)
                << roughness << ' ' << cos_o;
            // E[1 / pdf over a region] is its solid angle: slopes below alpha are pi alpha^2 of half vectors, times 4
            // h.o.
            EXPECT_NEAR(density / kSamples, M_PI * 4 * cos_o, 0.04 * M_PI * 4 * cos_o) << roughness << ' ' << cos_o;
        }
}

}  // namespace
}  // namespace kadr::kernels
