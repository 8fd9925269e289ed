#include "anim/timing.h"

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

#include "base/error.h"

namespace kadr {
namespace {

using testing::ElementsAre;

std::string message_of(std::string_view frames) {
    try {
        parse_frame_list(frames);
    } catch (const InputError& error) {
        return error.diagnostics().front().found;
    }
    return "accepted";
}

TEST(Rational, IsInLowestTermsWithAPositiveDenominator) {
    EXPECT_EQ(make_rational(48, -2002), (Rational{-24, 1001}));
    EXPECT_EQ(make_rational(0, 5), (Rational{0, 1}));
    EXPECT_EQ((Rational{1, 3} + Rational{1, 6}), (Rational{1, 2}));
    EXPECT_EQ((Rational{2, 3} * Rational{3, 4}), (Rational{1, 2}));
    EXPECT_EQ((Rational{2, 3} / Rational{-4, 3}), (Rational{-1, 2}));
}

TEST(Rational, SaysWhereSixtyFourBitsEnd) {
    constexpr auto largest = std::numeric_limits<std::int64_t>::max();
    EXPECT_THROW((Rational{largest, 1} + Rational{1, 1}), std::overflow_error);
    EXPECT_THROW((Rational{largest, 1} * Rational{2, 1}), std::overflow_error);
    EXPECT_THROW((Rational{1, 1} / Rational{0, 1}), std::overflow_error);
    EXPECT_THROW(make_rational(1, 0), std::overflow_error);
    EXPECT_EQ((Rational{largest, 2} * Rational{2, largest}), (Rational{1, 1}));
}

TEST(Sequence, OpensAtTheFrameAndClosesHalfAFrameLater) {
    const FrameTime frame = Sequence({Rational{24, 1}, {24}, 0}, {0, 0.5}).frame(24);
    EXPECT_EQ(frame.time, (Rational{1, 1}));
    EXPECT_EQ(frame.open_s, 1.0);
    EXPECT_EQ(frame.close_s, 1.0 + 1.0 / 48.0);
}

TEST(Sequence, IsExactAtTheMillionthFrameOfNtsc) {
    const Sequence sequence({Rational{24000, 1001}, {0}, 0}, {-0.25, 0.25});
    const FrameTime frame = sequence.frame(1'000'000);
    EXPECT_EQ(frame.time, (Rational{125125, 3}));  // 1e6 * 1001 / 24000
    EXPECT_EQ(frame.open_s, 999999.75 * 1001 / 24000);
    EXPECT_EQ(frame.close_s, 1000000.25 * 1001 / 24000);
}

TEST(Sequence, CountsFromTheFirstFrame) {
    const Sequence sequence({Rational{25, 1}, {1}, 1}, {0, 0});
    EXPECT_EQ(sequence.frame(1).time_s(), 0);
    EXPECT_EQ(sequence.frame(-24).time_s(), -1);
    EXPECT_EQ(sequence.frame(26).open_s, sequence.frame(26).close_s);
}

TEST(Sequence, FindsTheFrameOfATime) {
    const Sequence sequence({Rational{24, 1}, {0}, 10}, {0, 0.5});
    const FrameTime frame = sequence.at_time(1.75);
    EXPECT_EQ(frame.number, 52);
    EXPECT_EQ(frame.time, (Rational{7, 4}));
    EXPECT_EQ(frame.open_s, 1.75);
    EXPECT_EQ(frame.close_s, 1.75 + 1.0 / 48);
    EXPECT_THROW(sequence.at_time(std::numeric_limits<double>::quiet_NaN()), InputError);
    EXPECT_THROW(sequence.at_time(1e300), InputError);
}

TEST(FrameList, SortsAndDropsRepeats) {
    EXPECT_THAT(parse_frame_list("0-3"), ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(parse_frame_list("0-9x4, 4,2"), ElementsAre(0, 2, 4, 8));
    EXPECT_THAT(parse_frame_list("-2--1, 7"), ElementsAre(-2, -1, 7));
    EXPECT_THAT(parse_frame_list("5"), ElementsAre(5));
    EXPECT_EQ(parse_frame_list("1-1000000").size(), 1'000'000u);
}

TEST(FrameList, SaysWhatIsWrong) {
    EXPECT_EQ(message_of("9-5"), "frames \"9-5\": '9-5' runs backwards; write 5-9");
    EXPECT_EQ(message_of("1-5x0"), "frames \"1-5x0\": '1-5x0' has the step 0; use 1 or more");
    EXPECT_EQ(message_of("1,,2"), "frames \"1,,2\": there is nothing between two commas");
    EXPECT_EQ(message_of(""), "frames \"\": it is empty");
    EXPECT_EQ(message_of("abc"), "frames \"abc\": 'abc' is not a frame or a range");
    EXPECT_EQ(message_of("1-"), "frames \"1-\": '1-' is not a frame or a range");
    EXPECT_EQ(message_of("1.5"), "frames \"1.5\": '1.5' is not a frame or a range");
    EXPECT_EQ(message_of("99999999999"), "frames \"99999999999\": '99999999999' is beyond \u00b110000000 frames");
    EXPECT_EQ(message_of("0-1000000"), "frames \"0-1000000\": more than 1000000 frames");
}

}  // namespace
}  // namespace kadr
