#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "kernels/integrator/interaction.h"

namespace kadr::kernels {
namespace {

Vec3f tilted(float degrees, float turn = 0.0f) {
    const float a = degrees * 3.14159265f / 180.0f;
    return {std::sin(a) * std::cos(turn), std::cos(a), std::sin(a) * std::sin(turn)};
}

Vec3f mirrored(Vec3f n, Vec3f wo) { return n * (2 * dot(n, wo)) - wo; }

constexpr Vec3f kUp{0, 1, 0};

TEST(ReflectingNormal, IsTheShadingNormalWhereThatMirrorsAboveTheSurface) {
    const Vec3f n = reflecting_normal(kUp, tilted(30), tilted(10));
    EXPECT_EQ(n.x, tilted(30).x);
    EXPECT_EQ(n.y, tilted(30).y);
}

TEST(ReflectingNormal, OfASteepNormalMapMirrorsJustAboveTheSurface) {
    ASSERT_LT(mirrored(tilted(60), tilted(0)).y, 0.0f);
    const Vec3f direction = mirrored(reflecting_normal(kUp, tilted(60), tilted(0)), tilted(0));
    // The mirrored (sin 120, cos 120) is raised to a height of 0.02 and made unit again.
    EXPECT_NEAR(direction.y, 0.02f / std::sqrt(0.75f + 0.0004f), 1e-4f);
    EXPECT_GT(direction.x, 0.9f);
}

RC_GTEST_PROP(ReflectingNormal, NeverMirrorsIntoTheSurface, ()) {
    const auto angle = [](int most) { return static_cast<float>(*rc::gen::inRange(0, most * 10 + 1)) / 10.0f; };
    const Vec3f wo = tilted(angle(89), angle(6)), shading = tilted(angle(89), angle(6));
    RC_PRE(dot(shading, wo) > 1e-3f);
    const Vec3f n = reflecting_normal(kUp, shading, wo);
    RC_ASSERT(std::abs(dot(n, n) - 1) < 1e-5f);
    RC_ASSERT(mirrored(n, wo).y > 0);
}

}  // namespace
}  // namespace kadr::kernels
