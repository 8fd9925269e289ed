// What vertices miss between two keys, against every vertex by itself.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "frame/deform_fit.h"

namespace kadr {
namespace {

constexpr int kVertices = 5000;      // more than two blocks
constexpr double kRounding = 1e-3;   // of an error: differences of floats of order 1 that are some 1e-3 long

/// A bar of two joints that bends and, by a morph target, swells at its end.
struct Bar {
    Scene scene;
    GeometryData geometry;
    Deformer deformer;
    std::vector<DeformationPose> poses;

    explicit Bar(double degrees) {
        geometry.skin.per_vertex = 2;
        for (int i = 0; i < kVertices; ++i) {
            const float t = static_cast<float>(i) / (kVertices - 1);
            geometry.positions.push_back({2 * t - 1, 0.2f * std::cos(40 * t), 0.2f * std::sin(40 * t)});
            geometry.normals.push_back({0, 1, 0});
            geometry.skin.joints.insert(geometry.skin.joints.end(), {static_cast<std::uint16_t>(t > 0.5f), static_cast<std::uint16_t>(t <= 0.5f)});
            geometry.skin.weights.insert(geometry.skin.weights.end(), {std::max(t, 1 - t), std::min(t, 1 - t)});
        }
        geometry.targets.push_back({{kVertices - 1}, {{0, 0.5f, 0}}, {{1, 0, 0}}, {}});
        scene.nodes.resize(2);
        scene.skins.push_back({"", {0, 1}, {glm::dmat4(1), glm::dmat4(1)}, 0});
        deformer.skeleton = Skeleton(scene, 0);
        deformer.skinning = Skinning::dual_quaternion;
        for (int i = 0; i <= 8; ++i)
            poses.push_back({{glm::dmat4(1), glm::rotate(glm::dmat4(1), glm::radians(degrees) * i / 8, glm::dvec3(0, 0, 1))}, {i / 8.0}});
    }
};

struct View {
    std::vector<PixelScale> scales;
    View(const glm::dvec3& eye = {0, 0, 5}, double yaw_degrees = 0) {
        CameraState camera;
        camera.position = eye;
        camera.rotation = glm::angleAxis(glm::radians(yaw_degrees), glm::dvec3(0, 1, 0));
        scales.assign(9, PixelScale(camera, 1080));
    }
    double error_px(const Bar& bar, double enough_px) const {
        return deformation_error_px(bar.geometry, bar.deformer, bar.poses, {{glm::dmat4(1)}, scales, enough_px});
    }
    double by_hand(const Bar& bar) const {
        std::vector<std::vector<kernels::Vertex>> at(9, std::vector<kernels::Vertex>(kVertices));
        for (std::size_t i = 0; i < 9; ++i) deform_vertices(bar.geometry, VertexPose(bar.poses[i], bar.deformer.skinning), at[i], {});
        const auto place = [&](std::size_t i, std::size_t v) { return glm::dvec3(at[i][v].position.x, at[i][v].position.y, at[i][v].position.z); };
        double worst = 0;
        for (std::size_t i = 0; i < 9; ++i)
            for (std::size_t v = 0; v < kVertices && i % 4 != 0; ++v) {
                const std::size_t from = i / 4 * 4;
                const glm::dvec3 linear = glm::mix(place(from, v), place(from + 4, v), static_cast<double>(i % 4) / 4);
                worst = std::max(worst, scales[i].pixels(glm::distance(linear, place(i, v)), place(i, v), 0.05 * std::sqrt(3.0)));
            }
        return worst;
    }
};

TEST(DeformationFit, MeasuresEveryVertexWhereTheFigureIsWanted) {
    const View view;
    for (const double degrees : {3.0, 40.0, 150.0}) {
        const Bar bar(degrees);
        EXPECT_NEAR(view.error_px(bar, INFINITY), view.by_hand(bar), kRounding * view.by_hand(bar)) << degrees;
    }
}

TEST(DeformationFit, NeverSaysTooLittle) {
    const View view;
    const Bar bar(40);
    const double by_hand = view.by_hand(bar);
    for (const double enough : {0.5, 0.99, 1.01, 2.0, 20.0}) {
        const double error = view.error_px(bar, enough * by_hand);
        if (enough > 1) {
            EXPECT_GE(error, (1 - kRounding) * by_hand) << enough;
            EXPECT_LE(error, enough * by_hand) << enough;
        } else {
            EXPECT_GT(error, enough * by_hand) << enough;  // beyond enough, and that is all that is asked
        }
    }
}

TEST(DeformationFit, CountsTheNearestVertexOfABlock) {
    const View along({1.12, 0, 0}, 90);  // down the bar, whose end shows far larger than its middle
    const Bar bar(4);
    const double by_hand = along.by_hand(bar);
    for (const double enough : {1.01, 1.3, 3.0}) EXPECT_GE(along.error_px(bar, enough * by_hand), (1 - kRounding) * by_hand) << enough;
}

TEST(DeformPositions, AreThoseOfTheVertices) {
    for (const Skinning skinning : {Skinning::linear, Skinning::dual_quaternion}) {
        const Bar bar(70);
        const VertexPose pose(bar.poses[5], skinning);
        std::vector<kernels::Vertex> vertices(kVertices);
        deform_vertices(bar.geometry, pose, vertices, {});
        std::vector<kernels::Vec3f> positions(kVertices - 100);
        deform_positions(bar.geometry, pose, 100, positions);
        for (std::size_t i = 0; i < positions.size(); ++i) {
            EXPECT_EQ(positions[i].x, vertices[100 + i].position.x) << i;
            EXPECT_EQ(positions[i].y, vertices[100 + i].position.y) << i;
            EXPECT_EQ(positions[i].z, vertices[100 + i].position.z) << i;
        }
    }
}

}  // namespace
}  // namespace kadr
