// scenes.animation, nodes and hide: what a shot may write and what it means; the messages for what it may not.
#include <gmock/gmock.h>

#include "shot/shot_fixture.h"
#include "shot/shot_hash.h"

namespace kadr {
namespace {

using Animation = ShotTest;

TEST_F(Animation, IsAllClipsWhereNothingIsSaid) {
    for (const char* scene : {"a.glb", "{ gltf: a.glb }", "{ gltf: a.glb, animation: {} }"}) {
        const SceneSpec spec = parse_scene(scene).scenes[0];
        ASSERT_EQ(spec.layers.size(), 1u) << scene;
        EXPECT_EQ(spec.layers[0].clips, ClipLayer::Clips::all);
        EXPECT_EQ(spec.layers[0].loop, ClipLayer::Loop::hold);
        EXPECT_EQ(spec.layers[0].weight, Track<double>(1.0));
        EXPECT_FALSE(spec.layers[0].start_s || spec.layers[0].in_s || spec.layers[0].out_s);
    }
}

TEST_F(Animation, TakesLayers) {
    const SceneSpec spec = parse_shot_text(R"(kadr: 1
timing: { fps: 25, first: 5 }
scenes:
  - gltf: a.glb
    animation:
      - { clip: Walk, at: 30 f, start: 5 f, speed: -1.5, in: 0.2, out: 1 s, loop: repeat, weight: { keys: { 5 f: 1, 30 f: 0 } } }
      - { clip: 3, at: 2 s, loop: pingpong, weight: 0.25 }
camera: {}
)", "shot.yaml").scenes[0];
    ASSERT_EQ(spec.layers.size(), 2u);
    const ClipLayer& walk = spec.layers[0];
    EXPECT_EQ(walk.clip_name, "Walk");
    EXPECT_EQ(walk.at_s, 1);  // the time of frame 30
    EXPECT_EQ(walk.start_s, 0.2);  // 5 frames of the clip
    EXPECT_EQ(walk.speed, -1.5);
    EXPECT_EQ(walk.in_s, 0.2);
    EXPECT_EQ(walk.out_s, 1);
    EXPECT_EQ(walk.loop, ClipLayer::Loop::repeat);
    ASSERT_EQ(walk.weight.keys.size(), 2u);
    EXPECT_EQ(walk.weight.keys[1].time_s, 1);
    EXPECT_EQ(spec.layers[1].clip_index, 3);
    EXPECT_EQ(spec.layers[1].at_s, 2);
    EXPECT_EQ(spec.layers[1].loop, ClipLayer::Loop::pingpong);
    EXPECT_EQ(spec.layers[1].weight, Track<double>(0.25));
}

TEST_F(Animation, TakesAMapOfClipsAndWeights) {
    const SceneSpec spec =
        parse_scene("{ gltf: a.glb, animation: { clip: { Walk: 0.3, 1: { keys: { 0 s: 0, 1 s: 1 } } }, speed: 2, loop: repeat } }").scenes[0];
    ASSERT_EQ(spec.layers.size(), 2u);
    EXPECT_EQ(spec.layers[0].clip_name, "Walk");
    EXPECT_EQ(spec.layers[0].weight, Track<double>(0.3));
    EXPECT_EQ(spec.layers[1].clip_index, 1);
    EXPECT_EQ(spec.layers[1].weight.keys.size(), 2u);
    for (const ClipLayer& layer : spec.layers) {
        EXPECT_EQ(layer.speed, 2);
        EXPECT_EQ(layer.loop, ClipLayer::Loop::repeat);
    }
}

TEST_F(Animation, TakesNodesAndWhatToHide) {
    const SceneSpec spec = parse_scene(
        "{ gltf: a.glb, nodes: { Visor/Hinge: { rotate: [0, 90 deg, 0] }, Body: { translate: { keys: { 0 s: [0, 0, 0], 1 s: [1 cm, 0, 0] } }, scale: 2 } }, "
        "hide: [ Collision, Rig/Helper ] }").scenes[0];
    ASSERT_EQ(spec.nodes.size(), 2u);
    EXPECT_EQ(spec.nodes[0].name, "Visor/Hinge");
    EXPECT_TRUE(spec.nodes[0].rotates && !spec.nodes[0].translates && !spec.nodes[0].scales);
    EXPECT_TRUE(!spec.nodes[1].rotates && spec.nodes[1].translates && spec.nodes[1].scales);
    EXPECT_EQ(evaluate(spec.nodes[1].transform.translate, 1), glm::dvec3(0.01, 0, 0));
    EXPECT_EQ(evaluate(spec.nodes[1].transform.scale, 0), glm::dvec3(2));
    ASSERT_EQ(spec.hide.size(), 2u);
    EXPECT_EQ(spec.hide[1].name, "Rig/Helper");
}

TEST_F(Animation, TakesMorphWeightsOfNodes) {
    const SceneSpec spec = parse_scene(
        "{ gltf: a.glb, nodes: { A: { weights: [0.5, -1] }, B: { weights: { keys: { 0 s: [0, 1], 2 s: { value: [4, 0], ease: in-out }, 3 s: [1, 1] }, after: repeat } }, "
        "C: { weights: { keys: { 0 s: { value: [1, 2], out_tangent: [3, 4] }, 1 s: { value: [0, 0], in_tangent: [5, 6] } }, interpolate: cubic } }, D: {} } }").scenes[0];
    EXPECT_EQ(spec.nodes.at(0).weights, (std::vector<Track<double>>{0.5, -1.0}));
    const std::vector<Track<double>>& keyed = spec.nodes.at(1).weights;
    ASSERT_EQ(keyed.size(), 2u);
    EXPECT_EQ(evaluate(keyed[0], 1), 2);
    EXPECT_EQ(evaluate(keyed[1], 1), 0.5);
    EXPECT_EQ(keyed[1].after, Extrapolation::repeat);
    EXPECT_TRUE(keyed[0].keys.at(1).ease && keyed[1].keys.at(1).ease);
    const std::vector<Track<double>>& cubic = spec.nodes.at(2).weights;
    ASSERT_EQ(cubic.size(), 2u);
    EXPECT_EQ(cubic[1].interpolation, Interpolation::cubic);
    EXPECT_EQ(cubic[1].keys.at(0).out_tangent, 4);
    EXPECT_EQ(cubic[0].keys.at(1).in_tangent, 5);
    EXPECT_TRUE(spec.nodes.at(3).weights.empty());
}

TEST_F(Animation, SaysWhatIsWrongWithMorphWeights) {
    const auto errors = [](const std::string& rest) { return errors_of("kadr: 1\nscenes:\n  - gltf: a.glb\n    nodes: { N: { weights: " + rest + " } }\ncamera: {}\n"); };
    EXPECT_EQ(errors("0.5"),
              "shot.yaml:4:28: error: scenes.0.nodes.N.weights is 0.5\n"
              "        nodes: { N: { weights: 0.5 } }\n"
              "                               ^~~\n"
              "  expected a list of numbers such as [0, 1]");
    EXPECT_EQ(errors("[0, x]"),
              "shot.yaml:4:32: error: scenes.0.nodes.N.weights[1] is 'x'\n"
              "        nodes: { N: { weights: [0, x] } }\n"
              "                                   ^\n"
              "  expected a list of numbers such as [0, 1]");
    EXPECT_EQ(errors("{ keys: { 0 s: [0, 1], 1 s: [0], 2 s: { value: [1, 2, 3], ease: in } } }"),
              "shot.yaml:4:56: error: scenes.0.nodes.N.weights.keys.1 s has 1 numbers\n"
              "        nodes: { N: { weights: { keys: { 0 s: [0, 1], 1 s: [0], 2 s: { value: [1, 2, 3], ease: in } } } } }\n"
              "                                                           ^~~\n"
              "  expected 2, as at the first key: one for each morph target\n"
              "shot.yaml:4:75: error: scenes.0.nodes.N.weights.keys.2 s has 3 numbers\n"
              "        nodes: { N: { weights: { keys: { 0 s: [0, 1], 1 s: [0], 2 s: { value: [1, 2, 3], ease: in } } } } }\n"
              "                                                                              ^~~~~~~~~\n"
              "  expected 2, as at the first key: one for each morph target");
    EXPECT_EQ(errors("{ keys: { 0 s: { value: [0, 1], out_tangent: [1] }, 1 s: [1, 1] }, interpolate: cubic }"),
              "shot.yaml:4:73: error: scenes.0.nodes.N.weights.keys.0 s.out_tangent has 1 numbers\n"
              "        nodes: { N: { weights: { keys: { 0 s: { value: [0, 1], out_tangent: [1] }, 1 s: [1, 1] }, interpolate: cubic } } }\n"
              "                                                                            ^~~\n"
              "  expected 2, as in the key's value: one for each morph target");
}

Hash hash_of(const Shot& shot) {
    Hasher hasher;
    hash_shot(shot, hasher);
    return hasher.finish();
}

TEST_F(Animation, ChangesWhatAFrameIsMadeFrom) {
    const Hash base = hash_of(parse_scene("{ gltf: a.glb }"));
    std::vector<Hash> seen{base};
    for (const char* rest : {"animation: { at: 1 }", "animation: { in: 1 }", "animation: { out: 1 }", "animation: { loop: repeat }", "animation: { weight: 0.5 }",
                             "animation: [ {}, {} ]", "animation: { clip: { a: 1 } }", "nodes: { N: {} }", "nodes: { N: { scale: 1 } }",
                             "nodes: { N: { translate: [0, 0, 0] } }", "nodes: { M: { rotate: [0, 0, 0] } }", "nodes: { N: { weights: [1] } }", "nodes: { N: { weights: [1, 0] } }", "hide: [ N ]"}) {
        const Hash hash = hash_of(parse_scene(std::string("{ gltf: a.glb, ") + rest + " }"));
        EXPECT_THAT(seen, ::testing::Not(::testing::Contains(hash))) << rest;
        seen.push_back(hash);
    }
}

TEST_F(Animation, SaysWhatIsWrong) {
    const auto errors = [](const std::string& rest) { return errors_of("kadr: 1\nscenes:\n  - gltf: a.glb\n    " + rest + "\ncamera: {}\n"); };
    EXPECT_EQ(errors("animation: Walk"),
              "shot.yaml:4:16: error: scenes.0.animation is 'Walk'\n"
              "        animation: Walk\n"
              "                   ^~~~\n"
              "  expected a list of maps or a map of clip, at, start, speed, in, out, loop, weight");
    EXPECT_EQ(errors("animation: [ Walk ]"),
              "shot.yaml:4:18: error: scenes.0.animation.0 is 'Walk'\n"
              "        animation: [ Walk ]\n"
              "                     ^~~~\n"
              "  expected a map such as { clip: Walk, weight: 0.3 }");
    EXPECT_EQ(errors("animation: []"),
              "shot.yaml:4:16: error: scenes.0.animation is an empty list\n"
              "        animation: []\n"
              "                   ^~\n"
              "  expected a list of maps or a map of clip, at, start, speed, in, out, loop, weight; write { clip: none } for no animation");
    EXPECT_EQ(errors("animation: { in: 2, out: 1 }"),
              "shot.yaml:4:30: error: scenes.0.animation.out is 1, before scenes.0.animation.in\n"
              "        animation: { in: 2, out: 1 }\n"
              "                                 ^\n"
              "  expected in, then out; a negative speed plays from out to in");
    EXPECT_EQ(errors("animation: [ { weight: -1 }, { lop: repeat } ]"),
              "shot.yaml:4:28: error: scenes.0.animation.0.weight is -1\n"
              "        animation: [ { weight: -1 }, { lop: repeat } ]\n"
              "                               ^~\n"
              "  expected 0 to 1000000\n"
              "shot.yaml:4:36: error: unknown key 'lop' in scenes.0.animation.1\n"
              "        animation: [ { weight: -1 }, { lop: repeat } ]\n"
              "                                       ^~~\n"
              "  did you mean 'loop'?");
    EXPECT_EQ(errors("animation: { loop: ping-pong }"),
              "shot.yaml:4:24: error: scenes.0.animation.loop is 'ping-pong'\n"
              "        animation: { loop: ping-pong }\n"
              "                           ^~~~~~~~~\n"
              "  expected one of hold, repeat, pingpong; did you mean 'pingpong'?");
    EXPECT_EQ(errors("animation: { clip: { Walk: fast }, weight: 2 }"),
              "shot.yaml:4:32: error: scenes.0.animation.clip.Walk is 'fast'\n"
              "        animation: { clip: { Walk: fast }, weight: 2 }\n"
              "                                   ^~~~\n"
              "  expected 0 to 1000000\n"
              "shot.yaml:4:40: error: scenes.0.animation.weight stands beside weights in scenes.0.animation.clip\n"
              "        animation: { clip: { Walk: fast }, weight: 2 }\n"
              "                                           ^~~~~~\n"
              "  give the weights in one of the two");
    EXPECT_EQ(errors("nodes: { Hinge: 90 deg }"),
              "shot.yaml:4:21: error: scenes.0.nodes.Hinge is 90 deg\n"
              "        nodes: { Hinge: 90 deg }\n"
              "                        ^~~~~~\n"
              "  expected a map such as { rotate: [0, 90 deg, 0] }");
    EXPECT_EQ(errors("nodes: { Hinge: { rotation: [0, 0, 0] } }"),
              "shot.yaml:4:23: error: unknown key 'rotation' in scenes.0.nodes.Hinge\n"
              "        nodes: { Hinge: { rotation: [0, 0, 0] } }\n"
              "                          ^~~~~~~~\n"
              "  expected one of translate, rotate, scale, visible, weights");
    EXPECT_EQ(errors("nodes: [ Hinge ]"),
              "shot.yaml:4:12: error: scenes.0.nodes is a list of 1\n"
              "        nodes: [ Hinge ]\n"
              "               ^~~~~~~~~\n"
              "  expected a map of names to maps of translate, rotate, scale, visible, weights");
    EXPECT_EQ(errors("hide: Collision"),
              "shot.yaml:4:11: error: scenes.0.hide is 'Collision'\n"
              "        hide: Collision\n"
              "              ^~~~~~~~~\n"
              "  expected a list; write [ Name ] for one");
}

}  // namespace
}  // namespace kadr
