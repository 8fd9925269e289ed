// Shutters that are split because motion frames, camera keys or light keys of the whole would stray too far. What is
// reported is compared with dense double-precision references of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "frame/key_grid.h"
#include "frame/light_keys.h"
#include "frame/motion_report.h"
#include "frame/stage.h"

namespace kadr::test {
namespace {

constexpr unsigned kSeed = 71;
// A true error between the places that a fit looks at may be larger than the largest it has seen: a fit's margin is for that.
constexpr double kBetween = 1 / kMotionMargin;
// Keys and frames are floats: 2^-24 of an angle, of a scale and of places some 5 m away, at 2000 px to the radian.
constexpr double kFloats = 2e-3;

Stage full_hd() {
    Stage stage;
    stage.shot.image = {1920, 1080, 1};
    return stage;
}

/// A stretched box whose parent turns and whose own axes turn against that: strong shear, fast turns.
Stage sheared(std::mt19937& random) {
    std::uniform_real_distribution<double> number(-1, 1);
    Stage stage = full_hd();
    const int parent = stage.add_node("Parent", -1, false), child = stage.add_node("Child", parent);
    stage.node(parent).scale = {0.2, 1.5, 0.6};
    stage.animate(parent).rotation = track<glm::dquat>({{0, turn(0, {1, number(random), 2})}, {1, turn(170, {1, number(random), 2})}});
    stage.animate(child).rotation = track<glm::dquat>({{0, turn(0, {number(random), 1, 0})}, {0.5, turn(160, {number(random), 1, 0})}, {1, turn(310, {0, 1, 0})}});
    return stage;
}

/// Corners of a path at odd times: no even grid meets them.
std::vector<std::pair<double, glm::dvec3>> jolts(std::mt19937& random, double z, double reach) {
    std::uniform_real_distribution<double> number(-reach, reach);
    std::vector<std::pair<double, glm::dvec3>> keys;
    for (int i = 0; i <= 4; ++i) keys.push_back({i / 4.0 + (i == 0 || i == 4 ? 0 : 0.017 * number(random)), {number(random), number(random), z}});
    return keys;
}

/// How far the image of what the camera looks at strays, by the keys against the camera itself.
double camera_error_px(const Stage& stage, const SceneSnapshot& part, int times) {
    const BoundShot bound = stage.bind();
    double worst = 0;
    for (int i = 0; i <= times; ++i) {
        const double u = static_cast<double>(i) / times;
        const CameraState truth = camera_at(bound, std::lerp(part.open_s, part.close_s, u));
        const double position = u * static_cast<double>(part.camera_keys.size() - 1);
        const std::size_t from = std::min(static_cast<std::size_t>(position), part.camera_keys.size() - (part.camera_keys.size() > 1 ? 2 : 1));
        const kernels::CameraKey &a = part.camera_keys[from], &b = part.camera_keys[std::min(from + 1, part.camera_keys.size() - 1)];
        const double between = position - static_cast<double>(from);
        const auto place = [&](const kernels::CameraKey& k) { return part.render_origin + glm::dvec3(k.position.x, k.position.y, k.position.z); };
        const auto rotation = [](const kernels::CameraKey& k) { return glm::normalize(glm::dquat(k.rotation[3], k.rotation[0], k.rotation[1], k.rotation[2])); };
        const auto project = [&](const glm::dvec3& at, const glm::dquat& turned, double tan_half, const glm::dvec3& point) {
            const glm::dvec3 seen = glm::conjugate(turned) * (point - at);
            return glm::dvec2(seen) / -seen.z * (0.5 * stage.shot.image.height / tan_half);
        };
        const glm::dvec3 subject = truth.position + truth.rotation * glm::dvec3(0, 0, -truth.subject_distance);
        const glm::dvec2 is = project(glm::mix(place(a), place(b), between), slerp_shorter(rotation(a), rotation(b), between),
                                      std::lerp<double, double, double>(a.tan_half_height, b.tan_half_height, between), subject);
        worst = std::max(worst, glm::distance(is, project(truth.position, truth.rotation, truth.tan_half_height, subject)));
    }
    return worst;
}

void expect_instances_met(const Stage& stage, int node, const std::string& what) {
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    EXPECT_GT(parts.size(), 1u) << what;  // or the case says nothing
    double weights = 0;
    for (const SceneSnapshot& part : parts) {
        const double reported = part.motion.max_error_px, truth = worst_error_px(stage, part, 0, node, 2000);
        EXPECT_LE(reported, kMotionMargin * stage.shot.render.motion_tolerance_px) << what;
        EXPECT_LE(truth, kBetween * reported + kFloats) << what;
        weights += part.weight;
    }
    EXPECT_NEAR(weights, 1, 1e-12) << what;
    EXPECT_TRUE(motion_report(stage.bind(), parts).met()) << what;
}

TEST(ShutterSplit, StrongShearWithFastTurns) {
    std::mt19937 random(kSeed);
    for (int round = 0; round < 5; ++round) expect_instances_met(sheared(random), 1, "round " + std::to_string(round) + ", seed " + std::to_string(kSeed));
}

TEST(ShutterSplit, CornersOfPathsBesideTheGrid) {
    std::mt19937 random(kSeed);
    for (int round = 0; round < 5; ++round) {
        Stage stage = full_hd();
        const int node = stage.add_node("Shaker");
        stage.animate(node).translation = track<glm::dvec3>(jolts(random, 0, 1));
        expect_instances_met(stage, node, "round " + std::to_string(round) + ", seed " + std::to_string(kSeed));
    }
}

TEST(ShutterSplit, ACameraThatOrbitsOnceInOneExposure) {
    Stage stage = full_hd();
    stage.add_node("Cube");
    OrbitMotion orbit;
    orbit.radius_m = Track<double>(5.0);
    orbit.turns = track<double>({{0, 0}, {1, 1}});
    stage.shot.camera.position.orbit = orbit;
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    EXPECT_GT(parts.size(), 1u);
    for (const SceneSnapshot& part : parts) {
        EXPECT_LE(part.camera_error_px, kMotionMargin * stage.shot.render.motion_tolerance_px);
        EXPECT_LE(camera_error_px(stage, part, 2000), kBetween * part.camera_error_px + kFloats);
    }
    EXPECT_TRUE(motion_report(stage.bind(), parts).met());
}

TEST(ShutterSplit, ACameraThatIsJolted) {
    std::mt19937 random(kSeed);
    for (int round = 0; round < 3; ++round) {
        Stage stage = full_hd();
        stage.add_node("Cube");
        stage.shot.camera.position = track<glm::dvec3>(jolts(random, 5, 0.5));
        const std::vector<SceneSnapshot> parts = stage.snapshots();
        EXPECT_GT(parts.size(), 1u);
        for (const SceneSnapshot& part : parts) {
            EXPECT_LE(part.camera_error_px, kMotionMargin * stage.shot.render.motion_tolerance_px) << "seed " << kSeed;
            EXPECT_LE(camera_error_px(stage, part, 2000), kBetween * part.camera_error_px + kFloats) << "seed " << kSeed;
        }
    }
}

TEST(ShutterSplit, ALightThatFlickersAtOddTimes) {
    Stage stage;
    stage.add_node("Cube");
    LightSpec light;
    light.strength = track<double>({{0, 1.0}, {0.2371, 5.0}, {0.6113, 0.5}, {1, 2.0}});
    stage.shot.lights.push_back(light);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    EXPECT_GT(parts.size(), 1u);
    for (const SceneSnapshot& part : parts) {
        EXPECT_LE(part.light_error, kLightTolerance);
        const LightKeys keys = part.lights.at(0);
        const auto radiance = [&](std::size_t k) { return static_cast<double>(part.light_keys[keys.first + k].radiance.x); };
        double worst = 0;
        for (int i = 0; i <= 3000; ++i) {
            const double u = i / 3000.0, position = u * (keys.count - 1);
            const auto from = std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(std::max(keys.count, 2u) - 2));
            const double is = keys.count > 1 ? std::lerp(radiance(from), radiance(from + 1), position - static_cast<double>(from)) : radiance(0);
            const double truth = evaluate(light.strength, std::lerp(part.open_s, part.close_s, u)) * evaluate(light.color, 0).x;
            worst = std::max(worst, std::abs(is - truth) / std::max(radiance(from), radiance(std::min<std::size_t>(from + 1, keys.count - 1))));
        }
        // The reported one is the larger: a colour's length over the same length. Floats: 2^-23.
        EXPECT_LE(worst, kBetween * part.light_error + 1e-6);
    }
}

TEST(ShutterSplit, NoPartGetsLessThanOneSample) {
    std::mt19937 random(kSeed);
    for (const int samples : {1, 2, 3, 8}) {
        Stage stage = full_hd();
        stage.shot.render.samples = samples;
        stage.shot.render.motion_tolerance_px = 0.001;
        stage.animate(stage.add_node("Shaker")).translation = track<glm::dvec3>(jolts(random, 0, 1));
        const std::vector<SceneSnapshot> parts = stage.snapshots();
        EXPECT_EQ(parts.size() > 1, samples > 1) << samples;
        for (const SceneSnapshot& part : parts) EXPECT_GE(part.weight * samples, 1 - 1e-9) << samples;
        EXPECT_EQ(motion_report(stage.bind(), parts).met(), samples == 8) << samples;  // three corners make four parts
    }
}

TEST(ShutterSplit, EndsAtAStatedNumberOfParts) {
    // Beyond all reason: a tolerance of a thousandth of a pixel for a body that is shaken without end.
    Stage stage = full_hd();
    stage.shot.render.samples = 4096;
    stage.shot.render.motion_tolerance_px = 0.001;
    std::vector<std::pair<double, glm::dvec3>> keys;
    for (int i = 0; i <= 400; ++i) keys.push_back({i / 399.7, {i % 2 ? 1.0 : -1.0, 0.01 * (i % 7), 0}});
    const int node = stage.add_node("Shaker");
    stage.animate(node).translation = track<glm::dvec3>(keys);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    EXPECT_EQ(parts.size(), static_cast<std::size_t>(kMostPartsForError));
    const MotionReport report = motion_report(stage.bind(), parts);
    EXPECT_FALSE(report.met());
    EXPECT_EQ(report.worst, "node 'stage/Shaker'");
    double worst = 0;
    for (const SceneSnapshot& part : parts) worst = std::max(worst, worst_error_px(stage, part, 0, node, 4000));
    // The report is a bound, up to the cosine of the picture's corner above what is seen there; dense steps of 8e-6 s
    // miss corners that are 2.5e-3 s apart by less than a fiftieth.
    const CameraState camera = camera_at(stage.bind(), 0);
    EXPECT_LE(worst, report.instances_px);
    EXPECT_GE(worst * std::sqrt(1 + camera.tan_half_width * camera.tan_half_width + camera.tan_half_height * camera.tan_half_height), 0.98 * report.instances_px);
}

TEST(ShutterSplit, WhatIsMetStaysWhole) {
    Stage stage = full_hd();
    stage.animate(stage.add_node("Cube")).rotation = track<glm::dquat>({{0, turn(0)}, {1, turn(90)}});
    EXPECT_EQ(stage.snapshots().size(), 1u);
}

TEST(ShutterSplit, WhatIsReportedCountsCornersBesideTheGrid) {
    // One sample, so nothing is split; the corner lies a twentieth of a step after a frame, far from where fits look.
    Stage stage = full_hd();
    stage.shot.render.samples = 1;
    const int node = stage.add_node("Cube");
    stage.animate(node).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {24.05 / 128, {1, 0, 0}}, {1, {-1, 0.5, 0}}});
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_GT(parts[0].motion.max_error_px, 0.1);
    EXPECT_LE(worst_error_px(stage, parts[0], 0, node, 12800), parts[0].motion.max_error_px + kFloats);
}

TEST(ShutterSplit, PathsAreSplitInTheirCorners) {
    // Both sides of a corner are straight: no more frames than two, and no error.
    Stage stage = full_hd();
    stage.animate(stage.add_node("Cube")).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {0.1931, {1, 0, 0}}, {1, {-1, 0.5, 0}}});
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].close_s, 0.1931);
    EXPECT_EQ(parts[1].open_s, 0.1931);
    for (const SceneSnapshot& part : parts) {
        EXPECT_EQ(part.motion.headers[0].frame_count, 2u);
        EXPECT_LT(part.motion.max_error_px, 1e-9);
    }
}

TEST(ShutterSplit, AFocusThatFollowsANodeIsSplitInTheCornersOfItsPath) {
    Stage stage = full_hd();
    stage.add_node("Cube");
    const int node = stage.add_node("Focus", -1, false);
    stage.animate(node).translation = track<glm::dvec3>({{0, {0, 0, 4}}, {0.1931, {0, 0, 0}}, {1, {0, 0, -1}}});
    stage.shot.camera.focal_length_mm = Track<double>(200.0);
    stage.shot.camera.f_stop = Track<double>(1.0);
    stage.shot.camera.focus = NodeReference{"stage/Focus", {}};
    std::vector<double> closings;
    for (const SceneSnapshot& part : stage.snapshots()) closings.push_back(part.close_s);
    EXPECT_THAT(closings, testing::Contains(0.1931));
}

TEST(ShutterSplit, CopiesAreSplitInTheCornersOfTheirOwnTime) {
    Stage stage = full_hd();
    stage.animate(stage.add_node("Cube")).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {2, {0, 0, 0}}, {2.1931, {1, 0, 0}}, {3, {-1, 0.5, 0}}});
    stage.shot.scenes[0].instances.emplace().list = {{{0, 0, 0}, {1, 0, 0, 0}, glm::dvec3(1), 2}};
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_NEAR(parts[0].close_s, 0.1931, 1e-15);
    for (const SceneSnapshot& part : parts) EXPECT_LT(part.motion.max_error_px, 1e-9);
}

}  // namespace
}  // namespace kadr::test
