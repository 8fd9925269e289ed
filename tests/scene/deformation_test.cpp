// Skins, morph targets and the channels of their weights.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gltf_builder.h"

namespace kadr {
namespace {

using test::GltfBuilder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kByte = 5120, kUnsignedByte = 5121, kUnsignedShort = 5123, kFloatType = 5126;

/// A triangle on node 0 that follows nodes 1 and 2, which is a child of node 1.
struct Skinned : GltfBuilder {
    Skinned() {
        triangle();
        json["nodes"][0]["skin"] = 0;
        json["nodes"].push_back({{"name", "hip"}, {"children", {2}}});
        json["nodes"].push_back({{"name", "knee"}, {"translation", {0, 1, 0}}});
        json["scenes"] = {{{"nodes", {0, 1}}}};
        json["skins"] = {{{"joints", {1, 2}}}};
        joints({0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
        weights({0.75f, 0.25f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    }
    nlohmann::json& attributes() { return json["meshes"][0]["primitives"][0]["attributes"]; }
    void joints(const std::vector<std::uint8_t>& values, int set = 0) {
        attributes()["JOINTS_" + std::to_string(set)] = accessor(values, "VEC4", kUnsignedByte, 3);
    }
    void weights(const std::vector<float>& values, int set = 0) { attributes()["WEIGHTS_" + std::to_string(set)] = floats(values, "VEC4"); }
};

TEST(Skins, AreReadWithTheirRootAndWeights) {
    Skinned file;
    const Scene scene = file.load();
    EXPECT_THAT(scene.warnings, IsEmpty());
    ASSERT_THAT(scene.skins, SizeIs(1));
    EXPECT_THAT(scene.skins[0].joints, ElementsAre(1, 2));
    EXPECT_EQ(scene.skins[0].root, 1);
    EXPECT_EQ(scene.skins[0].inverse_bind[1], glm::dmat4(1));
    EXPECT_EQ(scene.nodes[0].skin, 0);
    const SkinWeights& skin = scene.geometries.at(0).skin;
    EXPECT_EQ(skin.per_vertex, 2);  // what nothing uses takes no room
    EXPECT_THAT(skin.joints, ElementsAre(0, 1, 1, 0, 1, 0));
    EXPECT_THAT(skin.weights, ElementsAre(0.75f, 0.25f, 1, 0, 1, 0));
}

TEST(Skins, TakeAnyNumberOfInfluences) {
    Skinned file;
    file.weights({0.1f, 0.1f, 0.1f, 0.1f, 1, 0, 0, 0, 1, 0, 0, 0});
    file.joints({0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1}, 1);
    file.weights({0.3f, 0.2f, 0.05f, 0.05f, 0, 0, 0, 0, 0, 0, 0, 0}, 1);
    const SkinWeights skin = file.load().geometries.at(0).skin;
    EXPECT_EQ(skin.per_vertex, 8);
    EXPECT_FLOAT_EQ(skin.weights[0], 0.3f);  // the heaviest first
    float sum = 0;
    for (int i = 0; i < 8; ++i) sum += skin.weights[static_cast<std::size_t>(i)];
    EXPECT_NEAR(sum, 1, 1e-6);
}

TEST(Skins, NormaliseWeightsOfEveryType) {
    const auto first_weight = [](auto change) {
        Skinned file;
        change(file);
        return file.load().geometries.at(0).skin.weights[0];
    };
    EXPECT_FLOAT_EQ(first_weight([](Skinned& f) { f.weights({3, 1, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0}); }), 0.75f);
    EXPECT_FLOAT_EQ(first_weight([](Skinned& f) {
        f.attributes()["WEIGHTS_0"] = f.accessor(std::vector<std::uint8_t>{191, 64, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, "VEC4", kUnsignedByte, 3, true);
    }), 191.0f / 255);
    EXPECT_FLOAT_EQ(first_weight([](Skinned& f) {
        f.attributes()["WEIGHTS_0"] = f.accessor(std::vector<std::uint16_t>{16384, 49151, 0, 0, 65535, 0, 0, 0, 65535, 0, 0, 0}, "VEC4", kUnsignedShort, 3, true);
    }), 49151.0f / 65535);
}

TEST(Skins, NormaliseTheWeightsOfAllSetsTogether) {
    Skinned file;
    file.joints({0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1}, 1);
    file.weights({2, 1, 0, 0, 3, 0, 0, 0, 1, 0, 0, 0});
    file.weights({4, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, 1);
    const SkinWeights skin = file.load().geometries.at(0).skin;
    ASSERT_EQ(skin.per_vertex, 4);
    EXPECT_THAT(skin.weights, ElementsAre(0.5f, 0.25f, 0.125f, 0.125f, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0));
    EXPECT_THAT(std::vector<std::uint16_t>(skin.joints.begin(), skin.joints.begin() + 2), ElementsAre(0, 0));  // the heaviest of both sets first
}

TEST(Skins, WeightsBelowZeroTakeNoPart) {
    Skinned file;
    file.weights({3, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    const Scene scene = file.load();
    EXPECT_THAT(scene.geometries.at(0).skin.weights, ElementsAre(1, 1, 1));
    EXPECT_THAT(scene.geometries.at(0).skin.joints, ElementsAre(0, 1, 1));
    ASSERT_THAT(scene.warnings, SizeIs(1));
}

TEST(Skins, RepairVerticesWithoutWeight) {
    Skinned file;
    file.joints({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    file.weights({0, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, 0});
    const Scene scene = file.load();
    EXPECT_THAT(scene.geometries.at(0).skin.joints, ElementsAre(1, 1, 1));
    EXPECT_THAT(scene.geometries.at(0).skin.weights, ElementsAre(1, 1, 1));
    ASSERT_THAT(scene.warnings, SizeIs(1));
    EXPECT_THAT(scene.warnings[0].found, HasSubstr("/meshes/0/primitives/0/attributes/WEIGHTS_0 leaves 2 of 3 vertices"));
}

TEST(Skins, GiveJointsOfSeveralTreesARoot) {
    Skinned file;
    file.json["nodes"][1].erase("children");
    file.json["scenes"][0]["nodes"] = {0, 1, 2};
    const Scene scene = file.load();
    EXPECT_EQ(scene.skins[0].root, 3);
    EXPECT_THAT(scene.files[0].roots, ElementsAre(0, 1, 2, 3));
}

TEST(Skins, FollowTheirSceneEntry) {
    Skinned file;
    const auto path = file.save_gltf();
    const Scene scene = load_scene({{"a", path, {}}, {"b", path, {}}});
    ASSERT_THAT(scene.skins, SizeIs(2));
    EXPECT_THAT(scene.skins[1].joints, ElementsAre(4, 5));
    EXPECT_EQ(scene.skins[1].root, 4);
    EXPECT_EQ(scene.nodes[3].skin, 1);
    EXPECT_THAT(scene.geometries, SizeIs(1));
}

TEST(Skins, LeaveMeshesWithoutJointsAtTheirNode) {
    Skinned file;
    file.attributes().erase("JOINTS_0");
    file.attributes().erase("WEIGHTS_0");
    const Scene scene = file.load();
    ASSERT_THAT(scene.warnings, SizeIs(1));
    EXPECT_THAT(scene.warnings[0].found, HasSubstr("has no JOINTS_0, but node 0 has a skin"));
}

struct Broken {
    const char* name;
    void (*change)(Skinned&);
    const char* message;
};
class BrokenSkin : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenSkin, IsRefusedWithPlaceAndRemedy) {
    Skinned file;
    GetParam().change(file);
    EXPECT_EQ(file.error(), GetParam().message);
}

std::vector<float> matrices(int count, int bad, float value) {
    std::vector<float> all;
    for (int m = 0; m < count; ++m)
        for (int i = 0; i < 16; ++i) all.push_back(m == 1 && i == bad ? value : i % 5 == 0 ? 1.0f : 0.0f);
    return all;
}

INSTANTIATE_TEST_SUITE_P(All, BrokenSkin, ::testing::ValuesIn(std::vector<Broken>{
    {"JointBeyondTheSkin", [](Skinned& f) { f.joints({0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0}); },
     "scene.gltf: error: /meshes/0/primitives/0/attributes/JOINTS_0 names joint 2, skin 0 of node 0 has 2\n  expected joints 0 to 1"},
    {"HalfASet", [](Skinned& f) { f.attributes().erase("WEIGHTS_0"); },
     "scene.gltf: error: /meshes/0/primitives/0/attributes has JOINTS_0 without WEIGHTS_0\n  expected joints and weights in pairs"},
    {"FloatJoints", [](Skinned& f) { f.attributes()["JOINTS_0"] = f.floats(std::vector<float>(12), "VEC4"); },
     "scene.gltf: error: /meshes/0/primitives/0/attributes/JOINTS_0 is VEC4 of float\n  expected VEC4 of unsigned byte or unsigned short"},
    {"PlainIntegerWeights", [](Skinned& f) { f.attributes()["WEIGHTS_0"] = f.accessor(std::vector<std::uint8_t>(12), "VEC4", kUnsignedByte, 3); },
     "scene.gltf: error: /meshes/0/primitives/0/attributes/WEIGHTS_0 is VEC4 of unsigned byte\n"
     "  expected VEC4 of float, normalized unsigned byte or normalized unsigned short"},
    {"CountOfWeights", [](Skinned& f) { f.attributes()["WEIGHTS_0"] = f.floats(std::vector<float>(8), "VEC4"); },
     "scene.gltf: error: /meshes/0/primitives/0/attributes/WEIGHTS_0 has 2 elements, POSITION has 3\n  expected as many elements in every attribute"},
    {"InfiniteWeight", [](Skinned& f) { f.weights({1, 0, 0, 0, std::numeric_limits<float>::infinity(), 0, 0, 0, 1, 0, 0, 0}); },
     "scene.gltf: error: /meshes/0/primitives/0/attributes/WEIGHTS_0 element 1 is not finite\n  expected finite numbers; export the mesh anew"},
    {"TooFewMatrices", [](Skinned& f) { f.json["skins"][0]["inverseBindMatrices"] = f.accessor(matrices(1, -1, 0), "MAT4", kFloatType, 1); },
     "scene.gltf: error: /skins/0/inverseBindMatrices has 1 matrices for 2 joints\n  expected one for each joint"},
    {"InfiniteMatrix", [](Skinned& f) { f.json["skins"][0]["inverseBindMatrices"] = f.accessor(matrices(2, 4, NAN), "MAT4", kFloatType, 2); },
     "scene.gltf: error: /skins/0/inverseBindMatrices matrix 1 is not finite\n  expected finite numbers; export the skin anew"},
    {"Projection", [](Skinned& f) { f.json["skins"][0]["inverseBindMatrices"] = f.accessor(matrices(2, 3, 0.5f), "MAT4", kFloatType, 2); },
     "scene.gltf: error: /skins/0/inverseBindMatrices matrix 1 has 0.5 as element 3\n  expected 0, 0, 0, 1 in the last row: an affine transform"},
    {"NoMatrices", [](Skinned& f) { f.json["skins"][0]["inverseBindMatrices"] = f.floats(std::vector<float>(8), "VEC4"); },
     "scene.gltf: error: /skins/0/inverseBindMatrices is VEC4 of float\n  expected MAT4 of float"},
    {"NoSuchJoint", [](Skinned& f) { f.json["skins"][0]["joints"] = {1, 7}; },
     "scene.gltf: error: /skins/0/joints/1 is 7\n  expected an index into /nodes: 0 to 2"},
}), [](const auto& test) { return test.param.name; });

/// A triangle with two morph targets.
struct Morphing : GltfBuilder {
    Morphing() {
        triangle();
        targets() = {{{"POSITION", floats({0, 0, 1, 0, 0, 0, 0, 0, 0}, "VEC3")}}, {{"POSITION", floats({0, 0, 0, 0, 0, 0, 0, 0.5f, 0}, "VEC3")}}};
    }
    nlohmann::json& targets() { return json["meshes"][0]["primitives"][0]["targets"]; }
    void animate(const std::vector<float>& times, const std::vector<float>& values, const char* interpolation) {
        json["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
                               {"samplers", {{{"input", floats(times, "SCALAR")}, {"output", floats(values, "SCALAR")}, {"interpolation", interpolation}}}}}};
    }
};

TEST(MorphTargets, HoldTheVerticesThatMove) {
    Morphing file;
    file.json["meshes"][0]["weights"] = {0.25, 0.5};
    const Scene scene = file.load();
    const GeometryData& g = scene.geometries.at(0);
    ASSERT_THAT(g.targets, SizeIs(2));
    EXPECT_THAT(g.targets[0].vertices, ElementsAre(0));
    EXPECT_THAT(g.targets[1].vertices, ElementsAre(2));
    EXPECT_FLOAT_EQ(g.targets[0].positions[0].z, static_cast<float>(1 / g.scale));
    EXPECT_THAT(scene.nodes[0].weights, ElementsAre(0.25, 0.5));
}

TEST(MorphTargets, TakeWeightsOfTheNodeFirst) {
    Morphing file;
    file.json["meshes"][0]["weights"] = {0.25, 0.5};
    file.json["nodes"][0]["weights"] = {1, 0};
    EXPECT_THAT(file.load().nodes[0].weights, ElementsAre(1, 0));
    file.json["meshes"][0].erase("weights");
    file.json["nodes"][0].erase("weights");
    EXPECT_THAT(file.load().nodes[0].weights, ElementsAre(0, 0));
}

TEST(MorphTargets, MayBeSparseAndQuantized) {
    Morphing file;
    const int indices = file.view(std::vector<std::uint16_t>{1, 0});
    const int values = file.view(std::vector<float>{0, 2, 0});
    nlohmann::json sparse = {{"componentType", kFloatType}, {"count", 3}, {"type", "VEC3"},
                             {"sparse", {{"count", 1}, {"indices", {{"bufferView", indices}, {"componentType", kUnsignedShort}}}, {"values", {{"bufferView", values}}}}}};
    file.json["accessors"].push_back(sparse);
    file.targets()[0]["POSITION"] = file.json["accessors"].size() - 1;
    file.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    file.targets()[1]["POSITION"] = file.accessor_of(file.view(std::vector<std::int8_t>{0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0}, 4), "VEC3", kByte, 3);
    const GeometryData g = file.load().geometries.at(0);
    EXPECT_THAT(g.targets[0].vertices, ElementsAre(1));
    EXPECT_FLOAT_EQ(g.targets[0].positions[0].y * static_cast<float>(g.scale), 2);
    EXPECT_THAT(g.targets[1].vertices, ElementsAre(1));
    EXPECT_FLOAT_EQ(g.targets[1].positions[0].y * static_cast<float>(g.scale), 3);
}

TEST(MorphTargets, AreAnimatedKeyAfterKey) {
    Morphing file;
    file.animate({0, 1}, {0, 10, 1, 20}, "LINEAR");
    const Clip clip = file.load().clips.at(0);
    ASSERT_THAT(clip.channels.at(0).weights, SizeIs(2));
    EXPECT_DOUBLE_EQ(evaluate(clip.channels[0].weights[0], 0.5), 0.5);
    EXPECT_DOUBLE_EQ(evaluate(clip.channels[0].weights[1], 0.5), 15);
    EXPECT_DOUBLE_EQ(clip.end_s, 1);
    Morphing stepping;
    stepping.animate({0, 1}, {0, 10, 1, 20}, "STEP");
    EXPECT_DOUBLE_EQ(evaluate(stepping.load().clips.at(0).channels[0].weights[1], 0.5), 10);
}

// In-tangents of all targets, then values, then out-tangents (3.11). By hand, at s = 0.5 of a second:
// p = 0.5 v0 + 0.125 b0 + 0.5 v1 - 0.125 a1.
TEST(MorphTargets, AreAnimatedByCubicSplines) {
    Morphing file;
    file.animate({0, 1}, {0, 0, 2, 4, 8, 16, /**/ -8, 24, 6, 8, 0, 0}, "CUBICSPLINE");
    const Clip clip = file.load().clips.at(0);
    EXPECT_DOUBLE_EQ(evaluate(clip.channels.at(0).weights.at(0), 0.5), 0.5 * 2 + 0.125 * 8 + 0.5 * 6 - 0.125 * -8);
    EXPECT_DOUBLE_EQ(evaluate(clip.channels[0].weights[1], 0.5), 0.5 * 4 + 0.125 * 16 + 0.5 * 8 - 0.125 * 24);
}

std::string error_after(void (*change)(Morphing&)) {
    Morphing file;
    change(file);
    return file.error();
}

TEST(MorphTargets, AreRefusedWhereCountsDisagree) {
    EXPECT_EQ(error_after([](Morphing& f) { f.animate({0, 1}, {0, 10, 1}, "LINEAR"); }),
              "scene.gltf: error: /animations/0/samplers/0/output has 3 elements for 2 times\n  expected 4");
    EXPECT_EQ(error_after([](Morphing& f) { f.json["meshes"][0]["weights"] = {1}; }),
              "scene.gltf: error: /meshes/0/weights has 1 weights for 2 morph targets\n  expected one for each target");
    EXPECT_EQ(error_after([](Morphing& f) { f.json["nodes"][0]["weights"] = {1, 2, 3}; }),
              "scene.gltf: error: /nodes/0/weights has 3 weights for the 2 morph targets of its mesh\n  expected one for each target");
    EXPECT_EQ(error_after([](Morphing& f) { f.targets()[1]["NORMAL"] = f.floats(std::vector<float>(6), "VEC3"); }),
              "scene.gltf: error: /meshes/0/primitives/0/targets/1/NORMAL has 2 elements, POSITION has 3\n  expected as many elements in every attribute");
    EXPECT_EQ(error_after([](Morphing& f) { f.targets()[1] = {{"POSITION", f.floats({0, 0, 0, 0, 0, 0, 0, NAN, 0}, "VEC3")}}; }),
              "scene.gltf: error: /meshes/0/primitives/0/targets/1/POSITION element 2 is not finite\n  expected finite numbers; export the mesh anew");
}

}  // namespace
}  // namespace kadr
