// What the forms of the format mean once they are read.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "base/text.h"
#include "shot/shot_fixture.h"

namespace kadr {
namespace {

using Values = ShotTest;
constexpr double kPi = std::numbers::pi;

TEST_F(Values, DefaultsAreThoseOfTheFormat) {
    const Shot shot = parse("");
    EXPECT_EQ(shot.name, "shot");
    EXPECT_EQ(shot.timing, Timing());
    EXPECT_EQ(shot.timing.fps, (Rational{24, 1}));
    EXPECT_FALSE(shot.frames_given);
    EXPECT_EQ(shot.image.width, 1280);
    EXPECT_EQ(shot.image.height, 720);
    ASSERT_EQ(shot.scenes.size(), 1u);
    EXPECT_EQ(shot.scenes[0].id, "a");
    EXPECT_EQ(shot.scenes[0].gltf, folder_ / "a.glb");
    EXPECT_EQ(shot.scenes[0].layers.at(0).clips, ClipLayer::Clips::all);
    EXPECT_EQ(shot.scenes[0].layers[0].speed, 1);
    EXPECT_EQ(shot.camera.up, Track<glm::dvec3>(glm::dvec3(0, 1, 0)));
    EXPECT_EQ(shot.camera.sensor_mm, glm::dvec2(36, 24));
    EXPECT_FALSE(shot.camera.focal_length_mm || shot.camera.vertical_fov_rad || shot.camera.f_stop ||
                 shot.camera.focus);
    EXPECT_EQ(shot.shutter, (Shutter{0, 0.5}));
    EXPECT_TRUE(shot.lights.empty());
    EXPECT_TRUE(shot.use_scene_lights);
    EXPECT_FALSE(shot.environment.given);
    EXPECT_EQ(shot.environment.color, Track<glm::dvec3>(glm::dvec3(0.53, 0.81, 0.92)));
    EXPECT_EQ(shot.render, RenderSpec());
    EXPECT_EQ(shot.render.samples, 64);
    EXPECT_EQ(shot.render.filter_width_px, 1.5);
    EXPECT_EQ(shot.view, ViewSpec());
    EXPECT_THAT(shot.output.frames, ::testing::ElementsAre((folder_ / "output/shot/shot.{frame:04}.png").string()));
    EXPECT_FALSE(shot.output.video);
    EXPECT_TRUE(shot.warnings.empty());
}

TEST_F(Values, EnvironmentIsBlackWhereThereAreLights) {
    const std::string light = "lights: [ { type: point } ]\n";
    EXPECT_EQ(parse(light).environment.color, Track<glm::dvec3>(glm::dvec3(0)));
    EXPECT_EQ(parse(light + "environment: { visible: false }").environment.color, Track<glm::dvec3>(glm::dvec3(0)));
    EXPECT_FALSE(parse(light + "environment: { visible: false }").environment.given);
    const EnvironmentSpec given = parse(light + "environment: { strength: 2 }").environment;
    EXPECT_TRUE(given.given);
    EXPECT_EQ(given.color, Track<glm::dvec3>(glm::dvec3(0.53, 0.81, 0.92)));
    EXPECT_EQ(given.strength, Track<double>(2.0));
    const EnvironmentSpec image = parse("environment: { image: sky.exr, rotate: 30 deg }").environment;
    EXPECT_EQ(image.image, folder_ / "sky.exr");
    EXPECT_EQ(image.color, Track<glm::dvec3>(glm::dvec3(1)));
    EXPECT_EQ(image.rotate_rad, Track<double>(30 * kPi / 180));
}

TEST_F(Values, UnitsAreConvertedExactlyOnce) {
    EXPECT_EQ(parse_camera("{ focal_length: 35 mm }").camera.focal_length_mm, Track<double>(35.0));
    EXPECT_EQ(parse_camera("{ focal_length: 35 }").camera.focal_length_mm, Track<double>(35.0));
    EXPECT_EQ(parse_camera("{ focal_length: 3.5cm }").camera.focal_length_mm, Track<double>(35.0));
    EXPECT_EQ(parse_camera("{ vertical_fov: 1 rad }").camera.vertical_fov_rad, Track<double>(1.0));
    EXPECT_EQ(parse_camera("{ vertical_fov: 90 }").camera.vertical_fov_rad, Track<double>(kPi / 2));
    EXPECT_EQ(parse_camera("{ position: [1, 20 cm, 35 mm] }").camera.position,
              Track<glm::dvec3>(glm::dvec3(1, 0.2, 0.035)));
    EXPECT_EQ(parse_camera("{ position: [+1e1, -.5, 2 km] }").camera.position,
              Track<glm::dvec3>(glm::dvec3(10, -0.5, 2000)));
    EXPECT_EQ(parse_scene("{ gltf: a.glb, animation: { start: 250 ms } }").scenes[0].layers.at(0).start_s, 0.25);
    EXPECT_EQ(parse_scene("{ gltf: a.glb, animation: { start: 12 f } }").scenes[0].layers.at(0).start_s, 0.5);
    EXPECT_EQ(parse("image: { size: [640 px, 360] }").image.width, 640);
}

TEST_F(Values, FrameRatesAreFractions) {
    EXPECT_EQ(parse("timing: { fps: 24000/1001 }").timing.fps, (Rational{24000, 1001}));
    EXPECT_EQ(parse("timing: { fps: 23.976 }").timing.fps, (Rational{2997, 125}));
    EXPECT_EQ(parse("timing: { fps: 30 }").timing.fps, (Rational{30, 1}));
}

TEST_F(Values, FramesTakeEveryForm) {
    EXPECT_THAT(parse("timing: { frames: 0-3 }").timing.frames, ::testing::ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(parse("timing:\n  frames: 5,9,12-14\n").timing.frames, ::testing::ElementsAre(5, 9, 12, 13, 14));
    EXPECT_THAT(parse("timing: { frames: \"5,9,12-14\" }").timing.frames, ::testing::ElementsAre(5, 9, 12, 13, 14));
    EXPECT_THAT(parse("timing: { frames: [0-4x2, 9] }").timing.frames, ::testing::ElementsAre(0, 2, 4, 9));
    EXPECT_THAT(parse("timing: { frames: 7 }").timing.frames, ::testing::ElementsAre(7));
    EXPECT_TRUE(parse("timing: { frames: 7 }").frames_given);
}

TEST_F(Values, KeyTimesAreExact) {
    const Shot shot = parse_shot_text(
        "kadr: 1\nscenes: [ a.glb ]\ntiming: { fps: 24000/1001, first: 1 }\ncamera: { f_stop: { keys: { 1 f: 1, "
        "80 ms: 3, 1 s: 4, 25 f: 2 } } }\n",
        "shot.yaml");
    const auto& keys = shot.camera.f_stop->keys;
    ASSERT_EQ(keys.size(), 4u);
    EXPECT_EQ(keys[0].time_s, 0);  // frame 1 is the first
    EXPECT_EQ(keys[0].value, 1);
    EXPECT_EQ(keys[1].time_s, 0.08);
    EXPECT_EQ(keys[2].time_s, 1);
    EXPECT_EQ(keys[3].time_s, 24.0 * 1001 / 24000);  // (25 - 1) / fps
    EXPECT_EQ(keys[3].value, 2);
}

TEST_F(Values, TracksHaveInterpolationAndEases) {
    const Shot shot = parse_camera(
        "{ f_stop: { keys: { 0 s: { value: 1, ease: in-out }, 1 s: { value: 2, ease: [0.1, -1, 0.2, 2] }, 2 s: { "
        "value: 3, ease: in }, 3 s: { value: 4, ease: out } }, interpolate: smooth, before: hold, after: hold } }");
    const Track<double>& track = *shot.camera.f_stop;
    EXPECT_EQ(track.interpolation, Interpolation::smooth);
    EXPECT_EQ(track.keys[0].ease, (Ease{0.42, 0, 0.58, 1}));
    EXPECT_EQ(track.keys[1].ease, (Ease{0.1, -1, 0.2, 2}));
    EXPECT_EQ(track.keys[2].ease, (Ease{0.42, 0, 1, 1}));
    EXPECT_EQ(track.keys[3].ease, (Ease{0, 0, 0.58, 1}));
    EXPECT_EQ(parse_camera("{ f_stop: { keys: { 0: 1, 1: 2 }, interpolate: step } }").camera.f_stop->interpolation,
              Interpolation::step);
    EXPECT_EQ(parse_camera("{ f_stop: { keys: { 0: 1, 1: 2 } } }").camera.f_stop->interpolation, Interpolation::linear);
}

glm::dquat orientation(const Shot& shot) { return shot.scenes[0].transform.rotate.orientation.keys.front().value; }

TEST_F(Values, RotationsTakeDegreesQuaternionsAndAxes) {
    const glm::dquat quarter(std::sqrt(0.5), 0, std::sqrt(0.5), 0);
    // One rounding of each of sine, cosine and normalisation.
    EXPECT_NEAR(
        std::abs(glm::dot(orientation(parse_scene("{ gltf: a.glb, transform: { rotate: [0, 90 deg, 0] } }")), quarter)),
        1, 1e-15);
    EXPECT_NEAR(std::abs(glm::dot(
                    orientation(parse_scene("{ gltf: a.glb, transform: { rotate: [0, 1.5707963267948966 rad, 0] } }")),
                    quarter)),
                1, 1e-15);
    EXPECT_NEAR(
        std::abs(glm::dot(orientation(parse_scene("{ gltf: a.glb, transform: { rotate: [0, 2, 0, 2] } }")), quarter)),
        1, 1e-15);
    const Shot turning = parse_scene(
        "{ gltf: a.glb, transform: { rotate: { axis: [0, 0, 2], angle: { keys: { 0 s: 0, 1 s: 720 } } } } }");
    const auto& axis_angle = turning.scenes[0].transform.rotate.axis_angle;
    ASSERT_TRUE(axis_angle);
    EXPECT_EQ(axis_angle->axis, glm::dvec3(0, 0, 1));
    EXPECT_EQ(axis_angle->angle_rad.keys[1].value, 4 * kPi);
}

TEST_F(Values, RotationsOfMoreThanHalfATurnAreWarnedAbout) {
    const Shot shot =
        parse_scene("{ gltf: a.glb, transform: { rotate: { keys: { 0 s: [0, 0, 0], 1 s: [0, 360, 0] } } } }");
    ASSERT_EQ(shot.warnings.size(), 1u);
    EXPECT_TRUE(shot.warnings[0].warning);
    EXPECT_EQ(shot.warnings[0].found, "scenes.0.transform.rotate turns more than 180 deg between two keys");
    // Step keys do not turn, so neither half a turn nor more is a problem.
    EXPECT_TRUE(parse_scene("{ gltf: a.glb, transform: { rotate: { keys: { 0 s: [0, 0, 0], 1 s: [0, 180, 0], 2 s: [0, "
                            "0, 0] }, interpolate: step } } }")
                    .warnings.empty());
}

TEST_F(Values, ScaleIsOneFactorOrThree) {
    EXPECT_EQ(parse_scene("{ gltf: a.glb, transform: { scale: 2 } }").scenes[0].transform.scale,
              Track<glm::dvec3>(glm::dvec3(2)));
    EXPECT_EQ(parse_scene("{ gltf: a.glb, transform: { scale: [1, -2, 3] } }").scenes[0].transform.scale,
              Track<glm::dvec3>(glm::dvec3(1, -2, 3)));
    EXPECT_EQ(parse_scene("{ gltf: a.glb, transform: { scale: { keys: { 0: 1, 1: [1, 2, 3] } } } }")
                  .scenes[0]
                  .transform.scale.keys[1]
                  .value,
              glm::dvec3(1, 2, 3));
}

TEST_F(Values, ClipsAreNamedCountedAllOrNone) {
    EXPECT_EQ(parse_scene("{ gltf: a.glb, animation: { clip: none } }").scenes[0].layers.at(0).clips, ClipLayer::Clips::none);
    const ClipLayer named = parse_scene("{ gltf: a.glb, animation: { clip: Walk, speed: -2 } }").scenes[0].layers.at(0);
    EXPECT_EQ(named.clips, ClipLayer::Clips::one);
    EXPECT_EQ(named.clip_name, "Walk");
    EXPECT_EQ(named.speed, -2);
    EXPECT_EQ(parse_scene("{ gltf: a.glb, animation: { clip: 3 } }").scenes[0].layers.at(0).clip_index, 3);
    EXPECT_EQ(parse_scene("{ gltf: a.glb, animation: { clip: \"all\" } }").scenes[0].layers.at(0).clip_name,
              "all");  // in quotes: a clip of that name
    EXPECT_EQ(parse_scene("{ gltf: a.glb, animation: { clip: \"3\" } }").scenes[0].layers.at(0).clip_name, "3");
}

TEST_F(Values, CameraLooksAtPointsNodesAndTracks) {
    EXPECT_EQ(parse_camera("{ look_at: [1, 2, 3] }").camera.look_at, Target(Track<glm::dvec3>(glm::dvec3(1, 2, 3))));
    EXPECT_EQ(std::get<NodeReference>(parse_camera("{ look_at: a/Visor }").camera.look_at).text, "a/Visor");
    EXPECT_EQ(std::get<NodeReference>(parse_camera("{ look_at: a/Visor }").camera.look_at).where,
              (SourceLocation{"shot.yaml", 3, 20}));
    EXPECT_EQ(std::get<PositionTrack>(
                  parse_camera("{ look_at: { keys: { 0: [0, 0, 0], 1: [1, 1, 1] } } }").camera.look_at)
                  .keyed.keys.size(),
              2u);
    EXPECT_EQ(parse_camera("{ gltf: a/Cam, focus: 2 m, f_stop: 4 }").camera.gltf->text, "a/Cam");
    EXPECT_EQ(std::get<Track<double>>(*parse_camera("{ focus: 150 cm }").camera.focus), Track<double>(1.5));
    EXPECT_EQ(std::get<NodeReference>(*parse_camera("{ focus: a }").camera.focus).text, "a");
    EXPECT_EQ(parse_camera("{ sensor: { size: [23.6, 15.6 mm], fit: vertical }, blades: 7 }").camera.fit,
              CameraSpec::Fit::vertical);
}

TEST_F(Values, ShutterHasAnAngleOrTwoTimes) {
    EXPECT_EQ(parse("shutter: { angle: 360 deg }").shutter, (Shutter{0, 1}));
    EXPECT_EQ(parse("shutter: { angle: 180 deg, phase: centre }").shutter, (Shutter{-0.25, 0.25}));
    EXPECT_EQ(parse("shutter: { angle: 90, phase: end }").shutter, (Shutter{-0.25, 0}));
    EXPECT_EQ(parse("shutter: { open: -0.25, close: 0.5 f }").shutter, (Shutter{-0.25, 0.5}));
    EXPECT_EQ(parse("shutter: 0").shutter, (Shutter{0, 0}));
    EXPECT_EQ(parse("shutter: { angle: 0 }").shutter, (Shutter{0, 0}));
}

TEST_F(Values, LightsHaveTheUnitsOfTheirKind) {
    const Shot shot = parse(
        "lights:\n"
        "  - { id: sun, type: directional, illuminance: 50000 lux, direction: [-1, -2, -1], angular_diameter: 0.53 deg "
        "}\n"
        "  - { id: key, type: spot, intensity: { keys: { 0 s: 0 cd, 2 s: 800 cd } }, inner: 20 deg, outer: 35 deg, "
        "range: 20 m, falloff: blender, look_at: a }\n"
        "  - { type: point, power: 800 lm, radius: 3 cm, color: [1, 0.5, 0] }\n"
        "  - { type: area, luminance: 2000 nt, size: [1, 0.5] }\n");
    ASSERT_EQ(shot.lights.size(), 4u);
    EXPECT_EQ(shot.lights[0].strength, Track<double>(50000.0));
    EXPECT_EQ(evaluate(shot.lights[0].angular_diameter_rad, 0), 0.53 * kPi / 180);
    EXPECT_EQ(shot.lights[1].strength.keys[1].value, 800);
    EXPECT_EQ(shot.lights[1].outer_rad, Track<double>(35 * kPi / 180));
    EXPECT_EQ(evaluate(shot.lights[1].range_m, 0), 20);
    EXPECT_EQ(shot.lights[1].falloff, SpotFalloff::blender);
    EXPECT_TRUE(shot.lights[1].look_at);
    EXPECT_EQ(shot.lights[2].strength, Track<double>(800 / (4 * kPi)));
    EXPECT_EQ(shot.lights[2].id, "point-2");
    EXPECT_EQ(shot.lights[2].radius_m, Track<double>(0.03));
    EXPECT_EQ(shot.lights[3].kind, LightKind::area);
    EXPECT_EQ(shot.lights[3].size_m, Track<glm::dvec2>(glm::dvec2(1, 0.5)));
}

TEST_F(Values, RenderSettingsTakeShortForms) {
    const RenderSpec whole = parse(
                                 "render: { integrator: direct, samples: 16, bounces: 3, filter: box, seed: 7, clamp: "
                                 "{ indirect: 10 }, cull_backfaces: true, fresnel: exact }")
                                 .render;
    EXPECT_EQ(whole.integrator, Integrator::direct);
    EXPECT_EQ(whole.bounces, (RenderSpec::Bounces{3, 3, 3, 3}));
    EXPECT_EQ(whole.filter, FilterKind::box);
    EXPECT_EQ(whole.filter_width_px, 1);
    EXPECT_EQ(whole.seed, 7u);
    EXPECT_FALSE(whole.clamp_direct);
    EXPECT_EQ(whole.clamp_indirect, 10);
    EXPECT_TRUE(whole.cull_backfaces);
    EXPECT_EQ(whole.fresnel, FresnelKind::exact);
    const RenderSpec parts = parse(
                                 "render: { bounces: { total: 6, diffuse: 2 }, filter: { type: mitchell, width: 2 px "
                                 "}, seed: { value: 4294967295, animated: true } }")
                                 .render;
    EXPECT_EQ(parts.bounces, (RenderSpec::Bounces{6, 2, 6, 6}));
    EXPECT_EQ(parts.filter_width_px, 2);
    EXPECT_EQ(parts.fresnel, FresnelKind::schlick);
    EXPECT_EQ(parts.seed, 4294967295u);
    EXPECT_TRUE(parts.seed_animated);
}

TEST_F(Values, ExposureTakesEveryForm) {
    EXPECT_EQ(parse("view: { transform: agx, exposure: -14.5 }").view.exposure_stops, -14.5);
    EXPECT_EQ(parse("view: { transform: pbr-neutral }").view.transform, ViewTransform::pbr_neutral);
    EXPECT_TRUE(parse("view: { exposure: auto }").view.automatic);
    // The factor is 1 / (1.2 * 2^ev100); two roundings of numbers near 15.
    EXPECT_NEAR(std::exp2(parse("view: { exposure: { ev100: 15 } }").view.exposure_stops), 1 / (1.2 * 32768), 1e-18);
    // f/16 at 1/100 s and ISO 100 is EV log2(25600).
    EXPECT_NEAR(parse("view: { exposure: { iso: 100, time: 10 ms, f_stop: 16 } }").view.exposure_stops,
                -std::log2(25600 * 1.2), 1e-13);
    EXPECT_NEAR(parse("view: { exposure: { iso: 200, time: 0.01 s, f_stop: 16 } }").view.exposure_stops,
                -std::log2(12800 * 1.2), 1e-13);
}

TEST_F(Values, OutputsFillTheNameIn) {
    const OutputSpec output =
        parse(
            "name: orbit\ntiming: { frames: 0-9 }\noutput: { frames: [\"out/{name}.{frame:04}.exr\", "
            "\"../{name}/{frame}.png\"], aovs: [ depth, motion ], png_bits: 16, video: \"{name}.mkv\" }")
            .output;
    EXPECT_THAT(output.frames, ::testing::ElementsAre((folder_ / "out/orbit.{frame:04}.exr").string(),
                                                      (folder_.parent_path() / "orbit/{frame}.png").string()));
    EXPECT_THAT(output.aovs, ::testing::ElementsAre(Aov::depth, Aov::motion));
    EXPECT_EQ(output.png_bits, 16);
    EXPECT_EQ(output.video->file, folder_ / "orbit.mkv");
    EXPECT_FALSE(output.video->codec);
    const VideoSpec video =
        *parse("output: { video: { file: a.mov, codec: h265, crf: 20, pixel_format: yuv422p10le } }").output.video;
    EXPECT_EQ(video.codec, VideoCodec::h265);
    EXPECT_EQ(video.crf, 20);
    EXPECT_EQ(video.pixel_format, "yuv422p10le");
    EXPECT_FALSE(parse("output: { video: none }").output.video);
}

TEST_F(Values, PathsInAFileAreRelativeToTheFile) {
    std::filesystem::create_directories("shots");
    const Shot shot = parse_shot_text(
        "kadr: 1\nscenes: [ ../a.glb ]\ncamera: {}\noutput: { frames: \"{frame}.png\" }\n", "shots/one.yaml");
    EXPECT_EQ(shot.scenes[0].gltf, folder_ / "a.glb");
    EXPECT_EQ(shot.output.frames[0], (folder_ / "shots/{frame}.png").string());
    EXPECT_EQ(shot.file, folder_ / "shots/one.yaml");
}

TEST_F(Values, FilesMayHaveAByteOrderMarkWindowsLinesAndAliases) {
    const Shot shot = parse_shot_text(
        "\xEF\xBB\xBFkadr: 1\r\nscenes: [ a.glb ]\r\ncamera: { position: &p [1, 2, 3], up: *p }\r\n", "shot.yaml");
    EXPECT_EQ(shot.camera.up, shot.camera.position);
}

}  // namespace
}  // namespace kadr
