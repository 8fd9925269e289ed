#include "render/timeline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "frame/stage.h"
#include "render/track_list.h"

namespace kadr {
namespace {

using test::Stage;
using test::track;
using testing::ElementsAre;
using testing::HasSubstr;

/// Five frames at 4 a second with a cut of the camera while the shutter of frame 2 is open.
struct CutStage : Stage {
    CutStage() {
        shot.timing.fps = {4, 1};
        shot.timing.frames = {0, 1, 2, 3, 4};
        shot.shutter = {0, 0.5};
        shot.camera.position = track<glm::dvec3>({{0, {0, 0, 5}}, {0.5625, {1, 0, 5}}}, Interpolation::step);
        shot.scenes[0].transform.rotate.axis_angle = {{0, 1, 0}, track<double>({{0.25, 0}, {0.75, 3}})};
        add_node("Wheel");
        shot.scenes[0].transform.rotate.axis_angle->angle_rad.keys[0].ease = Ease{0.4, 0, 0.6, 1};
    }
};

TEST(TimelineTest, PrintsFramesTracksBarsAndCuts) {
    EXPECT_EQ(timeline_text(CutStage().bind()),
              R"(timing: 5 frames from 0 to 4, 4 a second, frame 0 is at 0 s
  shutter: open for 0.125 s, 180 deg of a frame
  frame 0: at 0 s, shutter 0 s to 0.125 s
  frame 4: at 1 s, shutter 1 s to 1.125 s
tracks: 2
  value                                interpolation keys  first to last key
  scenes.stage.transform.rotate.angle  linear, eased    2  0.25 s (f 1) to 0.75 s (f 3)
  camera.position                      step             2  0 s (f 0) to 0.5625 s (f 2.25)
bars: | a key, ! a jump, = changes, . holds, < > keys outside the shot
                                       f 0                                                      f 4
  scenes.stage.transform.rotate.angle  .............|==========================|...................
  camera.position                      |.............................!.............................
cuts: 1
  0.5625 s (f 2.25): camera.position: splits the shutter of frame 2
static: 1 of 5 frames repeat the one before: 4
)");
}

TEST(TimelineTest, SaysWhatIsSpecialAboutTheShutter) {
    CutStage stage;
    stage.shot.shutter.curve.shape = ShutterCurve::Shape::triangle;
    stage.shot.shutter.rolling = {RollingShutter::Direction::down, 0.02};
    stage.shot.shutter.physical = true;
    EXPECT_THAT(
        timeline_text(stage.bind()),
        HasSubstr("\n  shutter: open for 0.125 s, 180 deg of a frame, curve triangle, rolling down over 0.02 s, "
                  "physical exposure\n  frame 0: at 0 s, shutter 0 s to 0.145 s\n"));
}

TEST(TimelineTest, SaysThatNothingMoves) {
    Stage stage;
    stage.shot.timing.fps = {30000, 1001};
    stage.shot.timing.frames = {7};
    stage.shot.timing.first = 1;
    stage.shot.shutter = {0, 0};
    EXPECT_EQ(timeline_text(stage.bind()),
              R"(timing: 1 frame from 7 to 7, 30000/1001 (29.97003) a second, frame 1 is at 0 s
  shutter: closed, no motion blur
  frame 7: at 0.2002 s, shutter 0.2002 s to 0.2002 s
tracks: none; every value of the shot file is constant
cuts: none
)");
}

TEST(TimelineTest, TellsACutBetweenShuttersAndOneOfAClip) {
    CutStage stage;
    stage.shot.camera.position.keyed.keys[1].time_s = 0.7;  // the shutter of frame 2 closes at 0.625 s
    const int node = stage.add_node("Box");
    stage.animate(node).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {0.3, {1, 0, 0}}}, Interpolation::step);
    const std::string text = timeline_text(stage.bind());
    EXPECT_THAT(text, HasSubstr("cuts: 2\n  0.3 s (f 1.2): clips: splits the shutter of frame 1\n"
                                "  0.7 s (f 2.8): camera.position: while the shutter is closed\n"));
}

TEST(TimelineTest, ListsStaticFramesAsRanges) {
    CutStage stage;
    stage.shot.camera.position = glm::dvec3(0, 0, 5);
    stage.shot.timing.frames = {0, 1, 3, 4, 5, 6, 9, 10};
    EXPECT_THAT(timeline_text(stage.bind()), HasSubstr("static: 5 of 8 frames repeat the one before: 4-6, 9-10\n"));
    stage.shot.timing.frames = {0, 1};
    EXPECT_THAT(timeline_text(stage.bind()), HasSubstr("static: no frame repeats the one before\n"));
}

TEST(TimelineTest, MarksKeysOutsideTheShot) {
    CutStage stage;
    stage.shot.camera.position = track<glm::dvec3>({{-1, {0, 0, 5}}, {9, {1, 0, 5}}});
    EXPECT_THAT(timeline_text(stage.bind()), HasSubstr("<" + std::string(58, '=') + ">\n"));
}

TEST(TimelineTest, FitsAHundredColumns) {
    CutStage stage;
    stage.shot.scenes[0].id = stage.scene.files[0].id = "a_scene_with_a_name_that_is_longer_than_its_column";
    stage.shot.scenes[0].transform.translate =
        track<glm::dvec3>({{1.0 / 3, {0, 0, 0}}, {100.0 / 3, {1, 0, 0}}}, Interpolation::step);
    std::istringstream text(timeline_text(stage.bind()));
    for (std::string line; std::getline(text, line);) EXPECT_LE(line.size(), 100u) << line;
    EXPECT_THAT(text.str(), HasSubstr("scenes.a_scene_w..ransform.translate"));
}

TEST(TrackListTest, ListsEveryValueThatHasKeys) {
    Stage stage;
    const Track<double> number = track<double>({{0, 1}, {1, 2}});
    const Track<glm::dvec3> vector = track<glm::dvec3>({{0, {0, 1, 2}}, {1, {2, 1, 0}}});
    LightSpec light;
    light.id = "key";
    light.kind = LightKind::area;
    light.strength = number;
    light.look_at = vector;
    light.size_m = track<glm::dvec2>({{0, {1, 1}}, {1, {1, 2}}});
    stage.shot.lights.push_back(light);
    stage.shot.scenes[0].visible = number;
    stage.shot.scenes[0].materials.resize(1);
    stage.shot.scenes[0].materials[0].name = "Paint";
    stage.shot.scenes[0].materials[0].base_color = vector;
    stage.shot.scenes[0].materials[0].roughness = number;
    stage.shot.camera.up = vector;
    stage.shot.camera.focus = number;
    stage.shot.camera.focal_length_mm = number;
    stage.shot.environment.rotate_rad = number;
    std::vector<std::string> names;
    for (const TrackInfo& info : tracks_of(stage.shot)) names.push_back(info.name);
    EXPECT_THAT(
        names, ElementsAre("scenes.stage.visible", "scenes.stage.materials.Paint.base_color",
                           "scenes.stage.materials.Paint.roughness", "camera.up", "camera.focal_length", "camera.focus",
                           "lights.key.luminance", "lights.key.look_at", "lights.key.size", "environment.rotate"));
}

}  // namespace
}  // namespace kadr
