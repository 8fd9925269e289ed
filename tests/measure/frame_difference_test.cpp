#include "measure/frame_difference.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "measure/compare_job.h"
#include "output/frame_writer.h"
#include "output/output_fixtures.h"

namespace kadr {
namespace {

using test::plain_image;
using test::TemporaryFolder;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

StoredImage linear(const std::vector<float>& pixel) { return {plain_image(16, 12, {"R", "G", "B", "A"}, pixel), true}; }
StoredImage display(const std::vector<float>& pixel) { return {plain_image(16, 12, {"R", "G", "B"}, pixel), false}; }

TEST(FrameDifference, OfRadianceIsThatOfTheValues) {
    const FrameDifference d = difference_between(linear({1, 2, 4, 1}), linear({1, 2, 6, 1}), {}).difference;
    EXPECT_NEAR(d.values.rms, std::sqrt(4.0 / 4), 1e-6);  // R, G, B and A
    EXPECT_EQ(d.largest_channel, "B");
    EXPECT_NEAR(d.relmse, 4 / 16.01 / 3, 1e-6);
    EXPECT_EQ(d.flip, 0);  // both are white on a display
}

TEST(FrameDifference, OfAnExposureThatShowsItIsSeen) {
    DifferenceOptions darker;
    darker.view.exposure_stops = -4;
    EXPECT_GT(difference_between(linear({1, 2, 4, 1}), linear({1, 2, 6, 1}), darker).difference.flip, 0.05);
}

TEST(FrameDifference, OfOneLinearImageIsThatOfTheDisplay) {
    // 0.5 in sRGB is 0.21404114 of linear light (IEC 61966-2-1).
    const float light = 0.21404114f;
    const FrameDifference d =
        difference_between(linear({light, light, light, 1}), display({0.5f, 0.5f, 0.5f}), {}).difference;
    EXPECT_LT(d.values.rms, 1e-5);
    EXPECT_LT(d.relmse, 1e-8);
}

TEST(FrameDifference, OfDisplayValuesDecodesThemForTheRelativeError) {
    const FrameDifference d = difference_between(display({0.5f, 0.5f, 0.5f}), display({1, 1, 1}), {}).difference;
    const double a = 0.21404114, difference = 1 - a;
    EXPECT_NEAR(d.values.rms, 0.5, 1e-6);
    EXPECT_NEAR(d.relmse, difference * difference / (a * a + 0.01), 1e-4);
}

TEST(FrameDifference, CountsAndBlackensWhatIsNotFinite) {
    StoredImage reference = linear({1, 1, 1, 1}), test = reference;
    reference.image.pixels[4] = kNan;
    test.image.pixels[4 * 20 + 2] = std::numeric_limits<float>::infinity();
    const FrameDifference d = difference_between(reference, test, {}).difference;
    EXPECT_EQ(d.not_finite, 2u);
    EXPECT_EQ(d.values.rms, 0);
    EXPECT_EQ(d.flip, 0);
}

TEST(FrameDifference, AlphaCountsWhereBothHaveIt) {
    const StoredImage opaque = linear({0.5f, 0.5f, 0.5f, 1}), half = linear({0.5f, 0.5f, 0.5f, 0.5f});
    EXPECT_NEAR(difference_between(opaque, half, {}).difference.values.rms, std::sqrt(0.25 / 4), 1e-6);
    StoredImage colors = opaque;
    colors.image = plain_image(16, 12, {"R", "G", "B"}, {0.5f, 0.5f, 0.5f});
    EXPECT_EQ(difference_between(colors, half, {}).difference.values.rms, 0);
}

TEST(Limits, AreReadAndRefused) {
    const std::vector<Limit> limits = parse_limits("0.05,rmse=1e-3,psnr=30");
    ASSERT_EQ(limits.size(), 3u);
    EXPECT_TRUE(limits[0].metric == Metric::flip && limits[0].value == 0.05);
    EXPECT_TRUE(limits[1].metric == Metric::rmse && limits[1].value == 1e-3);
    EXPECT_TRUE(limits[2].metric == Metric::psnr && limits[2].value == 30);
    for (const char* bad : {"", "flip", "flip=", "flop=1", "flip=nan", "flip=-1", "0.1,", "flip=1x", "inf"})
        EXPECT_THAT(test::message_of<InputError>([&] { parse_limits(bad); }), HasSubstr("--fail-above is")) << bad;
}

std::string frame_name(const std::string& folder, int frame) { return folder + "/x." + std::to_string(frame) + ".exr"; }

class CompareFiles : public testing::Test {
protected:
    void write(const std::string& name, float value) const {
        write_frame(folder_ / name, plain_image(16, 12, {"R", "G", "B", "A"}, {value, value, value, 1}), {}, 8, {});
    }
    CompareSummary run(const std::string& limits = {}) {
        options_.reference = (folder_ / "a").string();
        options_.test = (folder_ / "b").string();
        if (!limits.empty()) options_.limits = parse_limits(limits);
        return compare(options_, {});
    }
    TemporaryFolder folder_;
    CompareOptions options_;
};

TEST_F(CompareFiles, FindsTheWorstFrameAndTheMean) {
    for (int i = 0; i < 3; ++i) write(frame_name("a", i), 0.5f);
    write(frame_name("b", 0), 0.5f), write(frame_name("b", 1), 0.75f), write(frame_name("b", 2), 0.625f);
    const CompareSummary summary = run();
    ASSERT_EQ(summary.frames.size(), 3u);
    EXPECT_EQ(summary.worst, 1u);
    // R, G and B of four channels; halves and quarters are exact in half floats.
    EXPECT_NEAR(summary.mean.values.rms, (0.25 + 0.125) * std::sqrt(0.75) / 3, 1e-6);
    EXPECT_NEAR(summary.mean.values.largest, 0.25, 1e-6);
    EXPECT_FALSE(summary.failed);
}

TEST_F(CompareFiles, FailsAboveALimitAndBelowOneOfWhatShouldBeLarge) {
    write("a/x.1.exr", 0.5f), write("b/x.1.exr", 0.75f);
    EXPECT_TRUE(run("0.01").failed);
    EXPECT_FALSE(run("0.9").failed);
    EXPECT_TRUE(run("psnr=60").failed);
    EXPECT_FALSE(run("psnr=3").failed);
    EXPECT_TRUE(run("ssim=0.999").failed);
    EXPECT_THAT(run("rmse=0.1").frames[0].failures, testing::ElementsAre(HasSubstr("rmse 0.2165 is above 0.1")));
}

TEST_F(CompareFiles, EqualFramesPassTheStrictestLimits) {
    write("a/x.1.exr", 0.5f), write("b/x.1.exr", 0.5f);
    EXPECT_FALSE(run("flip=0,rmse=0,relmse=0,psnr=1000,ssim=1").failed);
}

TEST_F(CompareFiles, NanNeverPasses) {
    write("a/x.1.exr", 0.5f), write("b/x.1.exr", 0.5f);
    Image broken = plain_image(16, 12, {"R", "G", "B", "A"}, {0.5f, 0.5f, 0.5f, 1});
    broken.pixels[0] = kNan;
    write_frame(folder_ / "b/x.1.exr", broken, {}, 8, {});
    EXPECT_TRUE(run("1").failed);
    EXPECT_FALSE(compare({options_.reference, options_.test, {}, {}, {}, {}, {24, 1}, {}, {}}, {}).failed);
}

TEST_F(CompareFiles, WritesOneErrorMapAFrame) {
    write("a/x.1.exr", 0.5f), write("b/x.1.exr", 0.75f), write("a/x.2.exr", 0.5f), write("b/x.2.exr", 0.5f);
    options_.maps = folder_ / "maps";
    const CompareSummary summary = run();
    EXPECT_EQ(summary.frames[0].map.filename(), "flip.0001.png");
    const Image differing = image_io().read(summary.frames[0].map), equal = image_io().read(summary.frames[1].map);
    EXPECT_GT(differing.at(8, 6, 0), 0.1f);
    EXPECT_LT(equal.at(8, 6, 0), 0.02f);
}

TEST_F(CompareFiles, NamesTheImagesOfDifferentSizes) {
    write("a/x.1.exr", 0.5f);
    write_frame(folder_ / "b/x.1.exr", plain_image(8, 12, {"R", "G", "B"}, {0, 0, 0}), {}, 8, {});
    EXPECT_THAT(test::message_of<InputError>([&] { run(); }),
                testing::AllOf(HasSubstr("16x12"), HasSubstr("8x12"), HasSubstr("b/x.1.exr")));
}

}  // namespace
}  // namespace kadr
