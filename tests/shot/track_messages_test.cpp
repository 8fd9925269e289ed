// What tracks can be told that makes no sense, literally; and what they hold when it does.
#include <gmock/gmock.h>

#include <numbers>

#include "shot/shot_fixture.h"

namespace kadr {
namespace {

class TrackText : public ShotTest {
protected:
    /// Messages about a track of camera.f_stop, without the excerpt: "shot.yaml:3:21: error: ..." and what is expected.
    static std::string f_stop(const std::string& track) { return brief(errors_of("kadr: 1\nscenes: [ a.glb ]\ncamera: { f_stop: " + track + " }\n")); }
    static std::string rotation(const std::string& track) {
        return brief(errors_of("kadr: 1\nscenes: [ { gltf: a.glb, transform: { rotate: " + track + " } } ]\ncamera: {}\n"));
    }
    static RotationTrack parse_rotation(const std::string& track) {
        return parse_scene("{ gltf: a.glb, transform: { rotate: " + track + " } }").scenes[0].transform.rotate;
    }

private:
    static std::string brief(const std::string& messages) {
        std::string result;
        std::size_t begin = 0;
        while (begin < messages.size()) {
            const std::size_t end = std::min(messages.find('\n', begin), messages.size());
            const std::string line = messages.substr(begin, end - begin);
            if (line.rfind("    ", 0) != 0) result += (result.empty() ? "" : "\n") + line;
            begin = end + 1;
        }
        return result;
    }
};

TEST_F(TrackText, KeysStandInTheOrderOfTheirTimes) {
    EXPECT_EQ(f_stop("{ keys: { 2 s: 4, 0 s: 2, 1 s: 8 } }"),
              "shot.yaml:3:37: error: keys of camera.f_stop are out of order: 0 s comes after 2 s\n"
              "  expected keys in the order of their times");
    EXPECT_EQ(f_stop("{ keys: { 1 s: 4, 24 f: 2 } }"),
              "shot.yaml:3:37: error: two keys of camera.f_stop are at the same time, 1 s and 24 f\n"
              "  expected one key a time");
    EXPECT_EQ(f_stop("{ keys: { 1 s: 4, 1 s: 2 } }"),
              "shot.yaml:3:37: error: duplicate key '1 s'\n"
              "  it is already given at line 3; keep one of the two");
}

TEST_F(TrackText, ExtrapolationNeedsTwoKeys) {
    EXPECT_EQ(f_stop("{ keys: { 0 s: 4 }, before: continue, after: repeat }"),
              "shot.yaml:3:47: error: camera.f_stop.before is continue, but there is one key\n"
              "  expected two keys or more; one is a constant\n"
              "shot.yaml:3:64: error: camera.f_stop.after is repeat, but there is one key\n"
              "  expected two keys or more; one is a constant");
    EXPECT_EQ(f_stop("{ keys: { 0 s: 4, 1 s: 2 }, after: loop }"),
              "shot.yaml:3:54: error: camera.f_stop.after is 'loop'\n"
              "  expected one of hold, repeat, pingpong, continue");
}

TEST_F(TrackText, TangentsBelongToCubic) {
    EXPECT_EQ(f_stop("{ keys: { 0 s: { value: 4, out_tangent: 1 }, 1 s: 2 } }"),
              "shot.yaml:3:59: error: camera.f_stop.keys.0 s.out_tangent is given, but interpolate is linear\n"
              "  in_tangent and out_tangent belong to interpolate: cubic");
    EXPECT_EQ(f_stop("{ keys: { 0 s: 4, 1 s: 2 }, interpolate: cubic }"),
              "shot.yaml:3:60: error: camera.f_stop.interpolate is cubic, but no key has a tangent\n"
              "  expected keys such as { value: ..., in_tangent: ..., out_tangent: ... }; interpolate: smooth finds tangents itself");
    EXPECT_EQ(f_stop("{ keys: { 0 s: { value: 4, out_tangent: fast }, 1 s: 2 }, interpolate: cubic }"),
              "shot.yaml:3:59: error: camera.f_stop.keys.0 s.out_tangent is 'fast'\n"
              "  expected a number");
}

TEST_F(TrackText, OvershootBelongsToSmooth) {
    EXPECT_EQ(f_stop("{ keys: { 0 s: 4, 1 s: 2 }, overshoot: false }"),
              "shot.yaml:3:58: error: camera.f_stop.overshoot is given, but interpolate is linear\n"
              "  overshoot belongs to interpolate: smooth");
    EXPECT_EQ(rotation("{ keys: { 0 s: [0, 0, 0], 1 s: [0, 9, 0] }, interpolate: smooth, overshoot: false }"),
              "shot.yaml:2:123: error: scenes.0.transform.rotate.overshoot is false, but scenes.0.transform.rotate is a rotation\n"
              "  expected interpolate: linear, or { axis: [x, y, z], angle: { keys: ..., overshoot: false } }");
}

TEST_F(TrackText, SpinsBelongToRotations) {
    EXPECT_EQ(f_stop("{ keys: { 0 s: { value: 4, spin: 1 }, 1 s: 2 } }"),
              "shot.yaml:3:52: error: camera.f_stop.keys.0 s.spin is given, but camera.f_stop is no rotation\n"
              "  spin belongs to the keys of rotations; remove it");
    EXPECT_EQ(rotation("{ keys: { 0 s: [0, 0, 0], 1 s: { value: [0, 9, 0], spin: 2 } } }"),
              "shot.yaml:2:104: error: scenes.0.transform.rotate.keys.1 s.spin is on the last key\n"
              "  spin is about the way to the next key; put it on the key before");
    EXPECT_EQ(rotation("{ keys: { 0 s: { value: [0, 0, 0], spin: 2 }, 1 s: [0, 9, 0] }, interpolate: step }"),
              "shot.yaml:2:88: error: scenes.0.transform.rotate.keys.0 s.spin is given, but interpolate is step\n"
              "  spin and axis belong to interpolate: linear and smooth");
    EXPECT_EQ(rotation("{ keys: { 0 s: { value: [0, 0, 0], spin: 1.5 }, 1 s: [0, 9, 0] } }"),
              "shot.yaml:2:88: error: scenes.0.transform.rotate.keys.0 s.spin is 1.5\n"
              "  expected a whole number from -1000000 to 1000000");
}

TEST_F(TrackText, SpinsNeedADirection) {
    EXPECT_EQ(rotation("{ keys: { 0 s: [0, 0, 0], 2 s: [0, 180 deg, 0] } }"),
              "shot.yaml:2:73: error: keys 0 s and 2 s of scenes.0.transform.rotate are 180 deg apart\n"
              "  the way round is undefined; say it at the first, 0 s: { value: ..., axis: [x, y, z] }, or add a key between them");
    EXPECT_EQ(rotation("{ keys: { 0 s: { value: [0, 5, 0], spin: 2 }, 2 s: [0, 5, 0] } }"),
              "shot.yaml:2:57: error: keys 0 s and 2 s of scenes.0.transform.rotate are the same rotation\n"
              "  spin has no axis to turn about; add axis: [x, y, z]");
    EXPECT_EQ(rotation("{ keys: { 0 s: { value: [0, 0, 0], axis: [1, 0, 0] }, 2 s: [0, 180 deg, 0] } }"),
              "shot.yaml:2:88: error: scenes.0.transform.rotate.keys.0 s.axis is at right angles to the turn to the next key\n"
              "  expected a direction on one side of it: the turn is about [0, 1, 0]");
    EXPECT_EQ(rotation("{ keys: { 0 s: { value: [0, 0, 0], axis: [0, 0, 0] }, 2 s: [0, 90, 0] } }"),
              "shot.yaml:2:88: error: scenes.0.transform.rotate.keys.0 s.axis is zero\n"
              "  expected a direction, a vector of any length but zero");
}

TEST_F(TrackText, TrackHoldsWhatItIsTold) {
    const auto track = *parse_camera("{ f_stop: { keys: { 0 s: { value: 4, out_tangent: -1 }, 1 s: { value: 2, in_tangent: 3, out_tangent: 5 } }, "
                                     "interpolate: cubic, before: pingpong, after: continue } }").camera.f_stop;
    EXPECT_EQ(track.interpolation, Interpolation::cubic);
    EXPECT_EQ(track.before, Extrapolation::pingpong);
    EXPECT_EQ(track.after, Extrapolation::continued);
    EXPECT_EQ(track.keys[0].in_tangent, -1);  // the other one where it is not given
    EXPECT_EQ(track.keys[0].out_tangent, -1);
    EXPECT_EQ(track.keys[1].in_tangent, 3);
    EXPECT_EQ(track.keys[1].out_tangent, 5);
    EXPECT_FALSE(parse_camera("{ f_stop: { keys: { 0 s: 2, 1 s: 4 }, interpolate: smooth, overshoot: false } }").camera.f_stop->overshoot);
}

TEST_F(TrackText, TangentsHaveTheValuesUnit) {
    const Track<double> fov = *parse_camera("{ vertical_fov: { keys: { 0 s: { value: 40 deg, out_tangent: 3.141592653589793 rad }, 1 s: 50 deg }, interpolate: cubic } }").camera.vertical_fov_rad;
    EXPECT_DOUBLE_EQ(fov.keys[0].out_tangent, std::numbers::pi);
    EXPECT_EQ(fov.keys[1].in_tangent, 0);
    const Shot lit = parse("lights: [ { type: point, power: { keys: { 0 s: { value: 100, out_tangent: 12.566370614359172 }, 1 s: 0 }, interpolate: cubic } } ]");
    EXPECT_DOUBLE_EQ(lit.lights[0].strength.keys[0].out_tangent, 1);  // in candela, as the value
}

TEST_F(TrackText, RotationsTakeTurnRatesAndSpins) {
    const RotationTrack cubic = parse_rotation("{ keys: { 0 s: { value: [0, 0, 0], out_tangent: [0, 90, 0] }, 1 s: { value: [0, 60, 0], in_tangent: [0, 0.5, 0, 0.25] } }, interpolate: cubic }");
    EXPECT_NEAR(cubic.orientation.keys[0].out_tangent.y, std::numbers::pi / 4, 1e-15);  // half of 90 degrees a second
    EXPECT_EQ(cubic.orientation.keys[1].in_tangent, glm::dquat(0.25, 0, 0.5, 0));
    const RotationTrack spun = parse_rotation("{ keys: { 0 s: { value: [0, 0, 0], spin: -3, axis: [0, 2, 0] }, 1 s: [0, 180, 0] } }");
    ASSERT_TRUE(spun.orientation.keys[0].spin);
    EXPECT_EQ(*spun.orientation.keys[0].spin, (Spin{-3, {0, 1, 0}}));
}

TEST_F(TrackText, ATurnOfMoreThanHalfIsNoSurpriseWhenItIsStated) {
    EXPECT_EQ(parse_scene("{ gltf: a.glb, transform: { rotate: { keys: { 0 s: [0, 0, 0], 1 s: [0, 270, 0] } } } }").warnings.size(), 1u);
    EXPECT_TRUE(parse_scene("{ gltf: a.glb, transform: { rotate: { keys: { 0 s: { value: [0, 0, 0], axis: [0, 1, 0] }, 1 s: [0, 270, 0] } } } }").warnings.empty());
}

TEST_F(TrackText, TimingIsChecked) {
    EXPECT_EQ(errors_of("kadr: 1\nscenes: [ a.glb ]\ncamera: {}\ntiming: { fps: 0 }\n"),
              "shot.yaml:4:16: error: timing.fps is 0\n    timing: { fps: 0 }\n                   ^\n  expected frames a second, such as 24, 23.976 or 24000/1001");
    EXPECT_EQ(errors_of("kadr: 1\nscenes: [ a.glb ]\ncamera: {}\ntiming: { frames: 9-5 }\n"),
              "shot.yaml:4:19: error: timing.frames is 9-5: '9-5' runs backwards; write 5-9\n    timing: { frames: 9-5 }\n                      ^~~\n"
              "  expected frames as \"0-95\", \"0-95x2\" (every second one) or \"5,9,12-20\"");
}

}  // namespace
}  // namespace kadr
