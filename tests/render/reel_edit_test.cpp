// The edit: which frames of which shots, with which shares, make each frame of a reel.
#include "render/reel_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>

namespace kadr {
namespace {

using testing::ElementsAre;
using Layer = ReelFrame::Layer;

Cut cut(int first, int count) {
    Cut result;
    result.first = first;
    result.count = count;
    return result;
}

Rational sum_of_shares(const ReelFrame& frame) {
    Rational sum;
    for (const Layer& layer : frame.layers) sum = sum + layer.weight;
    for (const ReelFrame::Color& color : frame.colors) sum = sum + color.weight;
    return sum;
}

TEST(ReelEdit, CutsFollowOneAnother) {
    const ReelEdit edit({cut(10, 2), cut(0, 3)});
    EXPECT_EQ(edit.frame_count(), 5);
    EXPECT_THAT(edit.frame(0).layers, ElementsAre(Layer{0, 10, {1, 1}}));
    EXPECT_THAT(edit.frame(1).layers, ElementsAre(Layer{0, 11, {1, 1}}));
    EXPECT_THAT(edit.frame(2).layers, ElementsAre(Layer{1, 0, {1, 1}}));
    EXPECT_THAT(edit.frame(4).layers, ElementsAre(Layer{1, 2, {1, 1}}));
}

TEST(ReelEdit, AHoldRepeatsTheLastFrame) {
    Cut held = cut(5, 2);
    held.hold = 2;
    const ReelEdit edit({held});
    EXPECT_EQ(edit.frame_count(), 4);
    for (const int frame : {1, 2, 3}) EXPECT_EQ(edit.frame(frame).layers.front().frame, 6) << frame;
}

// Four frames overlap: 1/8, 3/8, 5/8, 7/8 of the next shot; both shots go on.
TEST(ReelEdit, ACrossFadeOverlapsAndBothMove) {
    Cut first = cut(0, 6);
    first.crossfade = 4;
    const ReelEdit edit({first, cut(100, 5)});
    EXPECT_EQ(edit.frame_count(), 7);
    EXPECT_EQ(edit.begin(1), 2);
    EXPECT_THAT(edit.frame(1).layers, ElementsAre(Layer{0, 1, {1, 1}}));
    EXPECT_THAT(edit.frame(2).layers, ElementsAre(Layer{0, 2, {7, 8}}, Layer{1, 100, {1, 8}}));
    EXPECT_THAT(edit.frame(3).layers, ElementsAre(Layer{0, 3, {5, 8}}, Layer{1, 101, {3, 8}}));
    EXPECT_THAT(edit.frame(5).layers, ElementsAre(Layer{0, 5, {1, 8}}, Layer{1, 103, {7, 8}}));
    EXPECT_THAT(edit.frame(6).layers, ElementsAre(Layer{1, 104, {1, 1}}));
}

TEST(ReelEdit, FadesMixWithAColour) {
    Cut faded = cut(0, 4);
    faded.fade_in = 2;
    faded.fade_out = 1;
    faded.from = glm::dvec3(1, 0, 0);
    faded.to = glm::dvec3(1);
    const ReelEdit edit({faded});
    EXPECT_EQ(edit.frame(0).layers.front().weight, (Rational{1, 4}));
    EXPECT_EQ(edit.frame(0).colors.front().color, glm::dvec3(1, 0, 0));
    EXPECT_EQ(edit.frame(0).colors.front().weight, (Rational{3, 4}));
    EXPECT_EQ(edit.frame(1).layers.front().weight, (Rational{3, 4}));
    EXPECT_TRUE(edit.frame(2).colors.empty());
    EXPECT_EQ(edit.frame(3).colors.front().color, glm::dvec3(1));
    EXPECT_EQ(edit.frame(3).colors.front().weight, (Rational{1, 2}));
}

TEST(ReelEdit, OneFadeMayBeginWhereAnotherEnds) {
    Cut first = cut(0, 3), second = cut(0, 2), third = cut(0, 2);
    first.crossfade = 1;
    second.crossfade = 1;
    const ReelEdit edit({first, second, third});
    EXPECT_EQ(edit.frame_count(), 5);
    EXPECT_THAT(edit.frame(2).layers, ElementsAre(Layer{0, 2, {1, 2}}, Layer{1, 0, {1, 2}}));
    EXPECT_THAT(edit.frame(3).layers, ElementsAre(Layer{1, 1, {1, 2}}, Layer{2, 0, {1, 2}}));
}

/// Cuts whose transitions do not overlap.
std::vector<Cut> random_cuts() {
    std::vector<Cut> cuts;
    const int count = *rc::gen::inRange(1, 8);
    int entering = 0;
    for (int i = 0; i < count; ++i) {
        Cut each;
        each.first = *rc::gen::inRange(-50, 1000);
        each.count = *rc::gen::inRange(1, 40);
        each.hold = *rc::gen::inRange(0, 10);
        int free = each.length();
        if (entering > 0) each.count += entering, free = each.length() - entering;
        else free -= each.fade_in = *rc::gen::inRange(0, free + 1);
        const int leaving = *rc::gen::inRange(0, free + 1);
        entering = 0;
        if (i + 1 < count && *rc::gen::arbitrary<bool>()) each.crossfade = entering = leaving;
        else each.fade_out = leaving;
        cuts.push_back(each);
    }
    return cuts;
}

RC_GTEST_PROP(ReelEdit, SharesAddUpToOneAndDurationsToTheReel, ()) {
    const std::vector<Cut> cuts = random_cuts();
    const ReelEdit edit(cuts);
    int length = 0;
    for (const Cut& each : cuts) length += each.length() - each.crossfade;
    RC_ASSERT(edit.frame_count() == length);
    std::vector<int> seen(cuts.size(), 0);
    for (int n = 0; n < edit.frame_count(); ++n) {
        const ReelFrame frame = edit.frame(n);
        RC_ASSERT(sum_of_shares(frame) == (Rational{1, 1}));
        RC_ASSERT(frame.layers.size() == 1 || frame.layers.size() == 2);
        for (const Layer& layer : frame.layers) {
            const Cut& here = cuts[static_cast<std::size_t>(layer.cut)];
            const int at = seen[static_cast<std::size_t>(layer.cut)]++;
            RC_ASSERT(layer.weight.numerator > 0);
            RC_ASSERT(layer.frame == here.first + std::min(at, here.count - 1));
        }
    }
    for (std::size_t i = 0; i < cuts.size(); ++i) RC_ASSERT(seen[i] == cuts[i].length());
}

RC_GTEST_PROP(ReelEdit, ATransitionBackwardsIsItself, ()) {
    Cut first = cut(0, *rc::gen::inRange(1, 60));
    first.crossfade = *rc::gen::inRange(1, first.count + 1);
    const ReelEdit edit({first, cut(0, first.crossfade)});
    const int begin = edit.begin(1), last = edit.frame_count() - 1;
    for (int i = 0; i < first.crossfade; ++i)
        RC_ASSERT(edit.frame(begin + i).layers[0].weight == edit.frame(last - i).layers[1].weight);
}

}  // namespace
}  // namespace kadr
