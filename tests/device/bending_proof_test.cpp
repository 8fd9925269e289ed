// Meshes that bend while the shutter is open, against closed forms: rendered as the program does, measured on the
// image.
#include <gtest/gtest.h>

#include <cmath>

#include "device/arc_blur.h"
#include "device/rendered_frame.h"

namespace kadr::test {
namespace {

constexpr double kFrame_s = 1.0 / 24;
constexpr double kRim_px = 40;  // the image shows 1.2 m in 48 px

/// A bar of two joints: it stands still up to its middle, bends there, and ends in a wedge from 0.6 to 1 m that the
/// second joint turns about +z.
GlowingStage bending_bar(double degrees, Skinning skinning) {
    GlowingStage stage;
    stage.size(96, 96, 1.2);
    GeometryData& bar = stage.scene.geometries[0];
    const auto tip = [](double radius, double angle) {
        return kernels::Vec3f{static_cast<float>(radius * std::cos(angle)),
                              static_cast<float>(radius * std::sin(angle)), 0};
    };
    bar.positions = {{-0.4f, -0.1f, 0},   {-0.4f, 0.1f, 0},  {-0.1f, -0.1f, 0},     {-0.1f, 0.1f, 0},
                     {0, -0.1f, 0},       {0, 0.1f, 0},      tip(0.6, -kHalfWedge), tip(0.6, kHalfWedge),
                     tip(1, -kHalfWedge), tip(1, kHalfWedge)};
    bar.indices.clear();
    for (std::uint32_t i = 0; i < 8; i += 2)
        bar.indices.insert(bar.indices.end(), {i, i + 2, i + 1, i + 1, i + 2, i + 3});
    bar.skin.per_vertex = 2;
    for (int v = 0; v < 10; ++v) {
        bar.skin.joints.insert(bar.skin.joints.end(),
                               {static_cast<std::uint16_t>(v < 6 ? 0 : 1), static_cast<std::uint16_t>(v < 6 ? 1 : 0)});
        const bool middle = v == 4 || v == 5;
        bar.skin.weights.insert(bar.skin.weights.end(), {middle ? 0.5f : 1.0f, middle ? 0.5f : 0.0f});
    }
    stage.scene.materials[0].double_sided = true;
    const int mesh = stage.add_node("Bar"), root = stage.add_node("Root", -1, false),
              joint = stage.add_node("Tip", root, false);
    Skin skin;
    skin.joints = {root, joint};
    skin.inverse_bind = {glm::dmat4(1), glm::dmat4(1)};
    skin.root = root;
    stage.scene.skins.push_back(skin);
    stage.node(mesh).skin = 0;
    stage.shot.scenes[0].skinning = skinning;
    // Slerp takes the shorter arc: a key for every third of the way.
    stage.animate(joint).rotation = track<glm::dquat>({{0, turn(0)},
                                                       {kFrame_s / 3, turn(degrees / 3)},
                                                       {2 * kFrame_s / 3, turn(2 * degrees / 3)},
                                                       {kFrame_s, turn(degrees)}});
    return stage;
}

void expect_arc(const Image& image, double degrees) {
    const double turned = glm::radians(degrees), plateau = 2 * kHalfWedge / turned;
    const std::vector<ArcPoint> arc = arc_of(image, 26, 38);
    EXPECT_NEAR(edge_at(arc, 0, plateau) * kRim_px, 0, 0.1) << "px; where the blur begins";
    EXPECT_NEAR(edge_at(arc, turned, plateau) * kRim_px, 0, 0.1) << "px; where the blur ends";
    EXPECT_NEAR(reach_of(image, kHalfWedge + 0.05, turned - kHalfWedge - 0.05, 30, plateau), reach_of_chord(kRim_px),
                0.1)
        << "px; how far the blur reaches";
    // A pixel spans 1 / 26 radians: at a corner of the trapezoid its mean is off by an eighth of that slope.
    // Owen-Sobol: 4 / 512.
    for (const ArcPoint& p : arc) EXPECT_NEAR(p.coverage, arc_coverage(p.theta, turned), 0.02) << p.theta;
}

TEST(BendingProof, TheTipOfABarIsSmearedAlongTheAnalyticArc) {
    for (const Skinning skinning : {Skinning::linear, Skinning::dual_quaternion})
        for (const double degrees : {100.0, 150.0}) {
            SCOPED_TRACE(degrees);
            const GlowingStage stage = bending_bar(degrees, skinning);
            ASSERT_GT(stage.snapshot().deformed.at(0)->key_count,
                      4u);  // it is the vertices that move, not the instance
            ASSERT_EQ(stage.snapshot().motion.headers.at(0).frame_count, 1u);
            expect_arc(render_frame(stage, 512), degrees);
        }
}

TEST(BendingProof, TheRigidWedgeReachesAsFar) {
    // The same measure on a turning instance: its rim, too, stays on the arc between the keys.
    GlowingStage stage;
    stage.size(96, 96, 1.2);
    GeometryData& wedge = stage.scene.geometries[0];
    const auto at = [](double angle) {
        return kernels::Vec3f{static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0};
    };
    wedge.positions = {{0, 0, 0}, at(-kHalfWedge), at(kHalfWedge)};
    wedge.indices = {0, 1, 2};
    stage.add_node("Mark");
    stage.shot.scenes[0].transform.rotate.axis_angle =
        RotationTrack::AxisAngle{{0, 0, 1}, track<double>({{0, 0.0}, {kFrame_s, glm::radians(150.0)}})};
    expect_arc(render_frame(stage, 512), 150);
}

}  // namespace
}  // namespace kadr::test
