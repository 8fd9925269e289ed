#include <gtest/gtest.h>

#include <cmath>

#include "kernels/bsdf/analytic.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/statistics.h"

namespace kadr::kernels {
namespace {

Vec3f viewer(float cos_o) { return {std::sqrt(std::max(0.0f, 1.0f - cos_o * cos_o)), 0.0f, cos_o}; }

/// Mean weight of a lobe's samples over a grid on the unit square.
Vec3f mean_weight(const Bsdf<float>& b, Vec3f wo, float u_lobe, int n) {
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            // Smoothstep: most points at the ends of the second number, where the lobe meets the horizon.
            const double t = (j + 0.5) / n, v = t * t * (3 - 2 * t), dv = 6 * t * (1 - t);
            const BsdfSample<float> s = sample_bsdf(b, wo, Vec2f{(i + 0.5f) / n, static_cast<float>(v)}, u_lobe);
            sum[0] += s.weight.x * dv, sum[1] += s.weight.y * dv, sum[2] += s.weight.z * dv;
        }
    }
    return {static_cast<float>(sum[0] / n / n), static_cast<float>(sum[1] / n / n), static_cast<float>(sum[2] / n / n)};
}

/// Directional albedo: both lobes by quadrature.
Vec3f albedo(const Bsdf<float>& b, Vec3f wo, int n = 96) {
    const float p = b.specular_probability;
    Vec3f result = mean_weight(b, wo, 0.0f, n) * p;
    if (p < 1.0f) result = result + mean_weight(b, wo, kOneMinusEpsilon, n) * (1.0f - p);
    return result;
}

TEST(Bsdf, WhiteFurnaceIsOne) {
    double worst = 0.0;
    for (const float metallic : {0.0f, 0.3f, 0.7f, 1.0f}) {
        for (const float roughness : {0.0f, 0.05f, 0.13f, 0.25f, 0.4f, 0.6f, 0.85f, 1.0f}) {
            for (const float cos_o : {0.003f, 0.02f, 0.07f, 0.2f, 0.45f, 0.7f, 0.9f, 1.0f}) {
                const Bsdf<float> b = make_bsdf(Vec3f{1, 1, 1}, metallic, roughness, cos_o);
                const float a = albedo(b, viewer(cos_o)).x;
                worst = std::max(worst, std::abs(a - 1.0));
                EXPECT_NEAR(a, 1.0f, 0.003f)
                    << "metallic " << metallic << " roughness " << roughness << " cos " << cos_o;
            }
        }
    }
    RecordProperty("worst", std::to_string(worst));
}

TEST(Bsdf, NothingReflectsMoreThanAll) {
    for (const float metallic : {0.0f, 0.5f, 1.0f}) {
        for (const float roughness : {0.1f, 0.5f, 1.0f}) {
            const Vec3f a = albedo(make_bsdf(Vec3f{0.9f, 0.5f, 0.0f}, metallic, roughness, 0.6f), viewer(0.6f), 64);
            EXPECT_LE(a.x, 1.003f);
            EXPECT_GT(a.x, a.y);
            EXPECT_GT(a.y, a.z);
            EXPECT_GT(a.z, 0.0f);
        }
    }
}

TEST(Bsdf, SmoothBlackDielectricReflectsItsFresnelTerm) {
    const Bsdf<float> b = make_bsdf(Vec3f{0, 0, 0}, 0.0f, 0.02f, 1.0f);
    EXPECT_NEAR(albedo(b, viewer(1.0f)).x, 0.04f, 2e-4f);  // table accuracy of a lobe with next to no losses
}

TEST(Bsdf, SingleScatteringLosesWhatIsKnown) {
    // White metal, normal incidence: Cycles' single-scatter GGX loses 8.4 % at roughness 0.5 and 69 % at 1.
    const Vec3f half = make_bsdf(Vec3f{1, 1, 1}, 1.0f, 0.5f, 1.0f).specular_scale;
    const Vec3f full = make_bsdf(Vec3f{1, 1, 1}, 1.0f, 1.0f, 1.0f).specular_scale;
    EXPECT_NEAR(1.0f - 1.0f / half.x, 0.084f, 0.002f);
    EXPECT_NEAR(1.0f - 1.0f / full.x, 0.69f, 0.005f);
}

TEST(Bsdf, SamplesFollowTheDensity) {
    const float kRoughness[] = {0.0316f, 0.1f, 0.3f, 0.6f, 1.0f};
    const float kCosines[] = {0.05f, 0.4f, 0.95f};
    constexpr int kTests = 5 * 3 * 3;
    for (const float roughness : kRoughness) {
        for (const float cos_o : kCosines) {
            const Vec3f wo = viewer(cos_o);
            for (const int lobe : {0, 1, 2}) {  // the lobe alone, the base alone, both
                Bsdf<float> b = make_bsdf(Vec3f{0.8f, 0.8f, 0.8f}, 0.2f, roughness, cos_o);
                if (lobe == 0) b.specular_probability = 1.0f;
                if (lobe == 1) b.specular_probability = 0.0f;
                // Around the mirror direction, dense there: narrow lobes fill several rings.
                const SphereBins bins{{-wo.x, 0.0f, wo.z}, 4, 1.0, 40, 16, 16};
                expect_directions_follow(
                    "roughness " + std::to_string(roughness) + " cos " + std::to_string(cos_o) + " lobe " +
                        std::to_string(lobe),
                    bins, 60000, kTests,
                    [&](Random& random, Vec3f& d) {
                        const Vec2f u = random.pair();
                        const BsdfSample<float> s = sample_bsdf(b, wo, u, random());
                        d = s.wi;
                        return s.pdf > 0.0f;
                    },
                    [&](Vec3f d) { return evaluate_bsdf(b, wo, d).pdf; });
            }
        }
    }
}

TEST(Bsdf, WeightIsValueOverDensity) {
    Random random(4);
    for (int i = 0; i < 5000; ++i) {
        const float cos_o = 0.01f + 0.99f * random();
        const Bsdf<float> b = make_bsdf(Vec3f{random(), random(), random()}, random(), random(), cos_o);
        const Vec3f wo = viewer(cos_o);
        const Vec2f u = random.pair();
        const BsdfSample<float> s = sample_bsdf(b, wo, u, random());
        const BsdfValue<float> value = evaluate_bsdf(b, wo, s.wi);
        ASSERT_EQ(s.pdf, value.pdf);
        if (s.pdf == 0.0f) {
            ASSERT_EQ(max_component(s.weight), 0.0f);
            continue;
        }
        ASSERT_NEAR(s.weight.y * s.pdf, value.f_cos.y, 1e-5f * value.f_cos.y);
        ASSERT_NEAR(length(s.wi), 1.0f, 1e-6f);
        ASSERT_TRUE(is_finite(s.weight));
    }
}

TEST(Bsdf, NoLightFromBelowTheHorizon) {
    const Bsdf<float> b = make_bsdf(Vec3f{1, 1, 1}, 0.5f, 0.5f, 0.5f);
    for (const float z : {0.0f, -0.01f, -1.0f}) {
        const BsdfValue<float> v = evaluate_bsdf(b, viewer(0.5f), Vec3f{std::sqrt(1.0f - z * z), 0.0f, z});
        EXPECT_EQ(v.pdf, 0.0f);
        EXPECT_EQ(max_component(v.f_cos), 0.0f);
    }
}

TEST(Bsdf, ExtremesAreFinite) {
    for (const float roughness : {0.0f, 1e-3f, 1.0f}) {
        for (const float cos_o : {1e-8f, 1e-4f, 1.0f}) {
            const Bsdf<float> b = make_bsdf(Vec3f{0, 0, 0}, 1.0f, roughness, cos_o);
            for (const float u : {0.0f, 0.5f, kOneMinusEpsilon}) {
                for (const float v : {0.0f, 0.5f, kOneMinusEpsilon}) {
                    const BsdfSample<float> s = sample_bsdf(b, viewer(cos_o), Vec2f{u, v}, 0.0f);
                    EXPECT_TRUE(is_finite(s.weight) && is_finite(s.pdf) && is_finite(s.wi))
                        << roughness << ' ' << cos_o << ' ' << u << ' ' << v;
                }
            }
        }
    }
}

/// The formula as the documentation states it, in double.
double analytic_reference(double c, double metallic, double roughness, double dielectric, const double n[3],
                          const double o[3], const double i[3]) {
    const auto dot3 = [](const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    double h[3] = {o[0] + i[0], o[1] + i[1], o[2] + i[2]};
    const double length = std::sqrt(dot3(h, h));
    for (double& x : h) x /= length;
    const double no = dot3(n, o), ni = dot3(n, i), nh = dot3(n, h), oh = dot3(o, h);
    if (ni <= 0.0) return 0.0;
    const double alpha = std::max(roughness * roughness, 1e-3), a2 = alpha * alpha;
    const double bottom = nh * nh * (a2 - 1.0) + 1.0;
    const double d = a2 / (M_PI * bottom * bottom);
    const double k = alpha / 2.0;
    const double g = no / (no * (1 - k) + k) * ni / (ni * (1 - k) + k);
    const double f0 = dielectric + (c - dielectric) * metallic;
    const double f = f0 + (1 - f0) * std::pow(1 - oh, 5);
    return (1 - f) * (1 - metallic) * c / M_PI + d * g * f / (4 * no * ni);
}

TEST(Analytic, MatchesTheFormulaInDouble) {
    Random random(6);
    int lit = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const auto direction = [&] { return normalize(sample_cone(2.0f, random.pair())); };
        const Vec3f n = direction(), wi = direction();
        Vec3f wo = direction();
        if (dot(n, wo) < 0.0f) wo = -wo;
        if (dot(n, wo) < 0.01f) continue;
        const Vec3f c{random(), random(), random()};
        const float metallic = random(), roughness = 0.05f + 0.95f * random(), f0 = random();
        const Vec3f f = analytic_brdf(c, metallic, roughness, f0, n, wo, wi);
        const double dn[3] = {n.x, n.y, n.z}, dwo[3] = {wo.x, wo.y, wo.z}, dwi[3] = {wi.x, wi.y, wi.z};
        const double expected = analytic_reference(c.x, metallic, roughness, f0, dn, dwo, dwi);
        // Directions are unit to 1e-7, which the narrow D (alpha 2.5e-3) magnifies.
        ASSERT_NEAR(f.x, expected, 2e-3 * expected + 1e-6) << roughness;
        lit += expected > 0.0;
    }
    EXPECT_GT(lit, 5000);
}

}  // namespace
}  // namespace kadr::kernels
