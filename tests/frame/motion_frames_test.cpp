#include "frame/motion_frames.h"

#include <gmock/gmock.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cstddef>
#include <cstring>

#include "frame/decompose.h"
#include "frame/motion_report.h"
#include "stage.h"

namespace kadr {
namespace {

using test::kPi;
using test::message_of;
using test::Stage;
using test::track;
using test::turn;
using test::worst_error_px;

static_assert(offsetof(kernels::FrameSrt, axis) == 0 && offsetof(kernels::FrameSrt, angle) == 12 && offsetof(kernels::FrameSrt, scale) == 16 &&
              offsetof(kernels::FrameSrt, translation) == 28 && offsetof(kernels::FrameSrt, time) == 40);
static_assert(offsetof(kernels::FrameMatrix, matrix) == 0 && offsetof(kernels::FrameMatrix, time) == 48);
static_assert(offsetof(kernels::TransformHeader, first_frame) == 0 && offsetof(kernels::TransformHeader, frame_count) == 4);

float float_at(const void* bytes, std::size_t offset) {
    float value;
    std::memcpy(&value, static_cast<const std::byte*>(bytes) + offset, sizeof value);
    return value;
}

/// What every device relies on.
void expect_well_formed(const SceneSnapshot& snapshot) {
    const MotionFrames& motion = snapshot.motion;
    ASSERT_EQ(motion.headers.size(), snapshot.instances.size());
    ASSERT_EQ(motion.linear.size(), snapshot.instances.size());
    ASSERT_EQ(motion.types.size(), snapshot.instances.size());
    for (std::size_t i = 0; i < motion.headers.size(); ++i) {
        const auto [first, count] = motion.headers[i];
        ASSERT_GE(count, 1u);
        ASSERT_LE(count, 129u);
        EXPECT_TRUE(!motion.linear[i] || count <= 2);
        for (unsigned k = 0; k < count; ++k) {
            const bool srt = motion.types[i] == FrameType::srt;
            const float time = srt ? motion.srt[first + k].time : motion.matrices[first + k].time;
            EXPECT_EQ(time, count > 1 ? static_cast<float>(k / (count - 1.0)) : 0.0f);
            const Decomposition parts = frame_parts(motion, i, k);
            EXPECT_FALSE(is_singular(parts));
            EXPECT_TRUE(!srt || std::abs(motion.srt[first + k].angle) <= static_cast<float>(kPi));
            if (k == 0) continue;
            const Decomposition before = frame_parts(motion, i, k - 1);
            EXPECT_LE(glm::degrees(angle_between(before.rotation, parts.rotation)), 10 + 1e-4);  // float angles
            EXPECT_EQ(before.scale.z < 0, parts.scale.z < 0);
        }
    }
}

TEST(MotionFrames, HaveTheLayoutOfHiprt) {
    const kernels::FrameSrt srt = to_srt({turn(90), {2, 3, 4}, {0, 0, 0}, {5, 6, 7}}, 0.5f, nullptr);
    EXPECT_EQ(float_at(&srt, 8), 1.0f);  // axis z
    EXPECT_FLOAT_EQ(float_at(&srt, 12), static_cast<float>(kPi / 2));
    EXPECT_EQ(float_at(&srt, 16), 2.0f);
    EXPECT_EQ(float_at(&srt, 36), 7.0f);
    EXPECT_EQ(float_at(&srt, 40), 0.5f);
    const kernels::FrameMatrix matrix = to_matrix({turn(0), {2, 3, 4}, {0.5, 0, 0}, {5, 6, 7}}, 0.5f);
    EXPECT_EQ(float_at(&matrix, 4), 0.5f);   // row 0, column 1
    EXPECT_EQ(float_at(&matrix, 12), 5.0f);  // row 0, column 3: the translation
    EXPECT_EQ(float_at(&matrix, 40), 4.0f);  // row 2, column 2
    EXPECT_EQ(float_at(&matrix, 48), 0.5f);
}

TEST(MotionFrames, NinetyDegreesAboutZTakeXToY) {
    Stage stage;
    stage.node(stage.add_node("a")).rotation = turn(90);
    const SceneSnapshot snapshot = stage.snapshot();
    const glm::dvec4 moved = interpolate(snapshot.motion, 0, 0) * glm::dvec4(1, 0, 0, 1);
    EXPECT_LT(glm::distance(moved, glm::dvec4(0, 1, 0, 1)), 1e-6);  // a float angle
}

TEST(MotionFrames, OneFrameWhenStill) {
    Stage stage;
    const int node = stage.add_node("a");
    stage.animate(node).translation = track<glm::dvec3>({{2, {0, 0, 0}}, {3, {1, 0, 0}}});
    stage.add_node("b");
    const SceneSnapshot snapshot = stage.snapshot();  // before the motion starts
    expect_well_formed(snapshot);
    EXPECT_EQ(snapshot.motion.headers[0].frame_count, 1u);
    EXPECT_EQ(snapshot.motion.headers[1].frame_count, 1u);
    EXPECT_EQ(snapshot.instances[0].id, 1u);  // what never moves comes first
    EXPECT_EQ(snapshot.instances[0].fixed_place, 0);
    EXPECT_EQ(snapshot.instances[1].fixed_place, -1);
    EXPECT_EQ(stage.snapshot(2).motion.headers[0].frame_count, 1u);
    EXPECT_EQ(stage.snapshot(2).motion.headers[1].frame_count, 2u);
}

TEST(MotionFrames, OneFrameWithoutMotionBlur) {
    Stage stage;
    stage.animate(stage.add_node("a")).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 0, 0}}});
    stage.shot.shutter = {0.25, 0.25};
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.motion.headers[0].frame_count, 1u);
    EXPECT_EQ(snapshot.motion.srt[0].translation[0], 0.25f);
    EXPECT_EQ(snapshot.weight, 1);
}

TEST(MotionFrames, AStraightPathIsTwoLinearFrames) {
    Stage stage;
    stage.animate(stage.add_node("a")).translation = track<glm::dvec3>({{-1, {-1, 0, 0}}, {2, {2, 0, 0}}});
    const SceneSnapshot snapshot = stage.snapshot();
    expect_well_formed(snapshot);
    EXPECT_EQ(snapshot.motion.headers[0].frame_count, 2u);
    EXPECT_EQ(snapshot.motion.linear[0], 1);
    EXPECT_LT(snapshot.motion.max_error_px, 1e-9);
}

/// Slerp would follow the turn exactly; what a device may take instead cuts its corner, and that is what is said.
TEST(MotionFrames, ASmallTurnIsAsFarOffAsLinearMatricesAre) {
    Stage stage;
    stage.animate(stage.add_node("a")).rotation = track<glm::dquat>({{0, test::turn(0)}, {1, test::turn(0.5)}});
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.motion.linear[0], 1);
    // Corners of [-1, 1]^3 are sqrt(2) from the axis and seen from 4 to 6 m; half-way they are 1 - cos of a quarter of the turn nearer.
    const double turned = 0.25 * glm::radians(0.5 * (snapshot.close_s - snapshot.open_s)), off = std::sqrt(2.0) * (1 - std::cos(2 * turned));
    const double pixel = 2.0 * snapshot.camera_keys[0].tan_half_height / stage.shot.image.height;
    EXPECT_GT(snapshot.motion.max_error_px, 0.5 * off / (6 * pixel));
    EXPECT_LT(snapshot.motion.max_error_px, 2 * off / (4 * pixel));
}

TEST(MotionFrames, FollowAQuarterTurnWithinTheTolerance) {
    for (const double degrees : {5.0, 45.0, 90.0, 170.0, 500.0, 1200.0}) {
        Stage stage;
        const int node = stage.add_node("a");
        stage.shot.scenes[0].transform.rotate.axis_angle =
            RotationTrack::AxisAngle{glm::normalize(glm::dvec3(1, 2, 3)), track<double>({{0, 0}, {1, glm::radians(degrees)}})};
        const SceneSnapshot snapshot = stage.snapshot();
        expect_well_formed(snapshot);
        EXPECT_GE(snapshot.motion.headers[0].frame_count, static_cast<unsigned>(degrees / 10 + 0.999) + 1) << degrees;
        EXPECT_LE(worst_error_px(stage, snapshot, 0, node), 0.1 + 1e-3) << degrees;  // plus what floats add
    }
}

TEST(MotionFrames, FollowAnOrbitingChild) {
    Stage stage;
    const int arm = stage.add_node("arm", -1, false);
    const int child = stage.add_node("child", arm);
    stage.node(child).translation = {1.5, 0, 0};
    stage.animate(arm).rotation = track<glm::dquat>({{0, turn(0)}, {0.5, turn(50)}, {1, turn(60)}});
    const SceneSnapshot snapshot = stage.snapshot();
    expect_well_formed(snapshot);
    EXPECT_LE(worst_error_px(stage, snapshot, 0, child), 0.1 + 1e-3);
    EXPECT_LE(snapshot.motion.max_error_px, 0.1);
    EXPECT_EQ(snapshot.motion.linear[0], 0);
    EXPECT_EQ((snapshot.motion.headers[0].frame_count - 1) % 2, 0u);  // the key at 0.5 lies on the grid
}

TEST(MotionFrames, HaveAFrameWhereTheClipHasAKey) {
    Stage stage;
    stage.animate(stage.add_node("a")).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1 / 3.0, {1, 0, 0}}, {1, {0, 0, 0}}});
    const SceneSnapshot snapshot = stage.snapshot();
    const kernels::TransformHeader header = snapshot.motion.headers[0];
    ASSERT_EQ(header.frame_count, 4u);  // beside the grid it would take all 129
    EXPECT_EQ(snapshot.motion.srt[header.first_frame + 1].translation[0], 1);
    EXPECT_LT(snapshot.motion.max_error_px, 1e-9);
}

TEST(MotionFrames, ShearUnderARotatingStretchedParentUsesMatrices) {
    Stage stage;
    const int parent = stage.add_node("parent", -1, false);
    const int child = stage.add_node("child", parent);
    stage.add_node("still");
    stage.node(parent).scale = {1, 2.5, 1};
    stage.node(child).rotation = turn(20, {1, 1, 0});
    stage.animate(child).rotation = track<glm::dquat>({{0, turn(0, {1, 1, 1})}, {1, turn(100, {1, 1, 1})}});
    const SceneSnapshot snapshot = stage.snapshot();
    expect_well_formed(snapshot);
    // What stands still comes first, and does not pay for the other's shear.
    EXPECT_EQ(snapshot.instances[0].id, 1u);
    EXPECT_EQ(snapshot.motion.types[0], FrameType::srt);
    EXPECT_EQ(snapshot.motion.srt.size(), 1u);
    EXPECT_EQ(snapshot.motion.types[1], FrameType::matrix);
    EXPECT_LE(worst_error_px(stage, snapshot, 1, child), 0.1 + 1e-3);
}

TEST(MotionFrames, MirrorsAndGeometryOffsetsAreKept) {
    Stage stage;
    stage.scene.geometries[0].centre = {0.3, -0.2, 0.1};
    stage.scene.geometries[0].scale = 0.5;
    const int node = stage.add_node("a");
    stage.node(node).scale = {-1, 1, 1};
    stage.animate(node).rotation = track<glm::dquat>({{0, turn(-60, {0, 1, 0})}, {1, turn(60, {0, 1, 0})}});
    const SceneSnapshot snapshot = stage.snapshot();
    expect_well_formed(snapshot);
    EXPECT_EQ(snapshot.motion.types[0], FrameType::srt);
    EXPECT_LE(worst_error_px(stage, snapshot, 0, node), 0.1 + 1e-3);
}

TEST(MotionFrames, AxesFlipInsteadOfAngles) {
    Stage stage;
    const int node = stage.add_node("a");
    stage.animate(node).rotation = track<glm::dquat>({{0, turn(-30)}, {1, turn(30)}});
    const SceneSnapshot snapshot = stage.snapshot();
    for (const kernels::FrameSrt& frame : snapshot.motion.srt) EXPECT_FLOAT_EQ(frame.axis[2], snapshot.motion.srt[0].axis[2]);
}

TEST(MotionFrames, AnythingThatGrowsFromNothingHasNoZeroScale) {
    Stage stage;
    const int node = stage.add_node("a");
    stage.node(node).rotation = turn(30, {1, 2, 3});
    stage.animate(node).scale = track<glm::dvec3>({{0.5, {0, 0, 0}}, {1, {1, 1, 1}}});
    const SceneSnapshot snapshot = stage.snapshot();
    expect_well_formed(snapshot);
    ASSERT_EQ(snapshot.instances.size(), 1u);
    EXPECT_LE(worst_error_px(stage, snapshot, 0, node), 0.1 + 1e-3);
}

TEST(MotionFrames, WhatHasNoSizeIsNotThere) {
    Stage stage;
    stage.node(stage.add_node("flat")).scale = {1, 0, 1};
    stage.animate(stage.add_node("hidden")).scale = track<glm::dvec3>({{2, {0, 0, 0}}, {3, {1, 1, 1}}});
    stage.add_node("seen");
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.instances.size(), 1u);
    EXPECT_EQ(snapshot.instances[0].id, 2u);  // ids do not depend on who is hidden
}

TEST(MotionFrames, NodesThatTurnInsideOutAreRefusedByName) {
    Stage stage;
    const int node = stage.add_node("door", stage.add_node("house", -1, false));
    stage.animate(node).scale = track<glm::dvec3>({{0, {1, 1, 1}}, {1, {-1, 1, 1}}});
    EXPECT_EQ(message_of([&] { stage.snapshot(); }),
              "stage.yaml:3:5: error: node 'stage/house/door' turns inside out (its scale passes through zero) within the shutter that opens at 0 s\n"
              "  expected scales that keep their sign; use a step key to mirror an object");
}

TEST(MotionFrames, PlacesThatAreNotFiniteAreRefusedByName) {
    Stage stage;
    stage.node(stage.add_node("far")).translation = {1e308 * 10, 0, 0};
    EXPECT_EQ(message_of([&] { stage.snapshot(); }),
              "stage.yaml:3:5: error: node 'stage/far' has a transform that is not finite at 0 s\n"
              "  expected finite translations, rotations and scales");
}

TEST(MotionFrames, WhatFloatsCannotHoldBesideEachOtherIsRefusedByName) {
    Stage far;
    far.node(far.add_node("star")).translation = {2e17, 0, 0};
    EXPECT_EQ(message_of([&] { far.snapshot(); }), "stage.yaml:3:5: error: node 'stage/star' reaches 2e+17 m from the camera at 0 s\n  expected at most 1e+17 m");
    Stage tiny;
    tiny.add_node("house");
    tiny.node(tiny.add_node("atom")).scale = glm::dvec3(1e-20);
    EXPECT_EQ(message_of([&] { tiny.snapshot(); }),
              "stage.yaml:3:5: error: node 'stage/atom' is 1e-20 m large in a picture of 1 m at 0 s\n  expected at least 1e-12 of what the picture shows; make it larger, or leave it out");
    Stage away;
    away.add_node("house");
    away.shot.camera.position = glm::dvec3(0, 0, 2e17);
    EXPECT_EQ(message_of([&] { away.snapshot(); }),
              "stage.yaml:9:1: error: the camera is 2e+17 m from what it looks at, or moves that far, at 0 s\n  expected at most 1e+17 m");
}

TEST(MotionFrames, WhatIsFarAwayTogetherIsNot) {
    Stage stage;
    stage.node(stage.add_node("star")).translation = {2e17, 0, 0};
    stage.shot.camera.position = glm::dvec3(2e17, 0, 1000);
    stage.shot.camera.look_at = Track<glm::dvec3>(glm::dvec3(2e17, 0, 0));
    EXPECT_EQ(stage.snapshot().instances.size(), 1u);
}

TEST(MotionFrames, ArePreciseFarFromTheOrigin) {
    Stage stage;
    constexpr double kFar = 1e7;
    const int node = stage.add_node("a");
    stage.node(node).translation = {kFar, 0.1, 0};
    stage.shot.camera.position = glm::dvec3(kFar, 0, 5);
    stage.shot.camera.look_at = Track<glm::dvec3>(glm::dvec3(kFar, 0, 0));
    stage.animate(node).translation = track<glm::dvec3>({{0, {kFar, 0.1, 0}}, {1, {kFar + 1, 0.1, 0}}});
    const SceneSnapshot snapshot = stage.snapshot();
    expect_well_formed(snapshot);
    EXPECT_LT(std::abs(snapshot.motion.srt[0].translation[0]), 512.0f);
    EXPECT_LE(worst_error_px(stage, snapshot, 0, node), 0.02);  // 320 m in floats: 3e-5 m, seen at 1920 px / m / 5 m
}

TEST(MotionFrames, AreMadeOfAHundredThousandMovingNodes) {
    Stage stage;
    for (int i = 0; i < 100'000; ++i) {
        const int node = stage.add_node("n");
        const glm::dvec3 at(i % 300 - 150, (i / 300) % 300 - 150, -200 - i % 7);
        stage.animate(node).translation = track<glm::dvec3>({{0, at}, {10, at + glm::dvec3(1, 0, 0)}});
        stage.scene.clips[0].channels.back().rotation = track<glm::dquat>({{0, turn(0)}, {10, turn(50)}});
    }
    const BoundShot bound = stage.bind();
    const SceneSnapshot snapshot = make_snapshots(bound, bound.sequence().frame(1)).front();
    EXPECT_EQ(snapshot.instances.size(), 100'000u);  // how long it takes is instances_bench's
}

RC_GTEST_PROP(MotionFramesProperty, ErrorStaysWithinTheTolerance, ()) {
    const auto number = [](double scale) { return *rc::gen::inRange(-100, 101) / 100.0 * scale; };
    const auto rotation = [&] {
        const glm::dquat q(number(1) + 0.01, number(1), number(1), number(1));
        return glm::length(q) > 0.1 ? glm::normalize(q) : glm::dquat(1, 0, 0, 0);
    };
    Stage stage;
    const int parent = stage.add_node("parent", -1, false), child = stage.add_node("child", parent);
    stage.node(parent).scale = {1, 1 + std::abs(number(1)), 1};
    auto& channels = stage.animate(child);
    channels.rotation = track<glm::dquat>({{0, rotation()}, {*rc::gen::inRange(1, 8) / 8.0, rotation()}, {1.5, rotation()}});
    channels.translation = track<glm::dvec3>({{-0.5, {number(1), number(1), number(1)}}, {1.5, {number(1), number(1), number(1)}}}, Interpolation::smooth);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    double weights = 0;
    for (const SceneSnapshot& snapshot : parts) {
        expect_well_formed(snapshot);
        weights += snapshot.weight;
        RC_ASSERT(worst_error_px(stage, snapshot, 0, child, 300) <= 0.1 + 1e-2);  // plus what floats add
        RC_ASSERT(snapshot.motion.max_error_px <= 0.09);
    }
    RC_ASSERT(std::abs(weights - 1) < 1e-12);
}

/// A node that turns by so much in the shutter, half a metre from the axis.
Stage turning(double degrees, FixedMotionFrames frames) {
    Stage stage;
    const int arm = stage.add_node("arm", -1, false);
    stage.node(stage.add_node("hand", arm)).translation = {0.5, 0, 0};
    stage.shot.scenes[0].transform.rotate.axis_angle = RotationTrack::AxisAngle{glm::dvec3(0, 0, 1), track<double>({{0, 0}, {1, glm::radians(degrees)}})};
    stage.shot.render.motion_frames = frames;
    return stage;
}

TEST(FixedMotionFrames, AreAsManyAsTheShotSays) {
    for (const int count : {2, 3, 7, 129}) {
        const Stage stage = turning(60, {count, MotionMix::srt});
        const SceneSnapshot snapshot = stage.snapshot();
        ASSERT_EQ(snapshot.motion.headers[0].frame_count, static_cast<unsigned>(count));
        EXPECT_EQ(snapshot.motion.linear[0], 0);
        EXPECT_FALSE(snapshot.motion.mixes_matrices);
        EXPECT_NEAR(snapshot.motion.widest_step_rad, glm::radians(60.0) / (count - 1), 1e-9);
        // Rotations follow the arc, places beside the axis the chord.
        EXPECT_GE(1.05 * snapshot.motion.max_error_px + 1e-3, worst_error_px(stage, snapshot, 0, 1));
    }
    EXPECT_EQ(turning(0, {7, MotionMix::srt}).snapshot().motion.headers[0].frame_count, 1u);  // it does not move
}

TEST(FixedMotionFrames, OfMatricesSayHowFarTheyCutCorners) {
    double before = 1e9;
    for (const int count : {2, 3, 5, 9}) {
        const Stage stage = turning(40, {count, MotionMix::matrix});
        const SceneSnapshot snapshot = stage.snapshot();
        EXPECT_EQ(snapshot.motion.linear[0], 1);
        EXPECT_TRUE(snapshot.motion.mixes_matrices);
        // Along every way, not only in the three places of a segment that the fit looks at; projected, where it has a bound.
        const double true_px = worst_error_px(stage, snapshot, 0, 1), said_px = snapshot.motion.max_error_px;
        EXPECT_GE(said_px, 0.95 * true_px) << count;
        EXPECT_LE(said_px, 1.3 * true_px) << count;
        EXPECT_NEAR(before / true_px, 4, count > 2 ? 0.5 : 1e9) << count;  // a chord is off by the square of its angle
        before = true_px;
    }
}

TEST(FixedMotionFrames, KeepTheShutterInOnePartAndReportWhatTheyMiss) {
    Stage stage = turning(80, {3, MotionMix::matrix});
    EXPECT_EQ(stage.snapshots().size(), 1u);
    const BoundShot bound = stage.bind();
    const MotionReport report = motion_report(bound, make_snapshots(bound, bound.sequence().frame(0)));
    EXPECT_FALSE(report.met());
    EXPECT_EQ(report.frames, 3u);
    EXPECT_EQ(report.worst, "node 'stage/arm/hand'");
    stage.shot.render.motion_frames.reset();
    EXPECT_GE(stage.snapshot().motion.headers[0].frame_count, 9u);
}

TEST(FixedMotionFrames, ThatLeadTheWrongWayAreRefused) {
    EXPECT_THAT(message_of([] { turning(200, {2, MotionMix::srt}).snapshots(); }),
                testing::HasSubstr("node 'stage/arm/hand' turns by 200 degrees from one of the 2 motion frames (render.motion_frames) to the next in the shutter that opens"));
    EXPECT_THAT(message_of([] { turning(175, {2, MotionMix::matrix}).snapshots(); }), testing::HasSubstr("take more frames, `mix: srt` or `motion_frames: auto`"));
    EXPECT_EQ(message_of([] { turning(175, {2, MotionMix::srt}).snapshots(); }), "no error");
    EXPECT_EQ(message_of([] { turning(200, {3, MotionMix::matrix}).snapshots(); }), "no error");
}

}  // namespace
}  // namespace kadr
