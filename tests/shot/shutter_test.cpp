// The shutter's forms and what is said about those that make no sense.
#include <gtest/gtest.h>

#include "shot/shot_fixture.h"

namespace kadr {
namespace {

using ShutterForms = ShotTest;

TEST_F(ShutterForms, TimesKeepTheirLengthAtAnyFrameRate) {
    const Shutter start = parse("shutter: { time: 1/48 s }").shutter;
    EXPECT_EQ(start.open_frames, 0);
    EXPECT_EQ(start.close_frames, 0);
    EXPECT_EQ(start.open_s, 0);
    EXPECT_EQ(start.close_s, 1.0 / 48);
    const Shutter centre = parse("shutter: { time: 20 ms, phase: centre }").shutter;
    EXPECT_EQ(centre.open_s, -0.01);
    EXPECT_EQ(centre.close_s, 0.01);
    EXPECT_EQ(parse("timing: { fps: 25 }\nshutter: { time: 0.5 f, phase: end }").shutter.open_s, -0.02);
    EXPECT_EQ(parse("shutter: { time: 1/48 }").shutter, start);
}

TEST_F(ShutterForms, CurvesAndRollingLines) {
    EXPECT_EQ(parse("shutter: { curve: triangle }").shutter.curve.shape, ShutterCurve::Shape::triangle);
    const Shutter keyed = parse("shutter: { angle: 90, curve: { keys: { 0: 0, 0.25: 1, 1: 0.5 } } }").shutter;
    EXPECT_EQ(keyed.close_frames, 0.25);
    EXPECT_EQ(keyed.curve.shape, ShutterCurve::Shape::keys);
    EXPECT_EQ(keyed.curve.keys, (std::vector<ShutterCurve::Key>{{0, 0}, {0.25, 1}, {1, 0.5}}));
    const RollingShutter rolling = parse("shutter: { rolling: { direction: left, duration: 10 ms } }").shutter.rolling;
    EXPECT_EQ(rolling.direction, RollingShutter::Direction::left);
    EXPECT_EQ(rolling.duration_s, 0.01);
    EXPECT_EQ(parse("shutter: { rolling: { duration: 12 f } }").shutter.rolling.duration_s, 0.5);
    EXPECT_EQ(parse("shutter: { rolling: { duration: 0 } }").shutter.rolling, RollingShutter{});
    EXPECT_TRUE(parse("shutter: { exposure: physical }").shutter.physical);
}

TEST_F(ShutterForms, MessagesSayWhatExcludesWhat) {
    const std::pair<const char*, const char*> cases[] = {
        {"{ angle: 90, time: 10 ms }", R"(shot.yaml:4:23: error: shutter.angle and shutter.time exclude each other
    shutter: { angle: 90, time: 10 ms }
                          ^~~~
  remove one of the two)"},
        {"{ time: 10 ms, open: 0, close: 1 }", R"(shot.yaml:4:25: error: shutter.time and shutter.open exclude each other
    shutter: { time: 10 ms, open: 0, close: 1 }
                            ^~~~
  remove one of the two
shot.yaml:4:34: error: shutter.time and shutter.close exclude each other
    shutter: { time: 10 ms, open: 0, close: 1 }
                                     ^~~~~
  remove one of the two)"},
        {"{ time: 1/0 s }", R"(shot.yaml:4:18: error: shutter.time is 1/0 s
    shutter: { time: 1/0 s }
                     ^~~~~
  expected at least 0 s)"},
        {"{ time: 10 s }", R"(shot.yaml:4:18: error: shutter.time is 10 s, which is 240 frames
    shutter: { time: 10 s }
                     ^~~~
  expected at most 100 frames)"},
        {"{ curve: sharp }", R"(shot.yaml:4:19: error: shutter.curve is 'sharp'
    shutter: { curve: sharp }
                      ^~~~~
  expected one of box, triangle, smooth or a map of keys)"},
        {"{ curve: { keys: { 0: 0, 1.5: 1 } } }", R"(shot.yaml:4:35: error: a fraction of shutter.curve.keys is 1.5
    shutter: { curve: { keys: { 0: 0, 1.5: 1 } } }
                                      ^~~
  expected a number from 0 to 1)"},
        {"{ curve: { keys: { 0.5: 0, 0.25: 1 } } }", R"(shot.yaml:4:37: error: shutter.curve.keys has a key at 0.25 after one at 0.5
    shutter: { curve: { keys: { 0.5: 0, 0.25: 1 } } }
                                        ^~~~
  expected ascending fractions)"},
        {"{ curve: { keys: { 0: 0, 1: 0 } } }", R"(shot.yaml:4:27: error: shutter.curve.keys lets no light through
    shutter: { curve: { keys: { 0: 0, 1: 0 } } }
                              ^~~~~~~~~~~~~~
  expected a value above 0)"},
        {"{ rolling: { direction: down } }", R"(shot.yaml:4:21: error: shutter.rolling.duration is missing
    shutter: { rolling: { direction: down } }
                        ^~~~~~~~~~~~~~~~~~~
  add `duration: 10 ms`)"},
        {"{ angle: 0, exposure: physical }",
         R"(shot.yaml:4:32: error: shutter.exposure is physical, but the shutter does not open: every frame would be black
    shutter: { angle: 0, exposure: physical }
                                   ^~~~~~~~
  expected an angle or a time above 0, or exposure: constant)"},
    };
    for (const auto& [shutter, message] : cases)
        EXPECT_EQ(errors_of(std::string(kBase) + "shutter: " + shutter), message);
}

}  // namespace
}  // namespace kadr
