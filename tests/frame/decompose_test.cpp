#include "frame/decompose.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <limits>

#include "frame/key_grid.h"
#include "stage.h"

namespace kadr {
namespace {

using test::turn;

double difference(const glm::dmat4& a, const glm::dmat4& b) {
    double worst = 0;
    for (int column = 0; column < 4; ++column) worst = std::max(worst, glm::length(a[column] - b[column]));
    return worst;
}

TEST(Decompose, FindsTheParts) {
    const Decomposition parts = decompose(compose({turn(50, {1, 2, 3}), {2, 3, -4}, {0.5, 0.25, -1}, {7, 8, 9}}));
    EXPECT_LT(angle_between(parts.rotation, turn(50, {1, 2, 3})), 1e-7);  // acos-free, but sqrt in the quaternion
    EXPECT_LT(glm::distance(parts.scale, {2, 3, -4}), 1e-14);
    EXPECT_LT(glm::distance(parts.shear, {0.5, 0.25, -1}), 1e-14);
    EXPECT_EQ(parts.translation, glm::dvec3(7, 8, 9));
    EXPECT_TRUE(is_sheared(parts));
}

TEST(Decompose, SeesWhatHasNoInverse) {
    EXPECT_TRUE(is_singular(decompose(glm::scale(glm::dmat4(1), {1, 0, 1}))));
    EXPECT_TRUE(is_singular(decompose(glm::scale(glm::dmat4(1), {0, 0, 0}))));
    EXPECT_TRUE(is_singular(decompose(glm::scale(glm::dmat4(1), {1, 1, 1e-9}))));
    EXPECT_FALSE(is_singular(decompose(glm::scale(glm::dmat4(1), {1e-6, -1e-6, 1e-6}))));
    EXPECT_FALSE(is_finite(glm::dmat4(std::numeric_limits<double>::infinity())));
    EXPECT_FALSE(is_finite(glm::dmat4(std::numeric_limits<double>::quiet_NaN())));
    EXPECT_TRUE(is_finite(glm::dmat4(1e300)));
}

TEST(Decompose, SlerpsAlongTheShorterArc) {
    const Decomposition a{turn(170), {1, 1, 1}, {0, 0, 0}, {0, 0, 0}}, b{-turn(190), {3, 1, 1}, {0, 0, 0}, {2, 0, 0}};
    const Decomposition half = interpolate(a, b, 0.5);
    EXPECT_LT(angle_between(half.rotation, turn(180)), 1e-12);
    EXPECT_EQ(half.scale, glm::dvec3(2, 1, 1));
    EXPECT_EQ(half.translation, glm::dvec3(1, 0, 0));
}

RC_GTEST_PROP(DecomposeProperty, ComposingGivesTheMatrixBack, ()) {
    const auto number = [] { return *rc::gen::inRange(-1000, 1000) / 100.0; };
    glm::dmat4 m(1);
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row) m[column][row] = number();
    if (std::abs(glm::determinant(glm::dmat3(m))) < 1) return;
    RC_ASSERT(difference(compose(decompose(m)), m) < 1e-11);  // entries up to 10, condition number up to about 1e3
    RC_ASSERT(std::abs(glm::length(decompose(m).rotation) - 1) < 1e-14);
}

TEST(KeyGrid, KeysFallOnTheGridWherePossible) {
    EXPECT_EQ(even_segments_for({}), 1);
    EXPECT_EQ(even_segments_for({1 / 3.0, 0.5}), 6);
    EXPECT_EQ(even_segments_for({0.123456}), 1);
    EXPECT_EQ(refined_segments(3, 5), 6);
    EXPECT_EQ(refined_segments(1, 200), 128);
}

}  // namespace
}  // namespace kadr
