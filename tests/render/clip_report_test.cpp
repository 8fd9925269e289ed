// The clip part of `kadr check --verbose`, literally.
#include "render/clip_report.h"

#include <gtest/gtest.h>

#include "frame/stage.h"

namespace kadr {
namespace {

using test::Stage;
using test::track;
using test::turn;

TEST(ClipReport, IsLiterally) {
    Stage stage;
    const int base = stage.add_node("Base"), arm = stage.add_node("Arm", base), claw = stage.add_node("", arm);
    stage.add_node("Helper", base);
    stage.add_node("Still", base);
    stage.scene.files[0].clip_count = 3;
    stage.scene.clips = {{"Idle", 0, 2, {}, 2}, {"Work", 0.5, 1.75, {}, 1}, {"", 0, 0, {}, 0}};
    NodeChannels idle;
    idle.node = arm;
    idle.rotation = track<glm::dquat>({{0, turn(0)}, {2, turn(60)}});
    idle.translation = track<glm::dvec3>({{0, {0, 0, 0}}, {2, {1, 0, 0}}});
    NodeChannels work = idle;
    work.translation.reset();
    stage.scene.clips[0].channels = {idle};
    stage.scene.clips[1].channels = {work};
    ClipLayer first, second;
    first.clips = second.clips = ClipLayer::Clips::one;
    first.clip_index = 0;
    first.loop = ClipLayer::Loop::repeat;
    first.weight = track<double>({{0, 1}, {1.5, 0}});
    second.clip_index = 1;
    second.speed = -0.5;
    second.at_s = 1;
    stage.shot.scenes[0].layers = {first, second};
    NodeOverride turned;
    turned.name = "#2";
    turned.scales = true;
    turned.transform.scale = track<glm::dvec3>({{0, glm::dvec3(1)}, {1, glm::dvec3(2)}});
    stage.shot.scenes[0].nodes = {turned};
    stage.shot.scenes[0].hide = {{"Helper", {}}};
    ASSERT_EQ(claw, 2);
    EXPECT_EQ(clip_report(stage.bind()),
              "scene stage: 5 nodes, 3 clips\n"
              "  clip  name       begin         end    duration  channels  nodes  layers\n"
              "     0  Idle         0 s         2 s         2 s         2      1  0\n"
              "     1  Work       0.5 s      1.75 s      1.25 s         1      1  1\n"
              "     2  #2           0 s         0 s         0 s         0      0  -\n"
              "  layer 0: Idle, 0 s to 2 s at speed 1, repeat, 0 s of the clip at 0 s of the shot, first pass over at 2 s, weight 2 keys from 0 s to 1.5 s\n"
              "  layer 1: Work, 0 s to 1.75 s at speed -0.5, hold, 1.75 s of the clip at 1 s of the shot, first pass over at 4.5 s, weight 1\n"
              "  what moves, of 5 nodes\n"
              "    Base\n"
              "      Arm     translate: layer 0; rotate: layer 0, 1\n"
              "        #2    scale: shot\n"
              "      Helper  hidden\n");
}

TEST(ClipReport, IsEmptyWhereNothingIsSaid) {
    Stage stage;
    stage.add_node("Base");
    EXPECT_EQ(clip_report(stage.bind()), "");
}

}  // namespace
}  // namespace kadr
