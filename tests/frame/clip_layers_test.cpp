// Layers of clips: their times, their mix, and what the shutter has to know about both.
#include "frame/clip_layers.h"

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include "frame/bindings.h"
#include "frame/decompose.h"
#include "frame/layered_track.h"
#include "stage.h"

namespace kadr {
namespace {

using Loop = ClipLayer::Loop;
using test::kPi;
using test::Stage;
using test::track;
using test::turn;

PlayingLayer layer_of(Loop loop, double speed, double start_s, double in_s, double out_s, double at_s = 0) {
    PlayingLayer layer;
    layer.loop = loop, layer.speed = speed, layer.start_s = start_s, layer.in_s = in_s, layer.out_s = out_s, layer.at_s = at_s;
    return layer;
}

TEST(ClipTime, IsHeldRepeatedOrPlayedToAndFro) {
    struct Case {
        Loop loop;
        double speed, start_s, time_s, wanted_s;
    };
    // A clip cut to [1, 3].
    for (const Case& c : std::vector<Case>{
             {Loop::hold, 1, 1, 0, 1},       {Loop::hold, 1, 1, 1.5, 2.5},     {Loop::hold, 1, 1, 7, 3},        {Loop::hold, 1, 1, -7, 1},
             {Loop::hold, -1, 3, 0.5, 2.5},  {Loop::hold, -1, 3, 9, 1},        {Loop::hold, 2, 0, 0.25, 1},     {Loop::hold, 0, 2, 9, 2},
             {Loop::repeat, 1, 1, 0.5, 1.5}, {Loop::repeat, 1, 1, 2, 1},       {Loop::repeat, 1, 1, 7.25, 2.25}, {Loop::repeat, 1, 1, -0.5, 2.5},
             {Loop::repeat, -1, 3, 0, 3},    {Loop::repeat, -1, 3, 0.5, 2.5},  {Loop::repeat, -1, 3, 2, 3},     {Loop::repeat, -2, 3, 1.25, 2.5},
             {Loop::pingpong, 1, 1, 2, 3},   {Loop::pingpong, 1, 1, 2.5, 2.5}, {Loop::pingpong, 1, 1, 4, 1},    {Loop::pingpong, 1, 1, -0.5, 1.5},
             {Loop::pingpong, -1, 3, 0.5, 2.5}, {Loop::pingpong, -1, 3, 2.5, 1.5}})
        EXPECT_DOUBLE_EQ(layer_of(c.loop, c.speed, c.start_s, 1, 3).clip_time(c.time_s, 0), c.wanted_s)
            << static_cast<int>(c.loop) << " at " << c.speed << " from " << c.start_s << ", " << c.time_s << " s";
    EXPECT_DOUBLE_EQ(layer_of(Loop::repeat, 1, 1, 1, 3, 10).clip_time(10.5, 0), 1.5);   // at
    EXPECT_DOUBLE_EQ(layer_of(Loop::repeat, 2, 1, 1, 3, 10).clip_time(10.5, 0.25), 2.5);  // and an offset of a copy
    EXPECT_DOUBLE_EQ(layer_of(Loop::repeat, 1, 1, 2, 2).clip_time(5, 0), 2);  // cut to an instant
}

RC_GTEST_PROP(ClipTimeProperty, StaysInsideAndBackwardsMirrorsForwards, ()) {
    const auto loop = *rc::gen::element(Loop::hold, Loop::repeat, Loop::pingpong);
    const double in = 0.001 * *rc::gen::inRange(0, 5000), length = 0.001 * *rc::gen::inRange(1, 5000);
    const double speed = 0.01 * *rc::gen::inRange(1, 1000), time = 0.001 * *rc::gen::inRange(-20000, 20000);
    const PlayingLayer forwards = layer_of(loop, speed, in, in, in + length), backwards = layer_of(loop, -speed, in + length, in, in + length);
    const double a = forwards.clip_time(time, 0), b = backwards.clip_time(time, 0);
    RC_ASSERT(a >= in && a <= in + length && b >= in && b <= in + length);
    // Mirrored at the clip's middle; at the very seam rounding may choose either side.
    const double difference = std::abs((a - in) - (in + length - b));
    RC_ASSERT(std::min(difference, loop == Loop::repeat ? std::abs(difference - length) : difference) < 1e-9);
}

RC_GTEST_PROP(ClipTimeProperty, PassesAreWhatTheClipTimeDoes, ()) {
    const auto loop = *rc::gen::element(Loop::hold, Loop::repeat, Loop::pingpong);
    const double in = 0.001 * *rc::gen::inRange(0, 2000), length = 0.001 * *rc::gen::inRange(20, 3000);
    const double speed = 0.01 * *rc::gen::inRange(1, 500) * *rc::gen::element(-1, 1), begin = 0.001 * *rc::gen::inRange(-5000, 5000);
    const PlayingLayer layer = layer_of(loop, speed, in + 0.3, in, in + length);
    const LayerWindow window = window_of(layer, begin, begin + 0.5, 0.125);
    double covered = 0;
    for (const ClipPass& pass : window.passes) {
        covered += pass.high_s() - pass.low_s();
        for (const double u : {0.01, 0.5, 0.99}) {
            const double time = std::lerp(pass.begin_s, pass.end_s, u), clip = std::lerp(pass.from_s, pass.to_s, u);
            RC_ASSERT(std::abs(layer.clip_time(time, 0.125) - clip) < 1e-9);
            RC_ASSERT(std::abs(pass.shot_time(clip) - time) < 1e-9);
        }
    }
    if (loop != Loop::hold) RC_ASSERT(std::abs(covered - 0.5 * std::abs(speed)) < 1e-9);
}

// An interval that ends on a seam but for rounding had an empty pass beyond it: shot_time divided nothing by nothing, and
// the passes' ends lay on the other side of the seam than clip_time. Found by the property above.
TEST(ClipTime, PassesAreNeverEmpty) {
    struct Case {
        Loop loop;
        double speed, in_s, length_s, begin_s;
    };
    for (const Case& c : std::vector<Case>{{Loop::repeat, 2.46, 1.93, 1.909, -3.075}, {Loop::repeat, -1.85, 1.616, 0.5, -2.125}, {Loop::pingpong, 4.85, 1.769, 2.511, 3.455},
                                           {Loop::repeat, -2.25, 1.135, 0.025, -4.725}, {Loop::repeat, 2.4, 0.92, 0.058, -3.215}}) {
        const PlayingLayer layer = layer_of(c.loop, c.speed, c.in_s + 0.3, c.in_s, c.in_s + c.length_s);
        const LayerWindow window = window_of(layer, c.begin_s, c.begin_s + 0.5, 0.125);
        ASSERT_FALSE(window.passes.empty());
        for (const ClipPass& pass : window.passes) {
            EXPECT_GT(pass.high_s() - pass.low_s(), 1e-9);
            EXPECT_NEAR(pass.shot_time(pass.to_s), pass.end_s, 1e-9);
            EXPECT_NEAR(layer.clip_time(std::lerp(pass.begin_s, pass.end_s, 0.5), 0.125), std::lerp(pass.from_s, pass.to_s, 0.5), 1e-9);
        }
    }
}

// Frames that fall on a seam: 17 frames played again and again, at any frame rate. By rounding alone a third of them
// showed the end of the pass before.
TEST(ClipTime, FramesOnASeamBeginTheNextPass) {
    constexpr double kUlps = 1e-12;  // a few of 80 s
    for (const double fps : {24.0, 25.0, 30.0, 24000 / 1001.0})
        for (int frames = 1; frames <= 48; ++frames)
            for (int pass = -20; pass <= 40; ++pass) {
                const double seam_s = (frames * pass) / fps, length_s = frames / fps;
                EXPECT_NEAR(layer_of(Loop::repeat, 1, 0, 0, length_s).clip_time(seam_s, 0), 0, kUlps) << frames << " frames, pass " << pass << " at " << fps;
                EXPECT_NEAR(layer_of(Loop::repeat, -1, length_s, 0, length_s).clip_time(seam_s, 0), length_s, kUlps) << frames << " frames, pass " << pass << " at " << fps;
                EXPECT_NEAR(layer_of(Loop::repeat, 1, 0, 0, length_s, 7 / fps).clip_time((frames * pass + 7) / fps, 0), 0, kUlps) << frames << " frames, pass " << pass << " at " << fps;
            }
}

TEST(ClipTime, OfATinyLoopInALongWindowIsCountedNotListed) {
    const PlayingLayer layer = layer_of(Loop::repeat, 1000, 0, 0, 1e-3);
    const LayerWindow window = window_of(layer, 0, 3600, 0);
    EXPECT_EQ(window.passes.size(), static_cast<std::size_t>(kMostPasses));
    EXPECT_NEAR(window.passes_left_out, 3.6e9 - kMostPasses, 2);
    EXPECT_LE(seams_of(window).size(), static_cast<std::size_t>(kMostPasses));
}

TEST(ClipTime, EndsWithTheFirstPass) {
    EXPECT_DOUBLE_EQ(layer_of(Loop::hold, 2, 1, 1, 3).end_s(), 1);
    EXPECT_DOUBLE_EQ(layer_of(Loop::hold, 1, 0, 1, 3, 5).end_s(), 8);
    EXPECT_DOUBLE_EQ(layer_of(Loop::hold, -2, 3, 1, 3).end_s(), 1);
    EXPECT_DOUBLE_EQ(layer_of(Loop::repeat, -2, 3, 1, 3, 1).end_s(), 2);
    EXPECT_DOUBLE_EQ(layer_of(Loop::pingpong, 1, 1, 1, 3).end_s(), 4);
    EXPECT_EQ(layer_of(Loop::repeat, 0, 1, 1, 3).end_s(), 0);
    PlayingLayer silent = layer_of(Loop::hold, 1, 0, 0, 9);
    silent.weight = Track<double>(0.0);
    EXPECT_EQ(silent.end_s(), 0);
}

// ---- The mean of rotations ----

glm::dquat random_rotation() {
    const auto component = [] { return 0.001 * *rc::gen::inRange(-1000, 1001); };
    const glm::dquat q(component(), component(), component(), component());
    return glm::length(q) > 0.05 ? glm::normalize(q) : glm::dquat(1, 0, 0, 0);
}

RC_GTEST_PROP(MeanRotationProperty, OfTwoIsTheSlerpOfTheShorterArc, ()) {
    const glm::dquat a = random_rotation(), b = random_rotation();
    RC_PRE(std::abs(glm::dot(a, b)) > 1e-3);
    const double u = 0.01 * *rc::gen::inRange(1, 100);
    const WeightedRotation mix[] = {{3 * (1 - u), a}, {3 * u, -b}};
    const glm::dquat mean = mean_rotation(mix);
    // The angles add up to the whole and are divided as the weights say.
    RC_ASSERT(std::abs(angle_between(a, mean) - u * angle_between(a, b)) < 1e-9);
    RC_ASSERT(std::abs(angle_between(b, mean) - (1 - u) * angle_between(a, b)) < 1e-9);
}

RC_GTEST_PROP(MeanRotationProperty, OfSeveralHasNoPullLeft, ()) {
    std::vector<WeightedRotation> mix;
    const glm::dquat around = random_rotation();
    for (int i = 0; i < 4; ++i) {
        const glm::dvec3 axis(*rc::gen::inRange(-9, 10), *rc::gen::inRange(-9, 10), *rc::gen::inRange(1, 10));
        const glm::dquat q = around * glm::angleAxis(0.01 * *rc::gen::inRange(0, 100), glm::normalize(axis));
        mix.push_back({0.1 * *rc::gen::inRange(1, 20), *rc::gen::arbitrary<bool>() ? q : -q});
    }
    const glm::dquat mean = mean_rotation(mix);
    glm::dvec3 pull(0);
    for (const WeightedRotation& r : mix) {
        const glm::dquat q = glm::conjugate(mean) * r.rotation;
        const double angle = angle_between(mean, r.rotation);
        const glm::dvec3 axis = glm::dvec3(q.x, q.y, q.z) * (q.w < 0 ? -1.0 : 1.0);
        if (angle > 1e-9) pull += r.weight * angle * glm::normalize(axis);
    }
    RC_ASSERT(glm::length(pull) < 1e-9);
    std::reverse(mix.begin(), mix.end());
    RC_ASSERT(angle_between(mean, mean_rotation(mix)) < 1e-9);
}

TEST(MeanRotation, OfTheSameIsTheSame) {
    const WeightedRotation mix[] = {{1, turn(40)}, {2, -turn(40)}, {0.5, turn(40)}};
    EXPECT_LT(angle_between(mean_rotation(mix), turn(40)), 1e-14);
}

// A rotation half a turn from the middle of the others is on neither side of it: the heaviest of them says which one.
TEST(MeanRotation, HalfATurnFromTheMiddleDependsOnNoSign) {
    const glm::dquat a = turn(30), b = turn(-90), c = turn(180);
    for (const double more : {-1e-12, 0.0, 1e-12})  // moves the middle, 0 degrees, by less than counts
        for (int signs = 0; signs < 8; ++signs) {
            std::vector<WeightedRotation> mix{{1, signs & 1 ? -a : a}, {0.5 + more, signs & 2 ? -b : b}, {0.25, signs & 4 ? -c : c}};
            for (int order = 0; order < 3; ++order) {
                EXPECT_NEAR(glm::degrees(angle_between(mean_rotation(mix), turn((30 - 0.5 * 90 + 0.25 * 180) / 1.75))), 0, 1e-9) << more << ' ' << signs << ' ' << order;
                std::rotate(mix.begin(), mix.begin() + 1, mix.end());
            }
        }
}

// ---- Layers of a scene ----

/// A node "arm" at (1, 2, 3), turned by 10 degrees and twice as large, and clips "a" and "b", two seconds each, that take
/// it elsewhere; "b" leaves its scale alone.
struct Arm : Stage {
    int arm;
    Arm() : arm(add_node("arm")) {
        node(arm).translation = {1, 2, 3};
        node(arm).rotation = turn(10);
        node(arm).scale = glm::dvec3(2);
        scene.clips.resize(2);
        scene.files[0].clip_count = 2;
        const auto fill = [&](std::size_t clip, const char* name, double x, double degrees) {
            scene.clips[clip] = {name, 0, 2, {}, 3};
            NodeChannels channels;
            channels.node = arm;
            channels.translation = track<glm::dvec3>({{0, {x, 0, 0}}, {2, {x + 2, 0, 0}}});
            channels.rotation = track<glm::dquat>({{0, turn(degrees)}, {2, turn(degrees + 60)}});
            scene.clips[clip].channels.push_back(channels);
        };
        fill(0, "a", 0, 0);
        fill(1, "b", 100, 40);
        scene.clips[0].channels[0].scale = Track<glm::dvec3>(glm::dvec3(6));
        shot.scenes[0].layers = {named("a"), named("b")};
    }
    static ClipLayer named(std::string clip) {
        ClipLayer layer;
        layer.clips = ClipLayer::Clips::one;
        layer.clip_name = std::move(clip);
        layer.where = {"stage.yaml", 4, 7};
        return layer;
    }
    Decomposition pose(double time_s) const { return decompose(bind().node_transforms(time_s)[static_cast<std::size_t>(arm)]); }
};

double degrees_of(const Decomposition& pose) { return glm::degrees(2 * std::atan2(pose.rotation.z, pose.rotation.w)); }

TEST(ClipLayers, CrossFadeFromOneClipToTheOther) {
    Arm stage;
    stage.layer(0).weight = track<double>({{0, 1}, {2, 0}});
    stage.layer(1).weight = track<double>({{0, 0}, {2, 1}});
    EXPECT_LT(glm::distance(stage.pose(0).translation, glm::dvec3(0, 0, 0)), 1e-12);
    EXPECT_NEAR(degrees_of(stage.pose(0)), 0, 1e-9);
    EXPECT_NEAR(stage.pose(0).scale.x, 6, 1e-12);
    // Half-way both clips are at 1 s: 1 and 101, 30 and 70 degrees; the scale is half that of "a" and half the node's own.
    EXPECT_LT(glm::distance(stage.pose(1).translation, glm::dvec3(51, 0, 0)), 1e-12);
    EXPECT_NEAR(degrees_of(stage.pose(1)), 50, 1e-9);
    EXPECT_NEAR(stage.pose(1).scale.x, 4, 1e-12);
    // A quarter in, at 0.5 s: 0.5 and 100.5, 15 and 55 degrees.
    EXPECT_LT(glm::distance(stage.pose(0.5).translation, glm::dvec3(25.5, 0, 0)), 1e-12);
    EXPECT_NEAR(degrees_of(stage.pose(0.5)), 25, 1e-9);
    EXPECT_LT(glm::distance(stage.pose(2).translation, glm::dvec3(102, 0, 0)), 1e-12);
    EXPECT_NEAR(degrees_of(stage.pose(2)), 100, 1e-9);
    EXPECT_NEAR(stage.pose(2).scale.x, 2, 1e-12);
}

TEST(ClipLayers, DivideWeightsByTheirSumAndFillUpWithTheNodesOwn) {
    Arm stage;
    stage.layer(0).weight = Track<double>(3.0);
    EXPECT_LT(glm::distance(stage.pose(1).translation, glm::dvec3(0.75 * 1 + 0.25 * 101, 0, 0)), 1e-12);
    EXPECT_NEAR(degrees_of(stage.pose(1)), 40, 1e-9);
    EXPECT_NEAR(stage.pose(1).scale.x, 6, 1e-12);  // "a" alone animates it
    stage.layer(0).weight = Track<double>(0.25);
    stage.layer(1).weight = Track<double>(0.0);
    EXPECT_LT(glm::distance(stage.pose(1).translation, 0.25 * glm::dvec3(1, 0, 0) + 0.75 * glm::dvec3(1, 2, 3)), 1e-12);
    EXPECT_NEAR(degrees_of(stage.pose(1)), 15, 1e-9);  // 30 and 10 degrees
    EXPECT_NEAR(stage.pose(1).scale.x, 3, 1e-12);
    stage.layer(0).weight = Track<double>(0.0);
    EXPECT_LT(glm::distance(stage.pose(1).translation, glm::dvec3(1, 2, 3)), 1e-12);
    EXPECT_TRUE(stage.bind().fixed_nodes()[0]);
}

TEST(ClipLayers, OfTwoClipsInOneTheLaterCounts) {
    Arm stage;
    ClipLayer all;
    stage.shot.scenes[0].layers = {all};
    EXPECT_LT(glm::distance(stage.pose(1).translation, glm::dvec3(101, 0, 0)), 1e-12);
    EXPECT_NEAR(stage.pose(1).scale.x, 6, 1e-12);
}

TEST(ClipLayers, PlayBackwardsFromOut) {
    Arm stage;
    stage.shot.scenes[0].layers = {stage.named("a")};
    stage.layer(0).speed = -1;
    EXPECT_LT(glm::distance(stage.pose(0.5).translation, glm::dvec3(1.5, 0, 0)), 1e-12);
    stage.layer(0).out_s = 1.5;
    EXPECT_LT(glm::distance(stage.pose(0.5).translation, glm::dvec3(1, 0, 0)), 1e-12);
    EXPECT_LT(glm::distance(stage.pose(5).translation, glm::dvec3(0, 0, 0)), 1e-12);
}

TEST(ClipLayers, SetTheLengthOfAShotThatGivesNone) {
    Arm stage;
    stage.shot.frames_given = false;
    stage.shot.timing.fps = {10, 1};
    EXPECT_EQ(stage.bind().timing().frames.back(), 20);
    stage.layer(0).loop = Loop::pingpong;
    EXPECT_EQ(stage.bind().timing().frames.back(), 40);
    stage.layer(0).weight = Track<double>(0.0);
    stage.layer(1).speed = 2;
    stage.layer(1).in_s = 1;
    stage.layer(1).at_s = 0.3;
    EXPECT_EQ(stage.bind().timing().frames.back(), 8);
}

TEST(ClipLayers, SplitTheShutterWhereALoopJumps) {
    Arm stage;
    stage.shot.scenes[0].layers = {stage.named("a")};
    stage.layer(0).loop = Loop::repeat;
    stage.layer(0).start_s = 1.6;
    const std::vector<SceneSnapshot> parts = stage.snapshots();  // 1 s of shutter: the seam is at 0.4 s
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_NEAR(parts[0].close_s, 0.4, 1e-12);
    EXPECT_NEAR(parts[0].weight, 0.4, 1e-12);
    // Nothing smears across: 1.6 to 2, then 0 to 0.6 (the render origin is near the camera at z = 5).
    const auto x = [](const SceneSnapshot& part, double time) { return interpolate(part.motion, 0, time)[3].x + part.render_origin.x; };
    EXPECT_NEAR(x(parts[0], 0), 1.6, 1e-5);
    EXPECT_NEAR(x(parts[0], 1), 2.0, 1e-5);
    EXPECT_NEAR(x(parts[1], 0), 0.0, 1e-5);
    EXPECT_NEAR(x(parts[1], 1), 0.6, 1e-5);
}

TEST(ClipLayers, DoNotSplitTheShutterWhereALoopCloses) {
    Arm stage;
    stage.shot.scenes[0].layers = {stage.named("a")};
    stage.scene.clips[0].channels[0].translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 0, 0}}, {2, {0, 0, 0}}});
    // Ends that agree but for the sign of a quaternion and the last place of a float.
    stage.scene.clips[0].channels[0].rotation = track<glm::dquat>({{0, turn(0)}, {1, turn(20)}, {2, -turn(1e-7)}});
    stage.layer(0).loop = Loop::repeat;
    stage.layer(0).start_s = 1.6;
    EXPECT_TRUE(stage.bind().bindings().rig.discontinuities(0, 10).empty());
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_LE(test::worst_error_px(stage, snapshot, 0, 0), 0.1);
    EXPECT_EQ(stage.snapshots().size(), 1u);
    stage.layer(0).loop = Loop::pingpong;
    EXPECT_TRUE(stage.bind().bindings().rig.discontinuities(0, 10).empty());
}

TEST(ClipLayers, SplitTheShutterAtStepsOfTheirWeights) {
    Arm stage;
    stage.layer(0).weight = track<double>({{0, 1}, {0.25, 0}}, Interpolation::step);
    const NodeRig rig = stage.bind().bindings().rig;
    EXPECT_THAT(rig.discontinuities(0, 1), testing::ElementsAre(0.25));
    ASSERT_EQ(stage.snapshots().size(), 2u);
}

// Half a turn apart, the mean of two rotations changes sides.
TEST(ClipLayers, SplitTheShutterWhereTheShorterArcFlips) {
    Arm stage;
    stage.scene.clips[0].channels[0].rotation = track<glm::dquat>({{0, turn(0)}, {2, turn(170)}});
    stage.scene.clips[1].channels[0].rotation = Track<glm::dquat>(-turn(-90));
    const BoundShot bound = stage.bind();
    const NodeRig& rig = bound.bindings().rig;
    const double flip = 2 * 90.0 / 170;
    ASSERT_EQ(rig.discontinuities(0.8, 1.4).size(), 1u);
    EXPECT_NEAR(rig.discontinuities(0.8, 1.4)[0], flip, 1e-12);
    EXPECT_TRUE(rig.discontinuities(0.2, 1).empty());
    EXPECT_NEAR(degrees_of(stage.pose(flip - 1e-6)), 0, 1e-3);
    EXPECT_NEAR(std::abs(degrees_of(stage.pose(flip + 1e-6))), 180, 1e-3);
}

TEST(ClipLayers, FindStepKeysInEveryPass) {
    Arm stage;
    stage.shot.scenes[0].layers = {stage.named("a")};
    NodeChannels& channels = stage.scene.clips[0].channels[0];
    channels.rotation.reset();
    channels.translation = track<glm::dvec3>({{0, {0, 0, 0}}, {0.5, {1, 0, 0}}, {1.5, {0, 0, 0}}}, Interpolation::step);
    stage.layer(0).loop = Loop::repeat;  // its ends agree
    stage.layer(0).speed = -1;
    EXPECT_THAT(stage.bind().bindings().rig.discontinuities(0, 4), testing::UnorderedElementsAre(0.5, 1.5, 2.5, 3.5));
    EXPECT_THAT(stage.bind().bindings().rig.discontinuities(0, 4, 0.25), testing::UnorderedElementsAre(0.25, 1.25, 2.25, 3.25));
}

TEST(ClipLayers, WithoutWeightDoNotSplitTheShutter) {
    Arm stage;
    stage.layer(0).loop = Loop::repeat;
    stage.layer(0).weight = track<double>({{0, 1}, {1, 0}});
    EXPECT_FALSE(stage.bind().bindings().rig.discontinuities(1.5, 2.5, 1).empty() && stage.bind().bindings().rig.discontinuities(-0.5, 0.5).empty());
    EXPECT_TRUE(stage.bind().bindings().rig.discontinuities(3.5, 4.5).empty());  // a seam at 4 s, faded out long before
}

TEST(ClipLayers, MeetTheMotionToleranceWhileTheyFade) {
    Arm stage;
    stage.scene.geometries[0].scale = 0.3;
    stage.node(stage.arm).translation = {0, 0, 0};
    for (std::size_t clip = 0; clip < 2; ++clip) {
        NodeChannels& channels = stage.scene.clips[clip].channels[0];
        channels.translation = track<glm::dvec3>({{0, {0.2, 0, 0}}, {0.7, {0, clip ? 0.5 : -0.5, 0}}, {2, {0.2, 0, 0.4}}});
        channels.rotation = track<glm::dquat>({{0, turn(0)}, {0.3, turn(clip ? 60 : -50, {1, 1, 0})}, {2, turn(60, {0, 1, 0})}}, Interpolation::smooth);
    }
    stage.layer(0).weight = track<double>({{0, 1}, {0.8, 0}}, Interpolation::smooth);
    stage.layer(1).weight = track<double>({{0.2, 0}, {1, 2}});
    stage.layer(1).loop = Loop::pingpong;
    stage.layer(1).speed = -1.7;
    stage.shot.timing.fps = {24, 1};
    stage.shot.shutter = {0, 0.5};
    for (int frame = 0; frame < 30; ++frame)
        for (const SceneSnapshot& part : stage.snapshots(frame)) EXPECT_LE(test::worst_error_px(stage, part, 0, stage.arm, 100), 0.1) << "frame " << frame;
}

// The most that a rotation can turn is what the grid of motion frames starts from: it may be too much, never too little.
RC_GTEST_PROP(ClipLayersProperty, ActivityBoundsTheTurn, ()) {
    Arm stage;
    const auto degrees = [] { return static_cast<double>(*rc::gen::inRange(-170, 171)); };
    const auto axis = [] { return glm::dvec3(*rc::gen::inRange(-3, 4), *rc::gen::inRange(-3, 4), *rc::gen::inRange(1, 4)); };
    for (std::size_t i = 0; i < 2; ++i) {
        stage.scene.clips[i].channels[0].rotation = track<glm::dquat>({{0, turn(degrees(), axis())}, {0.5, turn(degrees(), axis())}, {2, turn(degrees(), axis())}});
        stage.layer(i).loop = *rc::gen::element(Loop::hold, Loop::repeat, Loop::pingpong);
        stage.layer(i).speed = 0.1 * *rc::gen::inRange(-50, 51);
        stage.layer(i).start_s = 0.1 * *rc::gen::inRange(0, 21);
        stage.layer(i).weight = track<double>({{0, 0.1 * *rc::gen::inRange(0, 11)}, {1, 0.1 * *rc::gen::inRange(0, 21)}});
    }
    const BoundShot bound = stage.bind();
    const NodeRig& rig = bound.bindings().rig;
    RC_PRE(rig.moves(stage.arm));
    const double begin = 0.01 * *rc::gen::inRange(0, 100), end = begin + 0.01 * *rc::gen::inRange(1, 50);
    const std::vector<double> jumps = rig.discontinuities(begin, end);
    const int steps = 2000;
    double turned = 0;
    glm::dquat before = decompose(rig.node_transform(stage.arm, begin)).rotation;
    for (int i = 1; i <= steps; ++i) {
        const double from = std::lerp(begin, end, (i - 1.0) / steps), to = std::lerp(begin, end, static_cast<double>(i) / steps);
        const glm::dquat now = decompose(rig.node_transform(stage.arm, to)).rotation;
        const bool jump = std::any_of(jumps.begin(), jumps.end(), [&](double t) { return t >= from - 1e-9 && t <= to + 1e-9; });
        const double step = angle_between(before, now);
        // Of three rotations (the node's own is one) the mean can change sides elsewhere too, which is not turning.
        if (!jump && step < 0.3) turned += step;
        before = now;
    }
    const NodeRig::Selection selection = rig.select(std::vector<int>{stage.arm});
    RC_ASSERT(turned <= rig.activity(selection, begin, end)[0].turn_rad + 1e-6);
}

TEST(ClipLayers, CountTheTurnsOfATinyLoopInALongWindow) {
    Arm stage;
    stage.shot.scenes[0].layers = {stage.named("a")};
    stage.layer(0).loop = Loop::pingpong;
    stage.layer(0).out_s = 1e-3;
    const BoundShot bound = stage.bind();
    const NodeRig& rig = bound.bindings().rig;
    const NodeRig::Activity activity = rig.activity(rig.select(std::vector<int>{0}), 0, 100)[0];
    EXPECT_NEAR(activity.turn_rad, 1e5 * glm::radians(60.0) * 0.5e-3, 0.1);
    EXPECT_GE(activity.keys, 127);
    EXPECT_LE(activity.keys, 2000);
    EXPECT_LE(rig.key_times_of(0, 0, 100).size(), 2000u);
}

}  // namespace
}  // namespace kadr
