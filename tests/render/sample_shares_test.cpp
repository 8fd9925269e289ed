#include "render/sample_shares.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

namespace kadr {
namespace {

TEST(SampleShares, OnePartTakesAll) {
    EXPECT_EQ(deal_samples({1.0}, 16), (std::vector<SampleRange>{{0, 16}}));
}

TEST(SampleShares, FollowTheWeights) {
    EXPECT_EQ(deal_samples({0.25, 0.75}, 16), (std::vector<SampleRange>{{0, 4}, {4, 12}}));
}

TEST(SampleShares, AShortPartGetsOne) {
    EXPECT_EQ(deal_samples({0.001, 0.999}, 8), (std::vector<SampleRange>{{0, 1}, {1, 7}}));
}

TEST(SampleShares, AnEmptyPartGetsNone) {
    EXPECT_EQ(deal_samples({0.0, 1.0}, 4), (std::vector<SampleRange>{{0, 0}, {0, 4}}));
}

TEST(SampleShares, TheHeaviestComeFirstWhenSamplesAreFew) {
    EXPECT_EQ(deal_samples({0.2, 0.5, 0.3}, 2), (std::vector<SampleRange>{{0, 0}, {0, 1}, {1, 1}}));
}

RC_GTEST_PROP(SampleShares, CoverEverySampleOnce, ()) {
    const auto raw = *rc::gen::nonEmpty(rc::gen::container<std::vector<int>>(rc::gen::inRange(1, 1000)));
    const int total = *rc::gen::inRange(1, 500);
    const std::vector<double> weights(raw.begin(), raw.end());
    const std::vector<SampleRange> ranges = deal_samples(weights, total);
    int next = 0;
    for (const SampleRange& range : ranges) {
        RC_ASSERT(range.first == next);
        next += range.count;
    }
    RC_ASSERT(next == total);
    if (total >= static_cast<int>(weights.size()))
        RC_ASSERT(std::all_of(ranges.begin(), ranges.end(), [](const SampleRange& range) { return range.count >= 1; }));
}

}  // namespace
}  // namespace kadr
