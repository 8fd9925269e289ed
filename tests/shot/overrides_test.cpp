#include <gmock/gmock.h>

#include "shot/shot_fixture.h"

namespace kadr {
namespace {

class Overrides : public ShotTest {
protected:
    static Shot with(const std::string& key, const std::string& value, const std::string& lines = "") {
        return parse(lines, set(key, value));
    }
    static std::string errors(const std::string& key, const std::string& value, const std::string& lines = "") {
        return errors_of(kBase + lines, set(key, value));
    }
    static ShotOverrides set(const std::string& key, const std::string& value) {
        ShotOverrides overrides;
        overrides.set = {{key, value}};
        return overrides;
    }
    static constexpr const char* kLights = "lights: [ { id: key, type: point, intensity: 3 }, { type: area } ]\n";
};

TEST_F(Overrides, ReplaceAndAddValues) {
    EXPECT_EQ(with("render.samples", "16", "render: { samples: 4 }\n").render.samples, 16);
    EXPECT_EQ(with("render.samples", "16").render.samples, 16);
    EXPECT_EQ(with("lights.key.intensity", "5 cd", kLights).lights[0].strength, Track<double>(5.0));
    EXPECT_EQ(with("lights.1.luminance", "{ keys: { 0 s: 1, 1 s: 2 } }", kLights).lights[1].strength.keys.size(), 2u);
    EXPECT_EQ(with("camera.position", "[1, 2, 3]").camera.position, Track<glm::dvec3>(glm::dvec3(1, 2, 3)));
}

TEST_F(Overrides, AreNamedInMessages) {
    EXPECT_EQ(
        errors("render.samples", "many"),
        "--set render.samples=many: error: render.samples is 'many'\n  expected a whole number from 1 to 1048576 or a map of max_error, at_least, at_most, time_budget, time_budget_shot");
    EXPECT_EQ(errors("render.sampels", "3"),
              "--set render.sampels=3: error: unknown key 'sampels' in render\n  did you mean 'samples'?");
    EXPECT_EQ(errors("lights.kye.intensity", "3", kLights),
              "--set lights.kye.intensity=3: error: there is no entry 'kye'\n  the list has: key, 1");
    EXPECT_EQ(errors("render..samples", "3"),
              "--set render..samples=3: error: 'render..samples' is not a key path\n  expected a path such as "
              "render.samples or lights.key.intensity");
    EXPECT_EQ(errors("render.seed.value", "3", "render: { seed: 5 }\n"),
              "--set render.seed.value=3: error: 'value' is below '5', which is not a section here\n  set the whole "
              "value instead, for example --set 'render.seed={ value: 7, animated: true }'");
    EXPECT_THAT(errors("render", "{ samples: [ }"),
                ::testing::StartsWith("--set render={ samples: [ }: error: this is not valid YAML: "));
}

TEST_F(Overrides, OfTheCommandLineWin) {
    ShotOverrides overrides;
    overrides.frames = "1-5x2,40";
    overrides.output = "here.{frame}.png";
    overrides.video = "film.mkv";
    overrides.samples = 3;
    overrides.width = 64;
    overrides.height = 36;
    std::filesystem::create_directories("shots");
    const Shot shot = parse_shot_text(
        "kadr: 1\nscenes: [ ../a.glb ]\ncamera: {}\nrender: { samples: 9 }\noutput: { video: { file: x.mp4, codec: "
        "h265 } }\n",
        "shots/one.yaml", overrides);
    EXPECT_THAT(shot.timing.frames, ::testing::ElementsAre(1, 3, 5, 40));
    EXPECT_TRUE(shot.frames_given);
    EXPECT_THAT(shot.output.frames, ::testing::ElementsAre((folder_ / "here.{frame}.png").string()));
    EXPECT_EQ(shot.output.video->file, folder_ / "film.mkv");
    EXPECT_FALSE(shot.output.video->codec);  // the file's codec belonged to another kind of file
    EXPECT_EQ(shot.render.samples, 3);
    EXPECT_EQ(shot.image.width, 64);
    EXPECT_EQ(shot.image.height, 36);
}

TEST_F(Overrides, OfTheVideoKeepItsSettingsForTheSameKindOfFile) {
    ShotOverrides overrides;
    overrides.video = "film.mp4";
    const std::string lines = "output: { video: { file: x.mp4, crf: 30 } }\n";
    EXPECT_EQ(parse(lines, overrides).output.video->crf, 30);
    EXPECT_EQ(parse(lines, overrides).output.video->file, folder_ / "film.mp4");
    overrides.video = "none";
    EXPECT_FALSE(parse(lines, overrides).output.video);
}

TEST_F(Overrides, ReportTheirOwnProblems) {
    ShotOverrides overrides;
    overrides.frames = "9-5";
    overrides.video = "a.avi";
    const std::string errors = errors_of(kBase, overrides);
    EXPECT_THAT(errors, ::testing::HasSubstr("--frames 9-5: error: timing.frames is 9-5: "));
    EXPECT_THAT(errors,
                ::testing::HasSubstr("--video a.avi: error: output.video is 'a.avi'\n  expected a file that ends in"));
}

TEST_F(Overrides, HoldNoKeyTwice) {
    ShotOverrides overrides;
    overrides.set = {{"camera.dolly", "{ keys: { 1 s: 0 m, 1 s: 1 m } }"}};
    EXPECT_EQ(errors_of(kBase, overrides), "--set camera.dolly={ keys: { 1 s: 0 m, 1 s: 1 m } }: error: duplicate key '1 s'\n"
                                           "  it is given twice; keep one of the two");
}

}  // namespace
}  // namespace kadr
