// Mirrors: what shines is seen in them as it is seen straight on, times their Fresnel term, in every sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "device/varied_scenes.h"
#include "kernels/bsdf/ggx.h"
#include "kernels/scene/scene_view.h"

namespace kadr::test {
namespace {

using kernels::LightKind;

constexpr float kRadiance = 3;

class Mirror : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        if (GetParam() == 8 && !__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
    }
};
INSTANTIATE_TEST_SUITE_P(Lanes, Mirror, testing::Values(1, 8));

/// Something that fills the picture in a mirror under 45 degrees: light from above goes to the camera.
struct Shining {
    std::string name;
    std::function<void(SmallScene&)> add;
};

kernels::Light panel_above() {
    kernels::Light light;
    light.kind = LightKind::area;
    light.radiance = {kRadiance, kRadiance, kRadiance};
    light.position = {0, 3, 0};
    light.direction = {0, -1, 0};
    light.axis_u = {2, 0, 0};
    light.axis_v = {0, 0, 2};
    return light;
}

const std::vector<Shining>& shining() {
    static const std::vector<Shining> all{
        {"a panel", [](SmallScene& s) { s.add_light(panel_above()); }},
        {"a ball of light",
         [](SmallScene& s) {
             kernels::Light light = panel_above();
             light.kind = LightKind::point;
             light.radius = 2;
             light.position = {0, 4, 0};
             light.radiance = light.radiance * static_cast<float>(kPi * 4);  // candela of a sphere of that radiance
             s.add_light(light);
         }},
        {"a panel among lamps",
         [](SmallScene& s) {
             s.add_light(panel_above());
             s.add_light(directional({5, 5, 5}, {0, -1, 0}));  // which no ray meets
         }},
        {"a glowing mesh",
         [](SmallScene& s) {
             kernels::Material m = material({0, 0, 0}, 0, 1);
             m.emission = {kRadiance, kRadiance, kRadiance};
             m.unlit = false;
             s.add_instance(s.add_mesh(unit_square()), m, glm::rotate(place({0, 3, 0}, 2), kPi / 2, glm::dvec3(1, 0, 0)));
         }},
        {"an image of the sky",
         [](SmallScene& s) {
             s.environment.width = s.environment.height = 4;
             s.environment.channels = {"R", "G", "B"};
             s.environment.pixels.assign(3 * 16, kRadiance);
             s.snapshot.environment.radiance = {1, 1, 1};
         }},
        {"the sky", [](SmallScene& s) { s.snapshot.environment.radiance = {kRadiance, kRadiance, kRadiance}; }},
    };
    return all;
}

SmallScene mirrored(const kernels::Material& m) {
    SmallScene s;
    s.camera({0, 0, 5}, {0, 0, 0}, 0.02);
    s.snapshot.settings.max_bounces = s.snapshot.settings.max_diffuse = s.snapshot.settings.max_glossy = 1;
    s.snapshot.environment.visible = true;
    s.add_instance(s.add_mesh(unit_square()), m, glm::rotate(glm::dmat4(1), -kPi / 4, glm::dvec3(1, 0, 0)));
    return s;
}

/// The glowing mesh is black, and reflects its 4 % of nothing; everything else is as stated.
TEST_P(Mirror, ShowsWhatShinesInEverySample) {
    // Rays meet the mirror within 0.028 rad of 45 degrees: Schlick's term changes by 8e-4 there.
    const double schlick = std::pow(1 - std::sqrt(0.5), 5);
    for (const Shining& light : shining())
        for (const float reflectance : {1.0f, 0.5f}) {
            SmallScene s = mirrored(material({reflectance, reflectance, reflectance}, 1, 0));
            light.add(s);
            const Image image = s.render(8, 1, GetParam()).image;
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x)
                    ASSERT_NEAR(image.at(x, y, 0), kRadiance * (reflectance + (1 - reflectance) * schlick), 8e-4 * kRadiance) << light.name << ", " << x << ' ' << y;
        }
}

TEST_P(Mirror, OfGlassShowsItsFresnelTermOnAverage) {
    for (const float f0 : {0.0f, kernels::kDielectricF0, 0.444f, 1.0f})
        for (const Shining& light : shining()) {
            kernels::Material glass = material({0, 0, 0}, 0, 0);
            glass.dielectric_f0 = f0;
            SmallScene s = mirrored(glass);
            light.add(s);
            const double expected = kRadiance * (f0 + (1 - f0) * std::pow(1 - std::sqrt(0.5), 5));
            const SmallScene::Result result = s.render(8, 1, GetParam());
            EXPECT_NEAR(result.mean(), expected, 3e-3 * kRadiance * (1.1 - f0)) << light.name << ", f0 " << f0;
        }
}

/// A base under the lobe: what the mirror takes from it, light sampling and the diffuse samples share.
TEST_P(Mirror, OverABaseIsWhiteInAFurnace) {
    for (const float f0 : {kernels::kDielectricF0, 0.444f})
        for (const float metallic : {0.0f, 0.5f, 1.0f})
            for (const float roughness : {0.0f, 0.004f, 0.02f}) {
                SmallScene s;
                kernels::Material m = material({1, 1, 1}, metallic, roughness);
                m.dielectric_f0 = f0;
                s.add_instance(s.add_mesh(unit_sphere()), m, glm::dmat4(1));
                s.snapshot.environment.radiance = {1, 1, 1};
                s.snapshot.settings.max_bounces = 32;
                // As of wider lobes (closed_form_test.cpp).
                EXPECT_NEAR(s.render(64, 2, GetParam()).mean(), 1.0, 0.008) << "metallic " << metallic << ", roughness " << roughness;
            }
}

/// Light that the base sends out is sampled as if there were no mirror.
TEST_P(Mirror, LeavesTheBaseItsLight) {
    const auto mean_of = [&](float roughness, LightKind kind) {
        SmallScene s = mirrored(material({0.7f, 0.7f, 0.7f}, 0, roughness));
        kernels::Light light = panel_above();
        light.kind = kind;
        if (kind == LightKind::area) light.position = {0, 3, 3}, light.axis_u = {0.5f, 0, 0}, light.axis_v = {0, 0, 0.5f};
        light.position.z = 3;  // nothing of it in the mirror
        s.add_light(light);
        return s.render(256, 2, GetParam()).mean();
    };
    for (const LightKind kind : {LightKind::area, LightKind::point}) {
        // 0.033: the narrowest lobe that is none of a mirror; its tail at this angle is 1e-5 of the base.
        const double wide = mean_of(0.033f, kind), delta = mean_of(0.0f, kind);
        EXPECT_NEAR(delta / wide, 1, 0.01);  // a deviation of 0.2 within a sample, 262144 of them: 4 sigma = 0.002
    }
}

unsigned needs_of(const kernels::Material& m, const TextureData* texture = nullptr, bool exact_fresnel = false) {
    SmallScene s = sunlit(kernels::IntegratorKind::path);
    s.snapshot.settings.exact_fresnel = exact_fresnel;
    if (texture) s.scene.textures.push_back(*texture);
    s.add_instance(s.add_mesh(unit_square()), m, glm::dmat4(1));
    return s.render(1, 1, 1).statistics.required & (kernels::requirement::kMirrors | kernels::requirement::kIor | kernels::requirement::kFresnel);
}

TEST(MirrorNeeds, BeginBelowTheNarrowestOtherLobe) {
    using namespace kernels::requirement;
    const float edge = std::sqrt(kernels::kMinAlpha);
    EXPECT_EQ(needs_of(material({1, 1, 1}, 1, edge * 1.001f)), 0u);
    EXPECT_EQ(needs_of(material({1, 1, 1}, 1, edge * 0.999f)), kMirrors);
    EXPECT_EQ(needs_of(material({1, 1, 1}, 0, 0)), kMirrors);
    kernels::Material unlit = material({1, 1, 1}, 0, 0);
    unlit.unlit = true;
    unlit.dielectric_f0 = 0.1f;
    EXPECT_EQ(needs_of(unlit), 0u);
    kernels::Material glass = material({1, 1, 1}, 0, 1);
    glass.dielectric_f0 = 0.1f;
    EXPECT_EQ(needs_of(glass), kIor);
}

TEST(MirrorNeeds, OfFresnelsEquationsAreThoseOfDielectrics) {
    using kernels::requirement::kFresnel;
    TextureData map;
    map.width = map.height = 1;
    map.format = kernels::TexelFormat::rgba8_linear;
    map.texels = {0, 255, 255, 0};
    kernels::Material unlit = material({1, 1, 1}, 0, 1), textured = material({1, 1, 1}, 1, 1);
    unlit.unlit = true;
    textured.metallic_roughness_texture.texture = 0;
    EXPECT_EQ(needs_of(material({1, 1, 1}, 1, 1), nullptr, true), 0u);
    EXPECT_EQ(needs_of(unlit, nullptr, true), 0u);
    EXPECT_EQ(needs_of(material({1, 1, 1}, 0.9f, 1), nullptr, true), kFresnel);
    EXPECT_EQ(needs_of(textured, &map, true), kFresnel);
    EXPECT_EQ(needs_of(material({1, 1, 1}, 0.9f, 1)), 0u);
}

TEST(MirrorNeeds, FollowTheLeastRoughnessOfATexture) {
    using kernels::requirement::kMirrors;
    TextureData map;
    map.width = map.height = 2;
    map.format = kernels::TexelFormat::rgba8_linear;
    map.texels = {0, 255, 0, 0, 0, 9, 0, 0, 0, 200, 0, 0, 0, 255, 0, 0};  // 9/255 = 0.0353
    kernels::Material m = material({1, 1, 1}, 0, 1);
    m.metallic_roughness_texture.texture = 0;
    EXPECT_EQ(needs_of(m, &map), 0u);
    map.texels[5] = 8;  // 0.0314
    EXPECT_EQ(needs_of(m, &map), kMirrors);
    map.texels[5] = 9;
    m.roughness = 0.8f;
    EXPECT_EQ(needs_of(m, &map), kMirrors);
}

TEST(MirrorNeeds, AreNoneOfTheAnalyticModel) {
    const auto render = [](float roughness) {
        SmallScene s = sunlit(kernels::IntegratorKind::direct);
        s.add_instance(s.add_mesh(unit_sphere()), material({0.8f, 0.8f, 0.8f}, 0.5f, roughness), glm::dmat4(1));
        return s.render(1, 1, 1).image.pixels;
    };
    EXPECT_EQ(render(0), render(std::sqrt(kernels::kMinAlpha) * 0.99f));
    EXPECT_NE(render(0), render(0.1f));
}

}  // namespace
}  // namespace kadr::test
