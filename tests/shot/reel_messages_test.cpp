// What a reel file says when it is wrong: every message letter by letter.
#include "shot/reel.h"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "shot/schema.h"
#include "shot_fixture.h"

namespace kadr {
namespace {

using ::testing::HasSubstr;

class ReelTest : public ShotTest {
protected:
    void SetUp() override {
        ShotTest::SetUp();
        write("one.yaml", std::string(kBase) + "timing: { fps: 24, frames: 0-47 }\n");
        write("two.yaml", std::string(kBase) + "timing: { fps: 25, frames: 0-49 }\nimage: { size: [100, 50] }\n");
        write("inner.yaml", "kadr-reel: 1\nshots: [ one.yaml ]\n");
        write("sound.wav", "x");
    }
    static void write(const char* name, const std::string& text) { std::ofstream(name) << text; }
    static Reel parse(const std::string& text, const ShotOverrides& overrides = {}) {
        write("reel.yaml", text);
        return parse_reel("reel.yaml", overrides);
    }
    static std::string errors_of_reel(const std::string& text, const ShotOverrides& overrides = {}) {
        try {
            parse(text, overrides);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }
};

struct Case {
    const char* text;  ///< after "kadr-reel: 1\n"
    const char* message;
};

TEST_F(ReelTest, SaysWhatIsWrong) {
    const Case cases[] = {
        {"shots: []\n", R"(reel.yaml:2:8: error: shots is an empty list
    shots: []
           ^~
  expected a list of maps; for example shots: [ turntable.yaml, { shot: spin.yaml, out: 1 s } ])"},
        {"name: a\n", R"(reel.yaml:1:1: error: shots is missing
    kadr-reel: 1
    ^
  add `shots: [ turntable.yaml, { shot: spin.yaml, out: 1 s, crossfade: 12 f } ]`)"},
        {"shots: [ inner.yaml ]\n", R"(reel.yaml:2:10: error: shots.0 is 'inner.yaml', which is a reel
    shots: [ inner.yaml ]
             ^~~~~~~~~~
  expected a shot; a reel cannot hold another: list that one's shots here)"},
        {"shots:\n  - { shot: one.yaml, in: 2 s, out: 24 f }\n",
         R"(reel.yaml:3:37: error: shots.0.out is 24 f, not after shots.0.in at 2 s
      - { shot: one.yaml, in: 2 s, out: 24 f }
                                        ^~~~
  expected an out point after the in point)"},
        {"shots:\n  - { shot: one.yaml, crossfade: 6 f }\n",
         R"(reel.yaml:3:34: error: shots.0.crossfade is 6 f, but no shot follows
      - { shot: one.yaml, crossfade: 6 f }
                                     ^~~
  remove the key, or use fade_out)"},
        {"shots:\n  - { shot: one.yaml, crossfade: 6 f }\n  - { shot: two.yaml, fade_in: 1 s }\n",
         R"(reel.yaml:4:32: error: shots.1.fade_in meets shots.0.crossfade
      - { shot: two.yaml, fade_in: 1 s }
                                   ^~~
  remove one of the two: a shot is mixed with the next one, or fades to a colour)"},
        {"shots:\n  - { shot: one.yaml, fade_out: { to: white, duration: 1 s }, crossfade: 6 f }\n  - two.yaml\n",
         R"(reel.yaml:3:33: error: shots.0.fade_out meets shots.0.crossfade
      - { shot: one.yaml, fade_out: { to: white, duration: 1 s }, crossfade: 6 f }
                                    ^~~~~~~~~~~~~~~~~~~~~~~~~~~~
  remove one of the two: a shot is mixed with the next one, or fades to a colour)"},
        {"shots: [ { shot: one.yaml, crossfad: 1 s } ]\n", R"(reel.yaml:2:28: error: unknown key 'crossfad' in shots.0
    shots: [ { shot: one.yaml, crossfad: 1 s } ]
                               ^~~~~~~~
  did you mean 'crossfade'?)"},
        {"shots: [ one.yaml ]\nsounds: a.wav\n", R"(reel.yaml:3:1: error: unknown key 'sounds'
    sounds: a.wav
    ^~~~~~
  did you mean 'sound'?)"},
        {"shots: [ one.yaml ]\nfps: 0\n", R"(reel.yaml:3:6: error: fps is 0
    fps: 0
         ^
  expected frames a second, such as 24, 23.976 or 24000/1001)"},
        {"shots: [ one.yaml ]\nshots: [ two.yaml ]\n", R"(reel.yaml:3:1: error: duplicate key 'shots'
    shots: [ two.yaml ]
    ^~~~~
  it is already given at line 2; keep one of the two)"},
        {"shots: [ { shot: one.yaml, fade_in: { from: red, duration: 1 s } } ]\n",
         R"(reel.yaml:2:45: error: shots.0.fade_in.from is 'red'
    shots: [ { shot: one.yaml, fade_in: { from: red, duration: 1 s } } ]
                                                ^~~
  expected [x, y, z], each 0 to 1 or one of black, white)"},
        {"shots: [ { shot: one.yaml, fade_in: { from: black } } ]\n",
         R"(reel.yaml:2:37: error: shots.0.fade_in.duration is missing
    shots: [ { shot: one.yaml, fade_in: { from: black } } ]
                                        ^~~~~~~~~~~~~~~
  add `duration: 12 f`)"},
        {"shots: [ { shot: one.yaml, speed: 0 } ]\n", R"(reel.yaml:2:35: error: shots.0.speed is 0
    shots: [ { shot: one.yaml, speed: 0 } ]
                                      ^
  expected 0.01 to 100)"},
        {"shots: [ { shot: one.yaml, set: 5 } ]\n", R"(reel.yaml:2:33: error: shots.0.set is 5
    shots: [ { shot: one.yaml, set: 5 } ]
                                    ^
  expected a map of key paths and values such as { render.samples: 16 })"},
        {"shots: [ { shot: one.yaml, set: { render.sampels: 16 } } ]\n",
         R"(reel.yaml:2:35: error: unknown key 'sampels' in render
    shots: [ { shot: one.yaml, set: { render.sampels: 16 } } ]
                                      ^~~~~~~~~~~~~~
  did you mean 'samples'?)"},
        {"shots: [ { shot: one.yaml, set: { render.samples: 0 } } ]\n",
         R"(reel.yaml:2:51: error: render.samples is 0
    shots: [ { shot: one.yaml, set: { render.samples: 0 } } ]
                                                      ^
  expected a whole number from 1 to 1048576 or a map of max_error, at_least, at_most, time_budget, time_budget_shot)"},
        {"shots: [ one.yaml ]\noutput: { frames: \"a.{frame}.exr\" }\n",
         R"(reel.yaml:3:19: error: output.frames is 'a.{frame}.exr'
    output: { frames: "a.{frame}.exr" }
                      ^~~~~~~~~~~~~~~
  expected a pattern that ends in .png or .jpg: a reel is display-referred, and the linear frames of its shots are theirs)"},
        {"shots: [ one.yaml ]\noutput: { frames: a.png }\n",
         R"(reel.yaml:3:19: error: output.frames is 'a.png', the same file for every frame
    output: { frames: a.png }
                      ^~~~~
  expected {frame} or {frame:04} in the pattern)"},
        {"shots: [ one.yaml ]\noutput: { shots: \"{shot}.png\" }\n",
         R"(reel.yaml:3:18: error: output.shots is '{shot}.png', the same file for several frames
    output: { shots: "{shot}.png" }
                     ^~~~~~~~~~~~
  expected both {shot} and {frame} or {frame:04} in the pattern)"},
        {"shots: [ one.yaml ]\noutput: { shots: \"{scene}.{frame}.png\" }\n",
         R"(reel.yaml:3:18: error: output.shots has '{scene}', which is no placeholder
    output: { shots: "{scene}.{frame}.png" }
                     ^~~~~~~~~~~~~~~~~~~~~
  expected {name}, {shot}, {frame} or {frame:04})"},
        {"shots: [ one.yaml ]\nsound: { file: sound.wav, gain: 3 db }\n", R"(reel.yaml:3:33: error: sound.gain is 3 db
    sound: { file: sound.wav, gain: 3 db }
                                    ^~~~
  expected -120 to 60 dB; 'db' is not one of its units (dB))"},
    };
    for (const Case& each : cases)
        EXPECT_EQ(errors_of_reel(std::string("kadr-reel: 1\n") + each.text), each.message) << each.text;
}

TEST_F(ReelTest, NamesTheNearestFile) {
    EXPECT_EQ(errors_of_reel("kadr-reel: 1\nshots: [ { shot: on.yaml } ]\n"),
              "reel.yaml:2:18: error: shots.0.shot is 'on.yaml', which does not exist\n"
              "    shots: [ { shot: on.yaml } ]\n"
              "                     ^~~~~~~\n"
              "  expected a file, looked for as " + (folder_ / "on.yaml").string() + "; did you mean 'one.yaml'?");
    EXPECT_EQ(errors_of_reel("kadr-reel: 1\nshots: [ one.yaml ]\nsound: sund.wav\n"),
              "reel.yaml:3:8: error: sound is 'sund.wav', which does not exist\n"
              "    sound: sund.wav\n"
              "           ^~~~~~~~\n"
              "  expected a file, looked for as " + (folder_ / "sund.wav").string() + "; did you mean 'sound.wav'?");
}

TEST_F(ReelTest, SaysEverythingAtOnceAndTheErrorsOfAShotOnce) {
    write("bad.yaml", std::string(kBase) + "render: { samples: 0 }\n");
    const std::string errors = errors_of_reel("kadr-reel: 2\nshots: [ bad.yaml, bad.yaml, { shot: one.yaml, hold: 1 m } ]\n");
    EXPECT_EQ(errors, R"(reel.yaml:1:12: error: the reel is written in format version 2
    kadr-reel: 2
               ^
  expected kadr-reel: 1; this Kadr reads version 1
reel.yaml:2:54: error: shots.2.hold is 1 m
    shots: [ bad.yaml, bad.yaml, { shot: one.yaml, hold: 1 m } ]
                                                         ^~~
  expected 0 to 86400 s; 'm' is not one of its units (s, ms, f)
bad.yaml:4:20: error: render.samples is 0
    render: { samples: 0 }
                       ^
  expected a whole number from 1 to 1048576 or a map of max_error, at_least, at_most, time_budget, time_budget_shot)");
}

TEST_F(ReelTest, AnEmptyFileIsNoReel) {
    EXPECT_FALSE(is_reel("one.yaml"));
    EXPECT_FALSE(is_reel("nowhere.yaml"));
    write("broken.yaml", "kadr-reel: [\n");
    EXPECT_FALSE(is_reel("broken.yaml"));
    EXPECT_TRUE(is_reel("inner.yaml"));
}

TEST_F(ReelTest, TakesThePictureOfTheFirstShotUnlessItIsGiven) {
    Reel reel = parse("kadr-reel: 1\nshots: [ two.yaml, one.yaml ]\n");
    EXPECT_EQ(reel.name, "reel");
    EXPECT_EQ(reel.fps, (Rational{25, 1}));
    EXPECT_EQ(reel.image.width, 100);
    EXPECT_EQ(reel.output.video->file, folder_ / "output/reel.mp4");
    EXPECT_EQ(reel.shot_frames, (folder_ / "output/reel/{shot}/{shot}.{frame:04}.png").string());
    EXPECT_TRUE(reel.output.frames.empty());
    reel = parse("kadr-reel: 1\nname: show\nfps: 24000/1001\nsize: [64, 36]\nbars: [0, 0.5, 1]\nblend: linear\n"
                 "shots: [ two.yaml ]\noutput: { video: none, frames: \"f/{name}.{frame:02}.png\", png_bits: 16 }\n");
    EXPECT_EQ(reel.fps, (Rational{24000, 1001}));
    EXPECT_EQ(reel.image.height, 36);
    EXPECT_EQ(reel.bars, glm::dvec3(0, 0.5, 1));
    EXPECT_EQ(reel.blend, ReelBlend::linear);
    EXPECT_FALSE(reel.output.video);
    EXPECT_EQ(reel.output.frames.front(), (folder_ / "f/show.{frame:02}.png").string());
    EXPECT_EQ(reel.output.png_bits, 16);
}

TEST_F(ReelTest, FramesAreTheShotsInItsTimesAndTheReelsInDurations) {
    const Reel reel = parse("kadr-reel: 1\nshots:\n"
                            "  - { shot: one.yaml, in: 12 f, out: 36 f, hold: 12 f, crossfade: 6 f }\n"
                            "  - { shot: two.yaml, in: 10 f, speed: 0.5, fade_out: { to: white, duration: 24 f } }\n");
    EXPECT_DOUBLE_EQ(reel.entries[0].in->seconds, 0.5);
    EXPECT_DOUBLE_EQ(reel.entries[0].out->seconds, 1.5);
    EXPECT_DOUBLE_EQ(reel.entries[0].hold.seconds, 0.5);
    EXPECT_EQ(reel.entries[0].crossfade.written, "6 f");
    EXPECT_DOUBLE_EQ(reel.entries[1].in->seconds, 0.4) << "10 frames at the 25 of the shot";
    EXPECT_FALSE(reel.entries[1].out);
    EXPECT_EQ(reel.entries[1].speed, 0.5);
    EXPECT_DOUBLE_EQ(reel.entries[1].fade_out.duration.seconds, 1.0) << "24 frames at the 24 of the reel";
    EXPECT_EQ(reel.entries[1].fade_out.color, glm::dvec3(1));
}

TEST_F(ReelTest, LaysTheEntrysValuesAndTheCommandLineOverTheShots) {
    ShotOverrides overrides;
    overrides.set = {{"render.bounces", "3"}, {"reel.fps", "30"}, {"reel.shots.1.hold", "2 s"}};
    overrides.samples = 5;
    overrides.width = 40;
    overrides.height = 20;
    overrides.video = "draft.mkv";
    const Reel reel = parse("kadr-reel: 1\nshots:\n  - one.yaml\n"
                            "  - { shot: one.yaml, set: { render.samples: 9, view.exposure: 1 } }\n", overrides);
    EXPECT_EQ(reel.fps, (Rational{30, 1}));
    EXPECT_EQ(reel.image.width, 40);
    EXPECT_EQ(reel.output.video->file, folder_ / "draft.mkv");
    EXPECT_EQ(reel.entries[1].hold.seconds, 2);
    EXPECT_EQ(reel.entries[0].shot.image.width, 1280) << "the size is the reel's; shots are fitted later";
    for (const ReelEntry& entry : reel.entries) {
        EXPECT_EQ(entry.shot.render.samples, 5) << "the command line wins";
        EXPECT_EQ(entry.shot.render.bounces.total, 3);
    }
    EXPECT_FALSE(reel.entries[0].changed);
    EXPECT_TRUE(reel.entries[1].changed);
    EXPECT_EQ(reel.entries[1].shot.view.exposure_stops, 1);
}

TEST_F(ReelTest, NamesSettingsOfTheCommandLineAsTheyWereTyped) {
    ShotOverrides overrides;
    overrides.set = {{"reel.fps", "0"}};
    EXPECT_EQ(errors_of_reel("kadr-reel: 1\nshots: [ one.yaml ]\n", overrides), "--set reel.fps=0: error: fps is 0\n  expected frames a second, such as 24, 23.976 or 24000/1001");
}

TEST_F(ReelTest, ReadsItsSound) {
    const Reel reel = parse("kadr-reel: 1\nshots: [ one.yaml ]\nsound: { file: sound.wav, start: 1 s, offset: 12 f, "
                            "gain: -6 dB, fade_in: 100 ms, fade_out: 2 s, loop: true }\n");
    EXPECT_EQ(reel.sound->file, folder_ / "sound.wav");
    EXPECT_EQ(reel.sound->start_s, 1);
    EXPECT_EQ(reel.sound->offset_s, 0.5);
    EXPECT_EQ(reel.sound->gain_db, -6);
    EXPECT_EQ(reel.sound->fade_in_s, 0.1);
    EXPECT_EQ(reel.sound->fade_out_s, 2);
    EXPECT_TRUE(reel.sound->loop);
}

TEST(ReelSchema, HasEachKeyOnceBelowASectionWithAnExample) {
    std::set<std::string> seen;
    const std::string manual = describe_schema("");
    for (const FieldSpec& field : reel_table()) {
        const std::string path = field.path;
        EXPECT_TRUE(seen.insert(path).second) << path;
        EXPECT_NE(std::string(field.example), "") << path;
        EXPECT_TRUE(path == "reel" || seen.count(path.substr(0, path.rfind('.')))) << path;
        EXPECT_THAT(describe_schema(path), HasSubstr(field.doc));
        EXPECT_TRUE(path == "reel" || manual.find(field.doc) != std::string::npos) << path;
    }
}

TEST(ReelSchema, GoesOutAsJson) {
    const nlohmann::json schema = nlohmann::json::parse(schema_as_json("reel"));
    EXPECT_EQ(schema["required"], (nlohmann::json{"kadr-reel", "shots"}));
    EXPECT_EQ(schema["properties"]["kadr-reel"]["const"], 1);
    const auto& entry = schema["properties"]["shots"]["items"]["anyOf"][0]["properties"];
    EXPECT_TRUE(entry.contains("crossfade"));
    EXPECT_TRUE(entry["fade_in"]["anyOf"].back()["properties"].contains("from"));
    EXPECT_FALSE(nlohmann::json::parse(schema_as_json())["properties"].contains("reel"));
}

}  // namespace
}  // namespace kadr
