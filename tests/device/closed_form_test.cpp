// Images whose values are known: furnaces, enclosures, single lights.
#include <gtest/gtest.h>

#include "device/small_scene.h"

namespace kadr::test {
namespace {

class EveryWidth : public ::testing::TestWithParam<int> {
protected:
    void SetUp() override {
        if (GetParam() == 8 && !__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
    }
};
INSTANTIATE_TEST_SUITE_P(Lanes, EveryWidth, ::testing::Values(1, 8));

TEST_P(EveryWidth, WhiteFurnaceHidesEveryWhiteMaterial) {
    for (const float metallic : {0.0f, 0.5f, 1.0f})
        for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f}) {
            SmallScene s;
            s.add_instance(s.add_mesh(unit_sphere()), material({1, 1, 1}, metallic, roughness), glm::dmat4(1));
            s.snapshot.environment.radiance = {1, 1, 1};
            s.snapshot.settings.max_bounces = 32;
            const double mean = s.render(64, 2, GetParam()).mean();
            // 1024 pixels x 64 samples, deviation of a sample below 0.3 where roulette plays: 4 sigma = 0.005; the
            // albedo tables are good to 0.003.
            EXPECT_NEAR(mean, 1.0, 0.008) << "metallic " << metallic << ", roughness " << roughness;
        }
}

TEST_P(EveryWidth, ClosedMirrorSphereSumsTheSeries) {
    SmallScene s;
    kernels::Material m = material({0.5f, 0.5f, 0.5f}, 1, 0);
    m.emission = {0.5f, 0.5f, 0.5f};
    s.add_instance(s.add_mesh(unit_sphere(128)), m, glm::dmat4(1));
    s.camera({0, 0, 0}, {0, 0, -1}, 0.1);
    s.snapshot.settings.max_bounces = 20;
    // At normal incidence the reflectance is F0 = 1/2: L = e / (1 - F0) = 1. Facets of 1.4 degrees keep F within 1e-4.
    EXPECT_NEAR(s.render(64, 2, GetParam()).mean(), 1.0, 0.01);
}

TEST_P(EveryWidth, BouncesCutTheSeries) {
    // N bounces: N + 1 hits receive light and emit, so e * (1 + F0 + ... + F0^N).
    for (const int bounces : {0, 1, 3}) {
        SmallScene s;
        kernels::Material m = material({0.5f, 0.5f, 0.5f}, 1, 0);
        m.emission = {1, 1, 1};
        s.add_instance(s.add_mesh(unit_sphere(128)), m, glm::dmat4(1));
        s.camera({0, 0, 0}, {0, 0, -1}, 0.1);
        s.snapshot.settings.max_bounces = bounces;
        double expected = 0;
        // The emission is light-sampled too: at the last hit next-event estimation brings one term more, with MIS.
        for (int k = 0; k <= bounces; ++k) expected += std::pow(0.5, k);
        const double mean = s.render(256, 2, GetParam()).mean();
        EXPECT_GE(mean, expected - 0.02);
        EXPECT_LE(mean, expected + std::pow(0.5, bounces + 1) + 0.02);
    }
}

/// Radiance of a rough white dielectric floor straight above the point under a light, from the direct integrator's
/// formula.
TEST_P(EveryWidth, DirectPointLightOnAFloor) {
    SmallScene s;
    s.snapshot.settings.integrator = kernels::IntegratorKind::direct;
    s.snapshot.settings.width = s.snapshot.settings.height = 1;
    s.add_instance(s.add_mesh(unit_square()), material({0.8f, 0.8f, 0.8f}, 0, 1), place({0, 0, 0}, 10));
    kernels::Light light;
    light.kind = kernels::LightKind::point;
    light.radiance = {3, 3, 3};
    light.position = {0, 0, 2};
    s.add_light(light);
    // N = wo = wi = h: D = 1/pi (alpha 1), G = 1, F = F0 = 0.04; f = 0.96 * 0.8 / pi + 0.04 / (4 pi); E = 3 / 4.
    const double f = 0.96 * 0.8 / kPi + 0.04 / (4 * kPi);
    EXPECT_NEAR(s.render(1, 1, GetParam()).mean(), f * 3 / 4, 1e-5);
}

TEST_P(EveryWidth, PathPointLightIsAlbedoOverPiTimesIrradiance) {
    SmallScene s;
    s.snapshot.settings.max_bounces = 0;
    s.camera({0, 0, 5}, {0, 0, 0}, 0.001);
    s.add_instance(s.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), place({0, 0, 0}, 10));
    kernels::Light light;
    light.kind = kernels::LightKind::point;
    light.radiance = {1, 1, 1};
    light.position = {0, 0, 2};
    s.add_light(light);
    // A white material reflects everything but not quite as Lambert would: the specular part is a little stronger
    // head-on.
    EXPECT_NEAR(s.render(4, 1, GetParam()).mean(), 1 / (4 * kPi), 0.06 / (4 * kPi));
}

/// The same square as an area light, as emissive triangles, and seen without any light sampling, must agree.
TEST_P(EveryWidth, AreaLightAndEmissiveTrianglesAgree) {
    const auto floor_and = [&](int kind) {
        SmallScene s;
        s.camera({0, 3, 3}, {0, 0, 0}, 0.3);
        s.snapshot.settings.max_bounces = 1;
        const glm::dmat4 up = glm::rotate(glm::dmat4(1), -kPi / 2, glm::dvec3(1, 0, 0));
        s.add_instance(s.add_mesh(unit_square()), material({0.5f, 0.5f, 0.5f}, 0, 0.4f), place({0, 0, 0}, 4) * up);
        if (kind == 0) {
            kernels::Light light;
            light.kind = kernels::LightKind::area;
            light.radiance = {5, 5, 5};
            light.position = {0, 2, 0};
            light.direction = {0, -1, 0};
            light.axis_u = {0.5f, 0, 0};
            light.axis_v = {0, 0, 0.5f};
            s.add_light(light);
        } else {
            kernels::Material m = material({0, 0, 0}, 0, 1);
            m.emission = {5, 5, 5};
            const glm::dmat4 down = glm::rotate(glm::dmat4(1), kPi / 2, glm::dvec3(1, 0, 0));
            s.add_instance(s.add_mesh(unit_square()), m, place({0, 2, 0}, 0.5) * down, kind == 1);
        }
        return s.render(256, 2, GetParam()).mean();
    };
    const double area = floor_and(0), flat = floor_and(1), instanced = floor_and(2);
    // 262144 samples with a deviation of about 0.2: 4 sigma = 0.0016 of a mean near 0.2. The black square reflects a
    // little.
    EXPECT_NEAR(flat / area, 1.0, 0.02);
    EXPECT_NEAR(instanced / flat, 1.0, 0.01);
}

TEST_P(EveryWidth, EnvironmentImageOfOneColourIsTheConstant) {
    const auto render = [&](bool image) {
        SmallScene s;
        s.add_instance(s.add_mesh(unit_sphere()), material({0.8f, 0.6f, 0.4f}, 0.3f, 0.5f), glm::dmat4(1));
        s.snapshot.environment.radiance = {1, 1, 1};
        s.snapshot.settings.max_bounces = 4;
        if (image) {
            s.environment.width = 16;
            s.environment.height = 8;
            s.environment.channels = {"R", "G", "B"};
            s.environment.pixels.assign(16 * 8 * 3, 1.0f);
        }
        return s.render(128, 2, GetParam()).mean();
    };
    EXPECT_NEAR(render(true), render(false), 0.005);  // 4 sigma at a deviation of 0.4 over 131072 samples
}

TEST_P(EveryWidth, HiddenEnvironmentIsTransparentAndStillLights) {
    SmallScene s;
    s.add_instance(s.add_mesh(unit_sphere()), material({1, 1, 1}, 0, 1), glm::dmat4(1));
    s.snapshot.environment.radiance = {1, 1, 1};
    s.snapshot.environment.visible = false;
    s.snapshot.settings.transparent_background = true;
    s.snapshot.settings.max_bounces = 16;
    const Image image = s.render(64, 2, GetParam()).image;
    EXPECT_EQ(image.at(0, 0, 3), 0);
    EXPECT_EQ(image.at(0, 0, 0), 0);
    EXPECT_EQ(image.at(16, 16, 3), 1);
    EXPECT_NEAR(image.at(16, 16, 0), 1, 0.1);
}

TEST_P(EveryWidth, BlendedLayersMultiplyInDirect) {
    SmallScene s;
    s.snapshot.settings.integrator = kernels::IntegratorKind::direct;
    const unsigned square = s.add_mesh(unit_square());
    kernels::Material m = material({0, 0, 0}, 0, 1);
    m.alpha_mode = kernels::AlphaMode::blend;
    m.alpha = 0.5f;
    m.emission = {2, 2, 2};
    s.add_instance(square, m, place({0, 0, 1}, 5));
    s.add_instance(square, m, place({0, 0, 2}, 5));
    s.snapshot.environment.radiance = {1, 1, 1};
    const Image image = s.render(1, 1, GetParam()).image;
    // Two glowing layers of half coverage over the background: 1/2 * 2 + 1/2 (1/2 * 2 + 1/2 * 1), without noise.
    EXPECT_NEAR(image.at(16, 16, 1), 1.75, 1e-6);
}

TEST_P(EveryWidth, ShadowsOfBlendedSurfacesAreFreeOfNoise) {
    SmallScene s;
    s.snapshot.settings.integrator = kernels::IntegratorKind::direct;
    s.snapshot.settings.width = s.snapshot.settings.height = 4;
    s.camera({0, 0, 1}, {0, 0, 0}, 0.01);
    const unsigned square = s.add_mesh(unit_square());
    s.add_instance(square, material({0.8f, 0.8f, 0.8f}, 0, 1), place({0, 0, 0}, 10));
    kernels::Light light;
    light.kind = kernels::LightKind::point;
    light.radiance = {4, 4, 4};
    light.position = {0, 0, 3};
    s.add_light(light);
    const double open = s.render(1, 1, GetParam()).mean();
    kernels::Material veil = material({1, 1, 1}, 0, 1);
    veil.alpha_mode = kernels::AlphaMode::blend;
    veil.alpha = 0.25f;
    s.add_instance(square, veil, place({0, 0, 2}, 1));
    EXPECT_NEAR(s.render(1, 1, GetParam()).mean(), 0.75 * open, 1e-5);
}

}  // namespace
}  // namespace kadr::test
