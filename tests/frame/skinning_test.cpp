// Vertices of skins and morph targets against double references.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "frame/decompose.h"
#include "frame/skinning.h"

namespace kadr {
namespace {

using kernels::Vec3f;
using kernels::Vec4f;
using kernels::Vertex;

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 2e-6;  // of coordinates of order 1 after a few dozen float operations

glm::dvec3 to_double(Vec3f v) { return {v.x, v.y, v.z}; }

/// A tube of radius 1 around the y axis from -1 to 1; the lower end follows joint 0, the upper joint 1.
GeometryData tube(int rings = 9, int sides = 16) {
    GeometryData g;
    g.skin.per_vertex = 2;
    for (int ring = 0; ring < rings; ++ring)
        for (int side = 0; side < sides; ++side) {
            const double t = ring / (rings - 1.0), angle = 2 * kPi * side / sides;
            g.positions.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(2 * t - 1), static_cast<float>(std::sin(angle))});
            g.normals.push_back({static_cast<float>(std::cos(angle)), 0, static_cast<float>(std::sin(angle))});
            const bool upper = t > 0.5;
            g.skin.joints.insert(g.skin.joints.end(), {static_cast<std::uint16_t>(upper ? 1 : 0), static_cast<std::uint16_t>(upper ? 0 : 1)});
            g.skin.weights.insert(g.skin.weights.end(), {static_cast<float>(upper ? t : 1 - t), static_cast<float>(upper ? 1 - t : t)});
        }
    return g;
}

std::vector<Vertex> deformed(const GeometryData& g, const DeformationPose& pose, Skinning skinning = Skinning::linear) {
    std::vector<Vertex> vertices(g.positions.size());
    deform_vertices(g, VertexPose(pose, skinning), vertices, {});
    return vertices;
}

glm::dmat4 rotation(double angle, const glm::dvec3& axis) { return glm::rotate(glm::dmat4(1), angle, glm::normalize(axis)); }

TEST(LinearSkinning, BlendsMatricesByHand) {
    const GeometryData g = tube(3, 4);
    // Joint 1 turns by 90 degrees about z: (x, y, z) -> (-y, x, z). The middle ring lies half way between.
    const auto v = deformed(g, {{glm::dmat4(1), rotation(kPi / 2, {0, 0, 1})}, {}});
    const auto expect = [&](std::size_t i, glm::dvec3 at) { EXPECT_LT(glm::distance(to_double(v[i].position), at), kRounding) << i; };
    expect(0, {1, -1, 0});
    expect(4, {0.5, 0.5, 0});    // (1, 0, 0) and (0, 1, 0)
    expect(6, {-0.5, -0.5, 0});
    expect(8, {-1, 1, 0});       // (1, 1, 0)
    EXPECT_LT(glm::distance(to_double(v[8].normal), glm::dvec3(0, 1, 0)), kRounding);
    EXPECT_LT(glm::distance(to_double(v[4].normal), glm::normalize(glm::dvec3(1, 1, 0))), kRounding);
}

/// Random joints: a rotation, a stretch and a shift.
struct RandomJoint {
    glm::dmat4 matrix;
};
RandomJoint random_joint(bool rigid) {
    const auto number = [](int low, int high) { return *rc::gen::inRange(low, high) / 1000.0; };
    glm::dvec3 axis(number(-1000, 1001), number(-1000, 1001), number(-1000, 1001));
    if (glm::length(axis) < 0.01) axis = {0, 1, 0};
    glm::dmat4 m = glm::translate(glm::dmat4(1), {number(-2000, 2001), number(-2000, 2001), number(-2000, 2001)}) * rotation(number(-3000, 3001), axis);
    if (!rigid) m = glm::scale(m, {number(300, 3000), number(300, 3000), number(300, 3000)});
    return {m};
}

glm::dvec3 reference(const std::vector<glm::dmat4>& joints, const SkinWeights& skin, std::size_t vertex, const glm::dvec3& p) {
    glm::dvec3 sum(0);
    for (int slot = 0; slot < skin.per_vertex; ++slot) {
        const std::size_t i = vertex * static_cast<std::size_t>(skin.per_vertex) + static_cast<std::size_t>(slot);
        sum += static_cast<double>(skin.weights[i]) * glm::dvec3(joints[skin.joints[i]] * glm::dvec4(p, 1));
    }
    return sum;
}

RC_GTEST_PROP(LinearSkinning, AgreesWithDouble, ()) {
    const GeometryData g = tube();
    const std::vector<glm::dmat4> joints{random_joint(false).matrix, random_joint(false).matrix};
    const auto v = deformed(g, {joints, {}});
    for (std::size_t i = 0; i < v.size(); ++i) {
        RC_ASSERT(glm::distance(to_double(v[i].position), reference(joints, g.skin, i, to_double(g.positions[i]))) < 8 * kRounding);
        glm::dmat3 blend(0);
        for (int slot = 0; slot < 2; ++slot) blend += static_cast<double>(g.skin.weights[2 * i + static_cast<std::size_t>(slot)]) * glm::dmat3(joints[g.skin.joints[2 * i + static_cast<std::size_t>(slot)]]);
        if (std::abs(glm::determinant(blend)) < 1e-2) continue;  // the normal of a collapsed vertex means nothing
        RC_ASSERT(glm::distance(to_double(v[i].normal), glm::normalize(glm::transpose(glm::inverse(blend)) * to_double(g.normals[i]))) < 1e-3);
    }
}

TEST(LinearSkinning, TakesManyInfluences) {
    GeometryData g = tube(2, 3);
    g.skin.per_vertex = 7;
    g.skin.joints.clear();
    g.skin.weights.clear();
    std::vector<glm::dmat4> joints;
    for (int j = 0; j < 7; ++j) joints.push_back(glm::translate(glm::dmat4(1), glm::dvec3(j, -j, 2 * j)));
    for (std::size_t v = 0; v < g.positions.size(); ++v)
        for (std::uint16_t j = 0; j < 7; ++j) {
            g.skin.joints.push_back(j);
            g.skin.weights.push_back((7.0f - j) / 28);
        }
    const auto v = deformed(g, {joints, {}});
    for (std::size_t i = 0; i < v.size(); ++i)  // sum of j (7 - j) / 28 = 2
        EXPECT_LT(glm::distance(to_double(v[i].position), to_double(g.positions[i]) + glm::dvec3(2, -2, 4)), 8 * kRounding);
}

/// A dual quaternion in double.  Source: Kavan et al. 2008, 3.
struct Dual {
    glm::dquat real, dual;
};
Dual dual_of(const glm::dmat4& m) {
    const glm::dquat r = glm::quat_cast(glm::dmat3(m));
    return {r, glm::dquat(0, m[3].x, m[3].y, m[3].z) * r * 0.5};
}

RC_GTEST_PROP(DualQuaternionSkinning, AgreesWithDouble, ()) {
    const GeometryData g = tube();
    const std::vector<glm::dmat4> joints{random_joint(true).matrix, random_joint(true).matrix};
    const Dual duals[2] = {dual_of(joints[0]), dual_of(joints[1])};
    // Opposite rotations have no mean: which way round is rounding's choice.
    if (std::abs(glm::dot(duals[0].real, duals[1].real)) < 0.05) return;
    const auto v = deformed(g, {joints, {}}, Skinning::dual_quaternion);
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Dual &a = duals[g.skin.joints[2 * i]], &b = duals[g.skin.joints[2 * i + 1]];
        const double wa = g.skin.weights[2 * i], wb = g.skin.weights[2 * i + 1] * (glm::dot(a.real, b.real) < 0 ? -1 : 1);
        glm::dquat real = a.real * wa + b.real * wb, dual = a.dual * wa + b.dual * wb;
        const double length = glm::length(real);
        real /= length, dual /= length;
        const glm::dquat t = dual * glm::conjugate(real) * 2.0;
        const glm::dvec3 expected = real * to_double(g.positions[i]) + glm::dvec3(t.x, t.y, t.z);
        RC_ASSERT(glm::distance(to_double(v[i].position), expected) < 100 * kRounding);  // short sums are scaled up
    }
}

double volume_of(const std::vector<Vertex>& v, int rings, int sides) {
    double volume = 0;  // rings are horizontal: frusta between polygons, by their areas
    std::vector<double> areas, heights;
    for (int ring = 0; ring < rings; ++ring) {
        double area = 0;
        for (int side = 0; side < sides; ++side) {
            const Vec3f a = v[static_cast<std::size_t>(ring * sides + side)].position, b = v[static_cast<std::size_t>(ring * sides + (side + 1) % sides)].position;
            area += 0.5 * (a.x * b.z - a.z * b.x);
        }
        areas.push_back(std::abs(area));
        heights.push_back(v[static_cast<std::size_t>(ring * sides)].position.y);
    }
    for (int ring = 0; ring + 1 < rings; ++ring) volume += 0.5 * (areas[static_cast<std::size_t>(ring)] + areas[static_cast<std::size_t>(ring) + 1]) * (heights[static_cast<std::size_t>(ring) + 1] - heights[static_cast<std::size_t>(ring)]);
    return volume;
}

// The candy wrapper: twisted by half a turn, blended matrices close the tube in its middle, dual quaternions keep every
// ring a circle.
TEST(DualQuaternionSkinning, KeepsTheVolumeOfATwist) {
    const GeometryData g = tube(9, 16);
    const double whole = volume_of(deformed(g, {{glm::dmat4(1), glm::dmat4(1)}, {}}), 9, 16);
    const DeformationPose twisted{{glm::dmat4(1), rotation(kPi * 0.9999, {0, 1, 0})}, {}};
    EXPECT_NEAR(volume_of(deformed(g, twisted, Skinning::dual_quaternion), 9, 16), whole, 1e-5 * whole);
    EXPECT_LT(volume_of(deformed(g, twisted), 9, 16), 0.5 * whole);
}

TEST(DualQuaternionSkinning, TakesTheNearerOfTwoSigns) {
    const GeometryData g = tube(3, 4);
    // 350 degrees are 10 degrees the other way: the middle turns by 5, not by 175.
    const auto v = deformed(g, {{glm::dmat4(1), rotation(350 * kPi / 180, {0, 1, 0})}, {}}, Skinning::dual_quaternion);
    const glm::dvec3 expected = glm::dvec3(rotation(-5 * kPi / 180, {0, 1, 0}) * glm::dvec4(1, 0, 0, 1));
    EXPECT_LT(glm::distance(to_double(v[4].position), expected), 4 * kRounding);
}

TEST(DualQuaternionSkinning, StretchesAsMatricesDo) {
    const GeometryData g = tube(3, 4);
    const glm::dmat4 joint = glm::translate(glm::dmat4(1), {1, 2, 3}) * rotation(0.7, {1, 2, 3}) * glm::scale(glm::dmat4(1), {2, 0.5, 1});
    const auto v = deformed(g, {{joint, joint}, {}}, Skinning::dual_quaternion);
    for (std::size_t i = 0; i < v.size(); ++i) EXPECT_LT(glm::distance(to_double(v[i].position), glm::dvec3(joint * glm::dvec4(to_double(g.positions[i]), 1))), 8 * kRounding);
}

TEST(Morphing, AddsTargetsBeforeTheJoints) {
    GeometryData g = tube(3, 4);
    g.targets.push_back({{0, 8}, {{0.5f, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {0, 0, 0}}, {}});
    g.targets.push_back({{8}, {{0, 0, 2}}, {}, {}});
    const auto v = deformed(g, {{glm::dmat4(1), rotation(kPi / 2, {0, 0, 1})}, {1, 0.25}});
    EXPECT_LT(glm::distance(to_double(v[0].position), glm::dvec3(1.5, -1, 0)), kRounding);
    EXPECT_LT(glm::distance(to_double(v[0].normal), glm::normalize(glm::dvec3(1, 1, 0))), kRounding);
    // (1, 1, 0) + (0, 1, 0) + 0.25 (0, 0, 2) = (1, 2, 0.5), then a quarter turn.
    EXPECT_LT(glm::distance(to_double(v[8].position), glm::dvec3(-2, 1, 0.5)), kRounding);
    EXPECT_LT(glm::distance(to_double(v[8].normal), glm::dvec3(0, 1, 0)), kRounding);  // a target without normals keeps them
}

TEST(Morphing, MovesTangentsWithTheirTarget) {
    GeometryData g = tube(3, 4);
    g.tangents.assign(g.positions.size(), Vec4f{0, 1, 0, -1});
    g.targets.push_back({{0, 8}, {{0, 0, 0}, {0, 0, 0}}, {}, {{1, 0, 0}, {0, 0, 2}}});
    g.targets.push_back({{8}, {{0, 0, 2}}, {}, {}});  // one without tangents keeps them
    std::vector<Vertex> vertices(g.positions.size());
    std::vector<Vec4f> tangents(g.positions.size());
    deform_vertices(g, VertexPose({{glm::dmat4(1), rotation(kPi / 2, {0, 0, 1})}, {1, 0.25}}, Skinning::linear), vertices, tangents);
    const auto direction = [&](std::size_t i) { return glm::dvec3(tangents[i].x, tangents[i].y, tangents[i].z); };
    EXPECT_LT(glm::distance(direction(0), glm::normalize(glm::dvec3(1, 1, 0))), kRounding);
    EXPECT_LT(glm::distance(direction(1), glm::dvec3(0, 1, 0)), kRounding);
    EXPECT_LT(glm::distance(direction(8), glm::normalize(glm::dvec3(-1, 0, 2))), kRounding);  // (0, 1, 2), then a quarter turn
    EXPECT_EQ(tangents[8].w, -1);
}

TEST(Morphing, KeepsMirroredTangentsRightHanded) {
    GeometryData g = tube(3, 4);
    g.tangents.assign(g.positions.size(), Vec4f{0, 1, 0, 1});
    std::vector<Vertex> vertices(g.positions.size());
    std::vector<Vec4f> tangents(g.positions.size());
    const glm::dmat4 mirror = glm::scale(glm::dmat4(1), {-1, 1, 1});
    deform_vertices(g, VertexPose({{mirror, mirror}, {}}, Skinning::linear), vertices, tangents);
    EXPECT_EQ(tangents[3].y, 1);
    EXPECT_EQ(tangents[3].w, -1);
    EXPECT_LT(glm::distance(to_double(vertices[0].normal), glm::dvec3(-1, 0, 0)), kRounding);
}

}  // namespace
}  // namespace kadr
