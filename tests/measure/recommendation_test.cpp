// What measured variants say, on figures made up so that the answer is plain.
#include <gmock/gmock.h>

#include "measure/measure_job.h"

namespace kadr {
namespace {

MeasuredVariant variant(const char* axis, const char* value, double seconds, double flip, double noise, double bias) {
    MeasuredVariant measured{{axis, value, {{std::string("render.") + axis, value}}}, {}, seconds, {}, {}, false, {}, {}};
    measured.error = {noise + bias, noise, bias, flip, 1};
    return measured;
}

TEST(Recommendation, TakesTheLeastSamplesThatLookGood) {
    const std::vector<MeasuredVariant> variants{variant("shot", "", 1, 0.06, 0.01, 0), variant("samples", "4", 0.3, 0.12, 0.04, 0),
                                                variant("samples", "64", 4, 0.03, 0.0025, 0), variant("samples", "256", 16, 0.015, 0.0006, 0)};
    EXPECT_EQ(recommend(variants, RenderSpec(), 16).yaml(), "render: { samples: 64 }");
}

TEST(Recommendation, GoesOnByTheSquareRoot) {
    const std::vector<MeasuredVariant> variants{variant("shot", "", 1, 0.4, 0.1, 0), variant("samples", "64", 4, 0.2, 0.025, 0)};
    EXPECT_EQ(recommend(variants, RenderSpec(), 16).yaml(), "render: { samples: 1024 }");  // 0.2 at 64: a quarter needs 16 times as many
    const std::vector<MeasuredVariant> hopeless{variant("shot", "", 1, 0.9, 1, 0)};
    EXPECT_EQ(recommend(hopeless, RenderSpec(), 64).yaml(), "render: { samples: 4096 }");
}

TEST(Recommendation, SavesWhereTheBiasIsLostInTheNoise) {
    std::vector<MeasuredVariant> variants{variant("shot", "", 1, 0.05, 0.01, 0.0001), variant("bounces", "1", 0.4, 0.2, 0.008, 0.02),
                                          variant("bounces", "3", 0.7, 0.05, 0.01, 0.0005), variant("bounces", "4", 0.8, 0.05, 0.01, 0.0001)};
    EXPECT_EQ(recommend(variants, RenderSpec(), 16).yaml(), "render: { samples: 16, bounces: 3 }");
    // Where the advice is four times the samples, the noise is a quarter, and the same bias shows.
    variants.front().error.flip = 0.1;
    variants.push_back(variant("samples", "64", 4, 0.05, 0.0025, 0.0001));
    EXPECT_EQ(recommend(variants, RenderSpec(), 16).yaml(), "render: { samples: 64, bounces: 4 }");
}

TEST(Recommendation, PaysForABiasThatShowsAndNotForMoods) {
    const std::vector<MeasuredVariant> biased{variant("shot", "", 1, 0.05, 0.01, 0.1), variant("bounces", "32", 2, 0.05, 0.01, 0)};
    EXPECT_EQ(recommend(biased, RenderSpec(), 16).yaml(), "render: { samples: 16, bounces: 32 }");
    const std::vector<MeasuredVariant> mood{variant("shot", "", 1, 0.05, 0.01, 0), variant("motion_tolerance", "0.5 px", 0.95, 0.05, 0.01, 0)};
    EXPECT_EQ(recommend(mood, RenderSpec(), 16).yaml(), "render: { samples: 16 }");
}

// 16 samples are off by 0.2; 256 would look good for sixteen times the time, their denoised picture for a little more.
TEST(Recommendation, DenoisesWhereThatIsCheaperThanTheSamples) {
    std::vector<MeasuredVariant> variants{variant("shot", "", 1, 0.2, 0.01, 0), variant("samples", "256", 16, 0.05, 0.0006, 0), variant("denoise", "oidn", 1.5, 0.04, 0.001, 0.002)};
    EXPECT_EQ(recommend(variants, RenderSpec(), 16).yaml(), "render: { samples: 16, denoise: oidn }");
    variants.back().error.flip = 0.06;  // it smears
    EXPECT_EQ(recommend(variants, RenderSpec(), 16).yaml(), "render: { samples: 256 }");
    variants.back().error.flip = 0.04, variants.back().seconds = 15;  // a frame of many pixels and few samples
    EXPECT_EQ(recommend(variants, RenderSpec(), 16).yaml(), "render: { samples: 256 }");
}

TEST(Recommendation, WritesTheKeyOfAnAxisThatHasAnotherName) {
    MeasuredVariant smaller = variant("texture", "512 px", 0.5, 0.05, 0.01, 0);
    smaller.variant.set = {{"render.texture_limit", "512 px"}};
    EXPECT_EQ(recommend({variant("shot", "", 1, 0.05, 0.01, 0), smaller}, RenderSpec(), 16).yaml(), "render: { samples: 16, texture_limit: 512 px }");
}

TEST(ErrorShares, AreWhatABetterValueTakesAway) {
    const std::vector<MeasuredVariant> variants{variant("shot", "", 1, 0.1, 0.01, 0.02), variant("bounces", "32", 2, 0.1, 0.01, 0.005),
                                                variant("clamp", "none", 1, 0.1, 0.03, 0.018)};
    const ErrorShares shares = shares_of(variants);
    EXPECT_DOUBLE_EQ(shares.noise, 0.01);
    EXPECT_DOUBLE_EQ(shares.bounces, 0.015);
    EXPECT_NEAR(shares.clamp, 0.002, 1e-15);
    EXPECT_EQ(shares.motion, 0);
    EXPECT_NEAR(shares.other, 0.003, 1e-15);
}

TEST(ParetoFront, HoldsWhatNothingBeatsInBoth) {
    std::vector<MeasuredVariant> variants{variant("shot", "", 1, 0.1, 0, 0), variant("a", "", 2, 0.2, 0, 0), variant("b", "", 2, 0.05, 0, 0), variant("c", "", 0.5, 0.3, 0, 0),
                                          variant("d", "", 1, 0.1, 0, 0), variant("e", "", 1, 0.11, 0, 0)};
    mark_front(variants);
    std::vector<bool> front;
    for (const MeasuredVariant& each : variants) front.push_back(each.on_front);
    EXPECT_THAT(front, ::testing::ElementsAre(true, false, true, true, true, false));
}

}  // namespace
}  // namespace kadr
