// The mean of rotations jumps where it says so, and nowhere else.
#include "frame/mean_flips.h"

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>

#include "frame/bindings.h"
#include "frame/decompose.h"
#include "stage.h"

namespace kadr {
namespace {

using test::Stage;
using test::track;
using test::turn;

/// A node that every clip turns in its own way.
struct Mixed : Stage {
    int arm = add_node("arm");
    /// @return the clip's rotation, to be changed
    Track<glm::dquat>& add_clip(Track<glm::dquat> rotation) {
        Clip clip{"clip " + std::to_string(scene.clips.size()), 0, 1, {}, 1};
        clip.channels.resize(1);
        clip.channels[0].node = arm;
        clip.channels[0].rotation = std::move(rotation);
        scene.clips.push_back(clip);
        scene.files[0].clip_count = static_cast<int>(scene.clips.size());
        return *scene.clips.back().channels[0].rotation;
    }
};

glm::dquat rotation_at(const NodeRig& rig, int node, double time_s, double offset_s = 0) { return decompose(rig.scene_from_node(node, time_s, offset_s)).rotation; }

/// Thirds of a turn about one axis: no two of them are half a turn apart, and yet their mean changes sides.
Mixed thirds() {
    Mixed stage;
    for (const double degrees : {0.0, 120.0, -120.0}) stage.add_clip(Track<glm::dquat>(turn(degrees)));
    stage.play({Track<double>(0.3), track<double>({{0, 0.4}, {1, 0.8}}), track<double>({{0, 0.8}, {1, 0.4}})});
    return stage;
}

TEST(MeanFlips, AreFoundWhereNoTwoRotationsAreHalfATurnApart) {
    const Mixed stage = thirds();
    const BoundShot bound = stage.bind();
    const NodeRig& rig = bound.bindings().rig;
    const std::vector<double> times = rig.discontinuities(0, 1);
    ASSERT_EQ(times.size(), 1u);
    EXPECT_NEAR(times[0], 0.5, 1e-9);
    // Of 0, 120 and 240 degrees with weights 0.3, 0.6 and 0.6, and of 360 instead of 0.
    EXPECT_NEAR(glm::degrees(angle_between(rotation_at(rig, stage.arm, 0.5 - 1e-9), rotation_at(rig, stage.arm, 0.5 + 1e-9))), 360 * 0.3 / 1.5, 1e-5);
    const std::vector<SceneSnapshot> parts = stage.snapshots();
    ASSERT_EQ(parts.size(), 2u);
    const auto shown = [](const SceneSnapshot& part, double u) { return decompose(interpolate(part.motion, 0, u)).rotation; };
    EXPECT_LT(angle_between(shown(parts[0], 1), rotation_at(rig, stage.arm, 0.5 - 1e-6)), 1e-5);
    EXPECT_LT(angle_between(shown(parts[1], 0), rotation_at(rig, stage.arm, 0.5 + 1e-6)), 1e-5);
    EXPECT_TRUE(rig.discontinuities(0, 0.49).empty());
}

TEST(MeanFlips, OfCopiesFollowTheirClipOffsets) {
    Mixed stage;
    stage.add_clip(track<glm::dquat>({{0, turn(0)}, {4, turn(160)}}));
    stage.add_clip(Track<glm::dquat>(turn(-90)));  // half a turn away at 2.25 s
    stage.play({Track<double>(1.0), Track<double>(0.5)});
    stage.scene.clips[0].end_s = 4;
    InstancesSpec copies;
    copies.list = {{{0, 0, 0}}, {{1, 0, 0}, {1, 0, 0, 0}, glm::dvec3(1), 2}};
    stage.shot.scenes[0].instances = copies;
    const std::vector<SceneSnapshot> parts = stage.snapshots();  // 0 s to 1 s
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_NEAR(parts[0].close_s, 0.25, 1e-11);
}

TEST(MeanFlips, AmongCloseRotationsThereAreNone) {
    Mixed stage;
    for (const double degrees : {0.0, 59.0, -59.0}) stage.add_clip(Track<glm::dquat>(turn(degrees, {1, 2, 3})));
    stage.play({track<double>({{0, 0}, {1, 1}}), track<double>({{0, 1}, {1, 0.1}}), track<double>({{0, 0.1}, {1, 1}})});
    EXPECT_TRUE(stage.bind().bindings().rig.discontinuities(0, 1).empty());
    // A jump of a rotation itself may take it far away.
    stage.scene.clips[0].channels[0].rotation = track<glm::dquat>({{0, turn(0)}, {0.25, turn(180, {1, 2, 3})}}, Interpolation::step);
    const std::vector<double> times = stage.bind().bindings().rig.discontinuities(0, 1);
    EXPECT_THAT(times, testing::Contains(testing::DoubleEq(0.25)));
    EXPECT_THAT(times, testing::Contains(testing::Gt(0.3)));  // the other two are equally heavy later on, at the opposite side
}

glm::dquat random_rotation() {
    const auto component = [] { return 0.001 * *rc::gen::inRange(-1000, 1001); };
    const glm::dquat q(component(), component(), component(), component());
    return glm::length(q) > 0.05 ? glm::normalize(q) : glm::dquat(1, 0, 0, 0);
}

RC_GTEST_PROP(MeanRotationProperty, AWeightThatRunsToZeroLeavesNoTrace, ()) {
    std::vector<WeightedRotation> mix;
    const int count = *rc::gen::inRange(2, 5);
    for (int i = 0; i < count; ++i) mix.push_back({0.1 * *rc::gen::inRange(1, 20), random_rotation()});
    RC_PRE(mean_sides(mix).margin > 0.05);
    const glm::dquat without = mean_rotation(mix);
    mix.push_back({1e-9, random_rotation()});
    RC_ASSERT(angle_between(mean_rotation(mix), without) < 1e-6);
}

// Between the times that are reported the mean has no jump: where two times close together differ much, the change is
// followed by halving, and comes to nothing. At every time that is reported there is one.
RC_GTEST_PROP(MeanFlipsProperty, JumpsAreReportedAndNothingElseJumps, ()) {
    Mixed stage;
    const bool one_axis = *rc::gen::arbitrary<bool>();  // means of coaxial turns meet all special cases
    const auto rotation = [&] { return one_axis ? turn(*rc::gen::inRange(-179, 180)) : random_rotation(); };
    std::vector<Track<double>> weights;
    const int count = *rc::gen::inRange(2, 5);
    for (int i = 0; i < count; ++i) {
        const glm::dquat first = rotation(), last = rotation();
        RC_PRE(angle_between(first, last) < 3.1);
        stage.add_clip(track<glm::dquat>({{0, first}, {1, last}}));
        weights.push_back(track<double>({{0, 0.0137 * *rc::gen::inRange(0, 80)}, {1, 0.0137 * *rc::gen::inRange(0, 80)}}));
    }
    stage.play(weights);
    const BoundShot bound = stage.bind();
    const NodeRig& rig = bound.bindings().rig;
    const auto at = [&](double time_s) { return rotation_at(rig, stage.arm, time_s); };
    std::vector<double> times = rig.discontinuities(0, 1);
    for (const double time : times) RC_ASSERT(angle_between(at(time - 1e-9), at(time + 1e-9)) > 5e-7);
    times.push_back(0), times.push_back(1);
    std::sort(times.begin(), times.end());
    for (std::size_t part = 1; part < times.size(); ++part) {
        constexpr double kInset = 1e-10;
        constexpr int kSteps = 400;
        const double from = times[part - 1] + kInset, to = times[part] - kInset;
        if (to <= from) continue;
        for (int i = 0; i < kSteps; ++i) {
            double a = std::lerp(from, to, i / static_cast<double>(kSteps)), b = std::lerp(from, to, (i + 1) / static_cast<double>(kSteps));
            double change = angle_between(at(a), at(b));
            while (change > 0.01 && b - a > 1e-11) {
                const double middle = std::midpoint(a, b), first = angle_between(at(a), at(middle)), second = angle_between(at(middle), at(b));
                (first > second ? b : a) = middle;
                change = std::max(first, second);
            }
            RC_ASSERT(change <= 0.01);
        }
    }
}

}  // namespace
}  // namespace kadr
