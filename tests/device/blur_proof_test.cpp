// Motion blur against closed forms: how far an edge is smeared, by rotations, translations, scalings and sensors that are
// read line by line. Rendered as the program does, then measured on the image.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "device/arc_blur.h"
#include "device/rendered_frame.h"

namespace kadr::test {
namespace {

constexpr double kFrame_s = 1.0 / 24;

/// A disc with one mark, a wedge around +x, that turns about +z at a constant speed; the shutter is open for the frame.
GlowingStage marked_disc(double degrees_a_frame) {
    GlowingStage stage;
    stage.size(96, 96, 1.2);
    GeometryData& wedge = stage.scene.geometries[0];
    const auto at = [](double angle) { return kernels::Vec3f{static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0}; };
    wedge.positions = {{0, 0, 0}, at(-kHalfWedge), at(kHalfWedge)};
    wedge.indices = {0, 1, 2};
    stage.add_node("Mark");
    const double second = glm::radians(degrees_a_frame) / kFrame_s;
    stage.shot.scenes[0].transform.rotate.axis_angle = RotationTrack::AxisAngle{{0, 0, 1}, track<double>({{0, 0.0}, {1, second}})};
    return stage;
}

TEST(BlurProof, AMarkedDiscIsSmearedAlongTheAnalyticArc) {
    constexpr double kOuter_px = 38;  // the disc's rim lies at 40, its mark's chord at 39.5
    for (const double degrees : {100.0, 250.0}) {
        const Image image = render_frame(marked_disc(degrees), 512);
        const std::vector<ArcPoint> arc = arc_of(image, 26, kOuter_px);
        const double turned = glm::radians(degrees), plateau = 2 * kHalfWedge / turned;
        EXPECT_NEAR(edge_at(arc, 0, plateau) * kOuter_px, 0, 0.1) << "px; where the blur begins, " << degrees << " degrees";
        EXPECT_NEAR(edge_at(arc, turned, plateau) * kOuter_px, 0, 0.1) << "px; where the blur ends, " << degrees << " degrees";
        double worst = 0;
        for (const ArcPoint& p : arc)
            // A pixel spans 1 / 26 radians: at a corner of the trapezoid its mean is off by an eighth of that slope.
            worst = std::max(worst, std::abs(p.coverage - arc_coverage(p.theta, turned)));
        EXPECT_LT(worst, 0.02);  // Owen-Sobol: 4 / 512, and 1 / 8 / 26 / turned at the corners
    }
}

TEST(BlurProof, TenThousandDegreesASecondMakeARingWithOneArcTwice) {
    // 416.7 degrees within the frame: every direction once, and the first 56.7 degrees a second time.
    const double degrees = 10000.0 / 24, turned = glm::radians(degrees), plateau = 2 * kHalfWedge / turned;
    const std::vector<ArcPoint> arc = arc_of(render_frame(marked_disc(degrees), 512), 26, 38);
    double once = 0, twice = 0, n_once = 0, n_twice = 0;
    for (const ArcPoint& p : arc) {
        EXPECT_NEAR(p.coverage, arc_coverage(p.theta, turned), 0.02);
        if (p.theta > kHalfWedge && p.theta < turned - 2 * kPi - kHalfWedge) twice += p.coverage, ++n_twice;
        if (p.theta > turned - 2 * kPi + kHalfWedge && p.theta < 2 * kPi - kHalfWedge) once += p.coverage, ++n_once;
    }
    // Hundreds of pixels with independent errors of 0.005.
    EXPECT_NEAR(once / n_once, plateau, 0.001);
    EXPECT_NEAR(twice / n_twice, 2 * plateau, 0.002);
}

TEST(BlurProof, ASpinBeyondOneGridIsSplitAndItsSamplesDealtByLength) {
    // Ten times as fast: 417 steps of 10 degrees, more than 128. Eleven whole turns and 206.7 degrees.
    const GlowingStage stage = marked_disc(100000.0 / 24);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    EXPECT_GE(parts.size(), 4u);
    double sum = 0;
    for (const SceneSnapshot& part : parts) {
        EXPECT_NEAR(part.weight, (part.close_s - part.open_s) / kFrame_s, 1e-12);
        sum += part.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    const double turned = glm::radians(100000.0 / 24);
    for (const ArcPoint& p : arc_of(render_frame(stage, 512), 26, 38)) EXPECT_NEAR(p.coverage, arc_coverage(p.theta, turned), 0.02) << p.theta;
}

/// Mean coverage of a column over the rows in the middle.
double column(const Image& image, int x) {
    double sum = 0;
    const int rows = image.height / 8;
    for (int y = image.height / 2 - rows / 2; y < image.height / 2 + rows / 2; ++y) sum += image.at(x, y, 3) / rows;
    return sum;
}

/// Mean of a function over a pixel's column; columns are counted from the image's middle.
double over_column(const std::function<double(double)>& f, double x, double px_a_metre) {
    constexpr int kSteps = 64;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += f((x + (i + 0.5) / kSteps) / px_a_metre) / kSteps;
    return sum;
}

TEST(BlurProof, ATranslationIsATrapezoid) {
    // A bar of 0.5 m moves by 1.2 m.
    GlowingStage stage;
    stage.size(96, 32, 1.2);
    stage.add_node("Bar");
    stage.node(0).scale = {0.25, 1, 1};
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {-0.6, 0, 0}}, {kFrame_s, {0.6, 0, 0}}});
    const Image image = render_frame(stage, 512);
    const auto trapezoid = [](double x) { return std::max(0.0, std::min(0.6, x + 0.25) - std::max(-0.6, x - 0.25)) / 1.2; };
    double begin = 0, end = 0;
    for (int x = 0; x < 96; ++x) {
        EXPECT_NEAR(column(image, x), over_column(trapezoid, x - 48, 40), 0.006) << "column " << x;  // 4 / 512, less by four rows
        (x < 48 ? begin : end) += column(image, x);
    }
    // Each half of the blur holds half of the bar's light: its ends are where they should be, to a hundredth of a pixel.
    EXPECT_NEAR(begin, 10, 0.05);
    EXPECT_NEAR(end, 10, 0.05);
}

TEST(BlurProof, AScalingCoversForAsLongAsItReaches) {
    GlowingStage stage;
    stage.size(96, 32, 1.2);
    stage.add_node("Square");
    stage.shot.scenes[0].transform.scale = track<glm::dvec3>({{0, {0.3, 0.3, 1}}, {kFrame_s, {1, 1, 1}}});
    const Image image = render_frame(stage, 512);
    const auto reach = [](double x) { return std::clamp((1 - std::abs(x)) / 0.7, 0.0, 1.0); };
    for (int x = 0; x < 96; ++x) EXPECT_NEAR(column(image, x), over_column(reach, x - 48, 40), 0.006) << "column " << x;
}

TEST(BlurProof, APropellerBendsUnderARollingShutter) {
    // A thin blade turns by 90 degrees while the sensor is read from top to bottom. Row by row it stands where it was when
    // that row was read: the known bend.
    GlowingStage stage;
    stage.size(96, 96, 1.2);
    stage.add_node("Blade");
    stage.node(0).scale = {1.1, 0.03, 1};
    stage.shot.scenes[0].transform.rotate.axis_angle =
        RotationTrack::AxisAngle{{0, 0, 1}, track<double>({{0, glm::radians(45.0)}, {kFrame_s, glm::radians(135.0)}})};
    stage.shot.shutter = {0, 0, 0, 0, {}, {RollingShutter::Direction::down, kFrame_s}};
    const Image image = render_frame(stage, 256);
    int rows = 0;
    for (int y = 20; y < 76; ++y) {
        const double angle = glm::radians(45 + 90 * (y + 0.5) / 96), up = 48 - (y + 0.5), x_px = up / std::tan(angle);
        double light = 0, moment = 0;
        for (int x = 0; x < 96; ++x)
            if (std::abs(x + 0.5 - 48 - x_px) < 8) light += image.at(x, y, 3), moment += image.at(x, y, 3) * (x + 0.5 - 48);
        if (!(light > 0.5)) continue;
        EXPECT_NEAR(moment / light, x_px, 0.1) << "row " << y;
        ++rows;
    }
    EXPECT_GT(rows, 50);
}

}  // namespace
}  // namespace kadr::test
