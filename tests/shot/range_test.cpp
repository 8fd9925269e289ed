// Values that leave their range between or beyond keys that keep to it, literally.
#include <gmock/gmock.h>

#include "shot/shot_fixture.h"
#include "shot/track_limits.h"

namespace kadr {
namespace {

using testing::HasSubstr;

class Range : public ShotTest {
protected:
    static std::string problems_of(const Shot& shot, double lead_s = 0) {
        std::string text;
        for (const Diagnostic& problem : values_out_of_range(shot.limited_tracks, Sequence(shot.timing, shot.shutter), lead_s)) text += problem.text() + "\n";
        return text;
    }
    /// Of a shot of 49 frames, 2 s, whose shutter is closed but for an instant; its fifth line.
    static std::string problems(const std::string& line) { return problems_of(parse("timing: { frames: 0-48 }\nshutter: 0\n" + line + "\n")); }
    static std::string of_light(const std::string& values) { return problems("lights: [ { id: key, type: spot, " + values + " } ]"); }
};

TEST_F(Range, SmoothSwingsBelowIt) {
    EXPECT_EQ(of_light("intensity: { keys: { 0 s: 8, 0.5 s: 0, 1 s: 0, 2 s: 8 }, interpolate: smooth }"),
              "shot.yaml:6:45: error: lights.key.intensity is -0.841507 cd at 0.7257 s (frame 17.42)\n"
              "    lights: [ { id: key, type: spot, intensity: { keys: { 0 s: 8, 0.5 s: 0, 1 s: 0, 2 s: 8 }, interpolate: smooth } } ]\n"
              "                                                ^~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~\n"
              "  expected at least 0 cd; smooth swings beyond its keys; add overshoot: false\n");
    EXPECT_EQ(of_light("intensity: { keys: { 0 s: 8, 0.5 s: 0, 1 s: 0, 2 s: 8 }, interpolate: smooth, overshoot: false }"), "");
}

TEST_F(Range, EveryWayOutIsNamed) {
    EXPECT_EQ(of_light("intensity: { keys: { 0 s: 8, 1 s: 4 }, after: continue }"), "");  // 0 at the end
    EXPECT_THAT(of_light("intensity: { keys: { 0 s: 8, 1 s: 2 }, after: continue }"),
                AllOf(HasSubstr("error: lights.key.intensity is -4 cd at 2 s (frame 48)\n"), HasSubstr("\n  expected at least 0 cd; the track goes on with its end's slope; use hold, or a key where it should stop\n")));
    EXPECT_THAT(of_light("intensity: { keys: { 0 s: { value: 8, ease: [0.5, 4, 0.5, -3] }, 1 s: 0 } }"),
                HasSubstr("\n  expected at least 0 cd; the ease of the key before swings beyond its ends; keep its y1 and y2 from 0 to 1\n"));
    EXPECT_THAT(of_light("intensity: { keys: { 0 s: { value: 0, out_tangent: -8 }, 1 s: { value: 0, in_tangent: 8 } }, interpolate: cubic }"),
                AllOf(HasSubstr("is -2 cd at 0.5 s (frame 12)\n"), HasSubstr("\n  expected at least 0 cd; its tangents carry it beyond its keys; make them flatter\n")));
}

TEST_F(Range, UnitsAreThoseOfTheField) {
    EXPECT_THAT(of_light("power: { keys: { 0 s: 8 lm, 1 s: 2 lm }, after: continue }"), HasSubstr("lights.key.power is -4 lm at 2 s"));
    EXPECT_THAT(of_light("outer: { keys: { 0 s: 60 deg, 1 s: 80 deg }, after: continue }"), HasSubstr("lights.key.outer is 100 deg at 2 s (frame 48)\n"));
    EXPECT_THAT(of_light("outer: { keys: { 0 s: 60 deg, 1 s: 80 deg }, after: continue }"), HasSubstr("expected more than 0 and at most 90 deg; "));
    EXPECT_THAT(of_light("radius: { keys: { 0 s: 40 cm, 1 s: 10 cm }, after: continue }"), HasSubstr("lights.key.radius is -0.2 m at 2 s"));
    EXPECT_THAT(problems("render: { integrator: path }\nview: { exposure: { keys: { 0 s: 0, 1 s: 150 }, after: continue } }"), HasSubstr("view.exposure is 300 stops at 2 s"));
}

TEST_F(Range, ComponentsAreChecked) {
    EXPECT_THAT(of_light("color: { keys: { 0 s: [1, 8, 1], 1 s: [1, 2, 1] }, after: continue }"), HasSubstr("lights.key.color[1] is -4 at 2 s"));
    EXPECT_THAT(problems("lights: [ { type: area, size: { keys: { 0 s: [2, 2], 1 s: [2, 1] }, after: continue } } ]"),
                AllOf(HasSubstr("lights.0.size[1] is 0 m at 2 s"), HasSubstr("expected more than 0 m; ")));
    // Of several the one that is farthest out is shown.
    EXPECT_THAT(of_light("color: { keys: { 0 s: [4, 4, 3], 1 s: [1, 0, 1] }, after: continue }"), HasSubstr("lights.key.color[1] is -4 at 2 s"));
}

TEST_F(Range, LimitsAboveZeroLeaveZeroOut) {
    EXPECT_THAT(of_light("range: { keys: { 0 s: 4, 1 s: 2 }, after: continue }"), HasSubstr("lights.key.range is 0 m at 2 s"));
    EXPECT_EQ(of_light("range: { keys: { 0 s: 4, 1 s: 2.001 }, after: continue }"), "");
}

TEST_F(Range, FieldsOfEverySectionAreChecked) {
    const auto camera = [](const std::string& text) { return problems_of(parse_shot_text("kadr: 1\nscenes: [ a.glb ]\ntiming: { frames: 0-48 }\ncamera: { " + text + " }\n", "shot.yaml")); };
    const auto scene = [](const std::string& text) {
        return problems_of(parse_shot_text("kadr: 1\nscenes: [ { gltf: a.glb, " + text + " } ]\ntiming: { frames: 0-48 }\ncamera: {}\n", "shot.yaml"));
    };
    EXPECT_THAT(camera("focal_length: { keys: { 0 s: 50 mm, 1 s: 20 mm }, after: continue }"), HasSubstr("camera.focal_length is -10.625 mm at 2.0208 s (frame 48.5)"));
    EXPECT_THAT(camera("orbit: { radius: { keys: { 0 s: 2, 1 s: 1 }, after: continue }, to: 1 s }"), HasSubstr("camera.orbit.radius is -0.0208333 m at 2.0208 s"));
    EXPECT_THAT(camera("shake: { amplitude: { keys: { 0 s: 2, 1 s: 1 }, after: continue } }"), HasSubstr("camera.shake.amplitude[0] is -0.0208333 m at"));
    EXPECT_THAT(camera("position: { path: [[0, 0, 0], [1, 0, 0]], at: { keys: { 0 s: 0, 1 s: 1 }, after: continue } }"),
                AllOf(HasSubstr("camera.position.at is 2.02083 at 2.0208 s"), HasSubstr("expected 0 to 1; ")));
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], closed: true, at: { keys: { 0 s: 0, 1 s: 1 }, after: continue } }"), "");
    EXPECT_THAT(scene("materials: { Paint: { roughness: { keys: { 0 s: 0, 1 s: 1 }, after: continue } } }"), HasSubstr("scenes.0.materials.Paint.roughness is 2.02083 at"));
    EXPECT_THAT(scene("animation: { weight: { keys: { 0 s: 1, 1 s: 0.2 }, after: continue } }"), HasSubstr("scenes.0.animation.weight is -0.616667 at"));
    EXPECT_THAT(problems("environment: { strength: { keys: { 0 s: 3, 1 s: 1 }, after: continue } }"), HasSubstr("environment.strength is -1 nt at 2 s"));
}

TEST_F(Range, OnlyWhatTheShutterSeesIsChecked) {
    const std::string light = "lights: [ { type: point, intensity: { keys: { 0 s: 8, 1 s: 4 }, after: continue, before: continue } } ]\n";
    EXPECT_EQ(problems_of(parse("timing: { frames: 0-48 }\nshutter: 0\n" + light)), "");
    EXPECT_THAT(problems_of(parse("timing: { frames: 0-48 }\nshutter: { angle: 180 deg }\n" + light)), HasSubstr("lights.0.intensity is -0.0833333 cd at 2.0208 s (frame 48.5)"));
    EXPECT_EQ(problems_of(parse("timing: { frames: 0-47 }\nshutter: { angle: 180 deg }\n" + light)), "");
    EXPECT_THAT(problems_of(parse("timing: { frames: 101-149, first: 101 }\nshutter: { angle: 360 deg, phase: centre }\n" + light)), HasSubstr("at 2.0208 s (frame 149.5)"));
    const std::string rising = "lights: [ { type: point, intensity: { keys: { 0 s: 0, 1 s: 24 }, before: continue } } ]\n";
    EXPECT_EQ(problems_of(parse("timing: { frames: 0-48 }\n" + rising)), "");
    EXPECT_THAT(problems_of(parse("timing: { frames: 0-48 }\n" + rising), 1 / 24.0), HasSubstr("lights.0.intensity is -1 cd at -0.0417 s (frame -1)"));
    // The exposure is that of the frame's own time, which the shutter need not meet.
    EXPECT_THAT(problems_of(parse("timing: { frames: 0-48 }\nshutter: { open: -0.5, close: -0.25 }\nview: { exposure: { keys: { 0 s: 0, 1 s: 101 }, after: continue } }\n")),
                HasSubstr("view.exposure is 202 stops at 2 s"));
}

TEST_F(Range, ValuesThatLookAllowedAreShownInFull) {
    EXPECT_THAT(of_light("outer: { keys: { 0 s: 30, 1 s: 60.00000001 }, after: continue }"), HasSubstr("lights.key.outer is 90.00000002"));
    // Within the rounding of the blend it is no offence: 0.09 + 0.455 * 2 comes out two ulps above 1.
    const Shot shot = parse_shot_text("kadr: 1\nscenes: [ { gltf: a.glb, materials: { Paint: { alpha: { keys: { 0 s: 0.09, 0.1 s: 0.1355 }, after: continue } } } } ]\n"
                                      "timing: { frames: 0-48 }\ncamera: {}\nshutter: 0\n", "shot.yaml");
    EXPECT_GT(evaluate(*shot.scenes[0].materials[0].alpha, 2), 1);
    EXPECT_EQ(problems_of(shot), "");
}

TEST_F(Range, ScalesKeepTheirSign) {
    const auto scene = [](const std::string& text) {
        return problems_of(parse_shot_text("kadr: 1\nscenes: [ { gltf: a.glb, " + text + " } ]\ntiming: { frames: 0-48 }\ncamera: {}\nshutter: 0\n", "shot.yaml"));
    };
    const auto scale = [&](const std::string& track) { return scene("transform: { scale: " + track + " }"); };
    EXPECT_EQ(scale("{ keys: { 0 s: 1, 1 s: [1, -1, 1] } }"),
              "shot.yaml:2:46: error: scenes.0.transform.scale[1] passes through zero at 0.5 s (frame 12)\n"
              "    scenes: [ { gltf: a.glb, transform: { scale: { keys: { 0 s: 1, 1 s: [1, -1, 1] } } } } ]\n"
              "                                                 ^~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~\n"
              "  expected a scale that keeps its sign; interpolate: step mirrors a thing at once, a tiny scale such as 1e-6 makes it vanish\n");
    EXPECT_EQ(scale("{ keys: { 0 s: 1, 1 s: -1 }, interpolate: step }"), "");
    EXPECT_EQ(scale("{ keys: { 0 s: 1, 5 s: -1 } }"), "");  // later than the last frame
    EXPECT_EQ(scale("{ keys: { 0 s: -1, 1 s: -2 } }"), "");
    EXPECT_THAT(scale("{ keys: { 0 s: 1, 0.5 s: 0.01, 1 s: 0.01, 2 s: 1 }, interpolate: smooth }"), HasSubstr("scenes.0.transform.scale[0] passes through zero at 0.5"));
    EXPECT_EQ(scale("{ keys: { 0 s: 1, 0.5 s: 0.01, 1 s: 0.01, 2 s: 1 }, interpolate: smooth, overshoot: false }"), "");
    EXPECT_THAT(scale("{ keys: { 0 s: 2, 1 s: 1 }, after: continue }"), HasSubstr("passes through zero at 2 s (frame 48)"));
    EXPECT_THAT(scene("nodes: { Wheel: { scale: { keys: { 0 s: [1, 1, 1], 1 s: [1, 1, -3] } } } }"), HasSubstr("scenes.0.nodes.Wheel.scale[2] passes through zero at 0.25 s (frame 6)"));
}

TEST_F(Range, DirectionsNeverVanish) {
    const auto sun = [](const std::string& track) { return problems("lights: [ { id: sun, type: directional, direction: " + track + " } ]"); };
    EXPECT_EQ(sun("{ keys: { 0 s: [1, 0, -3], 2 s: [-1, 0, 3] } }"),
              "shot.yaml:6:52: error: lights.sun.direction passes through zero at 1 s (frame 24)\n"
              "    lights: [ { id: sun, type: directional, direction: { keys: { 0 s: [1, 0, -3], 2 s: [-1, 0, 3] } } } ]\n"
              "                                                       ^~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~\n"
              "  expected a direction at every time; a key to one side of the others leads it round\n");
    EXPECT_EQ(sun("{ keys: { 0 s: [1, 0, -3], 2 s: [-1, 1e-3, 3] } }"), "");  // past it
    EXPECT_EQ(sun("{ keys: { 0 s: [1, 0, -3], 1 s: [0, -1, 0], 2 s: [-1, 0, 3] } }"), "");
    EXPECT_EQ(sun("{ keys: { 0 s: [1, -1, 0], 1 s: [-1, -1, 0], 2 s: [-1, 1, 0] } }"), "");  // x is zero at one time and y at another
    EXPECT_EQ(sun("{ keys: { 0 s: [1, 0, 0], 2 s: [-1, 0, 0] }, interpolate: step }"), "");
    EXPECT_EQ(sun("{ keys: { 0 s: [0, 0, 1], 0.7 s: [0, 1, 0], 5 s: [0, -1, 0] } }"), "");  // later than the last frame
    EXPECT_THAT(sun("{ keys: { 0 s: [0, 0, 1], 0.7 s: [0, 1, 0], 1.9 s: [0, -2, 0] } }"), HasSubstr("passes through zero at 1.1 s (frame 26.4)"));
    EXPECT_THAT(sun("{ keys: { 0 s: { value: [3, 1, 2], ease: [0.2, 0.9, 0.8, 0.1] }, 1 s: [-3, -1, -2] } }"), HasSubstr("passes through zero at 0.5 s (frame 12)"));
    EXPECT_THAT(problems_of(parse_camera("{ up: { keys: { 0 f: [0, 1, 0], 10 f: [0, -1, 0] } } }\ntiming: { frames: 0-48 }")), HasSubstr("camera.up passes through zero at 0.2083 s (frame 5)"));
}

TEST_F(Range, TheInnerConeStaysInsideTheOuter) {
    EXPECT_EQ(of_light("inner: { keys: { 0 s: 10 deg, 1 s: 40 deg } }, outer: 30 deg"),
              "shot.yaml:6:41: error: lights.key.inner is 40 deg at 1 s (frame 24), wider than outer at 30 deg\n"
              "    lights: [ { id: key, type: spot, inner: { keys: { 0 s: 10 deg, 1 s: 40 deg } }, outer: 30 deg } ]\n"
              "                                            ^~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~\n"
              "  expected inner to be at most outer at every time; both are half-angles\n");
    EXPECT_EQ(of_light("inner: { keys: { 0 s: 10 deg, 1 s: 30 deg } }, outer: 30 deg"), "");
    EXPECT_EQ(of_light("inner: { keys: { 0 s: 10 deg, 5 s: 80 deg } }, outer: 60 deg"), "");  // later than the last frame
    EXPECT_THAT(of_light("inner: 20 deg, outer: { keys: { 0 s: 30 deg, 0.5 s: 15 deg, 1 s: 30 deg } }"), HasSubstr("lights.key.inner is 20 deg at 0.5 s (frame 12), wider than outer at 15 deg\n"));
    EXPECT_THAT(of_light("inner: { keys: { 0 s: 44 deg, 1 s: 50 deg } }"), HasSubstr("lights.key.inner is 50 deg at 1 s (frame 24), wider than outer at 45 deg\n"));  // what outer is where it is not given
    EXPECT_EQ(of_light("outer: { keys: { 0 s: 30 deg, 1 s: 1 deg } }"), "");
    // Both pass through the same values at other times.
    EXPECT_THAT(of_light("inner: { keys: { 0 s: 10 deg, 1 s: 30 deg } }, outer: { keys: { 0 s: { value: 20 deg, ease: in }, 1 s: 40 deg } }"), "");
    EXPECT_THAT(of_light("inner: { keys: { 0 s: { value: 10 deg, ease: out }, 1 s: 30 deg } }, outer: { keys: { 0 s: { value: 12 deg, ease: in }, 1 s: 40 deg } }"),
                HasSubstr("wider than outer"));
}

TEST_F(Range, AFrameByItselfIsCheckedToo) {
    const Shot shot = parse("timing: { frames: 0-48 }\nshutter: 0\nlights: [ { id: key, type: point, intensity: { keys: { 0 s: 8, 1 s: 5 }, after: continue } } ]\n");
    EXPECT_EQ(problems_of(shot), "");
    const Sequence sequence(shot.timing, shot.shutter);
    EXPECT_TRUE(values_out_of_range(shot.limited_tracks, shot.timing, sequence.frame(60)).empty());
    const auto problems = values_out_of_range(shot.limited_tracks, shot.timing, sequence.at_time(3));
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_THAT(problems[0].text(), HasSubstr("lights.key.intensity is -1 cd at 3 s (frame 72)"));
    EXPECT_TRUE(values_out_of_range(shot.limited_tracks, shot.timing, sequence.at_time(2.5)).empty());
    EXPECT_EQ(values_out_of_range(shot.limited_tracks, shot.timing, sequence.at_time(2.7), 0.1).size(), 1u);
}

TEST_F(Range, OneProblemATrack) {
    const std::string text = of_light("intensity: { keys: { 0 s: { value: 1, out_tangent: -40 }, 1 s: { value: 1, in_tangent: -40 } }, interpolate: cubic, before: continue, after: continue }");
    EXPECT_EQ(std::count(text.begin(), text.end(), '^'), 1);
    EXPECT_THAT(text, HasSubstr("is -39 cd at 2 s"));
}

TEST_F(Range, WhatCannotLeaveItsKeysIsNotKept) {
    EXPECT_TRUE(parse("lights: [ { type: point, intensity: { keys: { 0 s: 8, 1 s: 4 }, after: pingpong } } ]\n").limited_tracks.empty());
    EXPECT_TRUE(parse("lights: [ { type: point, position: { keys: { 0 s: [8, 0, 0], 1 s: [4, 0, 0] }, after: continue } } ]\n").limited_tracks.empty());
    EXPECT_EQ(parse("lights: [ { type: point, intensity: { keys: { 0 s: 8, 1 s: 4 }, after: continue } } ]\n").limited_tracks.size(), 1u);
}

TEST_F(Range, TheSmallestAngleAboveZeroIsNotZero) {
    EXPECT_THAT(errors_of(std::string(kBase) + "lights: [ { type: spot, outer: 0 deg } ]\n"),
                AllOf(HasSubstr("error: lights.0.outer is 0 deg\n"), HasSubstr("  expected more than 0 and at most 90 deg")));
    EXPECT_EQ(errors_of(std::string(kBase) + "lights: [ { type: spot, outer: 1e-9 deg } ]\n"), "no error");
}

}  // namespace
}  // namespace kadr
