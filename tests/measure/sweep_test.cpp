#include "measure/sweep.h"

#include <gmock/gmock.h>

#include "base/error.h"

namespace kadr {
namespace {

std::vector<std::string> ids(const Sweep& sweep) {
    std::vector<std::string> names;
    for (const Variant& variant : sweep.variants) names.push_back(variant.id());
    return names;
}

const SweepSize kSmall{16, {4, 16, 64}, true};

TEST(Sweep, StartsWithTheShotAndLeavesItsOwnValuesOut) {
    RenderSpec render;  // 8 bounces, 0.1 px, no clamps
    EXPECT_THAT(ids(plan_sweep(render, {}, kSmall)),
                ::testing::ElementsAre("shot", "samples-4", "samples-64", "bounces-0", "bounces-1", "bounces-2", "bounces-4", "bounces-32", "integrator-direct",
                                       "motion_tolerance-0.02px", "motion_tolerance-0.5px", "motion_frames-2srt", "motion_frames-2matrix", "motion_frames-5srt", "motion_frames-5matrix", "clamp-10", "clamp-3", "clamp-1", "denoise-oidn", "build-low", "build-high", "robust-true"));
    render.bounces = {4, 4, 4, 4};
    render.clamp_indirect = 3;
    EXPECT_THAT(ids(plan_sweep(render, {"bounces", "clamp"}, kSmall)),
                ::testing::ElementsAre("shot", "bounces-0", "bounces-1", "bounces-2", "bounces-32", "clamp-none", "clamp-10", "clamp-1"));
    render.bounces.glossy = 1;  // four bounces of every kind are another setting then
    EXPECT_THAT(ids(plan_sweep(render, {"bounces"}, kSmall)), ::testing::Contains("bounces-4"));
}

TEST(Sweep, ChangesOneSettingAndFixesTheSamples) {
    const Sweep sweep = plan_sweep(RenderSpec(), {"samples", "motion_tolerance"}, kSmall);
    using Set = std::vector<std::pair<std::string, std::string>>;
    EXPECT_EQ(sweep.variants[0].set, (Set{{"render.samples", "16"}}));
    EXPECT_EQ(sweep.variants[1].set, (Set{{"render.samples", "4"}}));
    EXPECT_EQ(sweep.variants[3].set, (Set{{"render.motion_tolerance", "0.02 px"}, {"render.samples", "16"}}));
}

TEST(Sweep, LimitsTexturesDownToAnEighth) {
    SweepSize size = kSmall;
    size.largest_texture_px = 1500;
    size.quick = false;
    RenderSpec render;
    EXPECT_THAT(ids(plan_sweep(render, {"texture"}, size)), ::testing::ElementsAre("shot", "texture-1024px", "texture-512px", "texture-256px"));
    render.texture_limit_px = 512;
    EXPECT_THAT(ids(plan_sweep(render, {"texture"}, size)), ::testing::ElementsAre("shot", "texture-none", "texture-1024px", "texture-256px"));
    size.largest_texture_px = 16;
    EXPECT_EQ(plan_sweep(render, {"texture"}, size).left_out.at(0).reason, "no texture of the shot is larger than 16 px");
}

TEST(Sweep, OffersTheOtherValueOfASwitch) {
    RenderSpec render;
    render.denoise = DenoiserKind::oidn, render.robust = true, render.build = BuildQuality::high;
    EXPECT_THAT(ids(plan_sweep(render, {"denoise", "robust", "build"}, kSmall)), ::testing::ElementsAre("shot", "denoise-none", "build-low", "build-medium", "robust-false"));
}

TEST(Sweep, SaysWhatItLeavesOut) {
    RenderSpec render;
    render.integrator = Integrator::direct;
    const Sweep sweep = plan_sweep(render, {"bounces", "integrator"}, kSmall);
    EXPECT_THAT(ids(sweep), ::testing::ElementsAre("shot", "integrator-path"));
    ASSERT_EQ(sweep.left_out.size(), 1u);
    EXPECT_EQ(sweep.left_out[0].reason, "render.integrator is direct, which has none");
}

std::string refusal(const std::string& list) {
    try {
        parse_axes(list);
    } catch (const InputError& error) {
        return error.diagnostics().front().text();
    }
    return "";
}

TEST(Sweep, RefusesWhatItDoesNotKnow) {
    EXPECT_EQ(refusal("samples,bouncs"),
              "error: --sweep names 'bouncs'\n  expected some of samples, bounces, integrator, motion_tolerance, motion_frames, clamp, denoise, texture, build, robust, device");
    EXPECT_EQ(parse_axes("clamp,samples,clamp"), (std::vector<std::string>{"clamp", "samples"}));
    EXPECT_TRUE(parse_axes("").empty());
}

TEST(Sweep, FixesTheNumberOfMotionFrames) {
    SweepSize size = kSmall;
    RenderSpec render;
    render.motion_frames = {5, MotionMix::matrix};
    const Sweep sweep = plan_sweep(render, {"motion_frames"}, size);
    EXPECT_THAT(ids(sweep), ::testing::ElementsAre("shot", "motion_frames-auto", "motion_frames-2srt", "motion_frames-2matrix", "motion_frames-5srt"));
    EXPECT_EQ(sweep.variants[2].set.front(), (std::pair<std::string, std::string>{"render.motion_frames", "{ count: 2, mix: srt }"}));
    size.moves = false;
    EXPECT_EQ(plan_sweep(render, {"motion_frames"}, size).left_out.at(0).reason, "nothing moves while the shutter is open, in the frames at hand");
}

TEST(Sweep, NamesTheDevicesThatItLeavesOut) {
    SweepSize size = kSmall;
    size.devices = {{"cpu", "", true}, {"hiprt", "no driver", false}};
    Sweep sweep = plan_sweep(RenderSpec(), {"device"}, size);
    EXPECT_THAT(ids(sweep), ::testing::ElementsAre("shot"));
    ASSERT_EQ(sweep.left_out.size(), 2u);
    EXPECT_EQ(sweep.left_out[0].what + ": " + sweep.left_out[0].reason, "device hiprt: no driver");
    EXPECT_EQ(sweep.left_out[1].what, "device exact");
    size.devices[1].missing.clear();
    sweep = plan_sweep(RenderSpec(), {"device"}, size);
    EXPECT_THAT(ids(sweep), ::testing::ElementsAre("shot", "device-hiprt"));
    EXPECT_EQ(sweep.variants[1].device, "hiprt");
}

}  // namespace
}  // namespace kadr
