// EXT_mesh_gpu_instancing: the places of a node's mesh.
#include <gtest/gtest.h>

#include <limits>

#include "gltf_builder.h"

namespace kadr::test {
namespace {

using nlohmann::json;

const std::string kAt = "scene.gltf: error: /nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";

json& attributes(GltfBuilder& b, std::size_t node = 0) {
    b.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    return b.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
}

/// A triangle at two places.
void add_two(GltfBuilder& b) {
    b.triangle();
    attributes(b)["TRANSLATION"] = b.floats({1, 2, 3, 4, 5, 6}, "VEC3");
}

TEST(Instancing, ReadsTranslationsRotationsAndScales) {
    GltfBuilder b;
    add_two(b);
    attributes(b)["ROTATION"] = b.floats({0, 0, 0, 1, 0, 2, 0, 0}, "VEC4");  // made unit
    attributes(b)["SCALE"] = b.floats({1, 1, 1, 2, -3, 4}, "VEC3");
    b.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const Scene scene = b.load();
    ASSERT_EQ(scene.placement_sets.size(), 1u);
    EXPECT_EQ(scene.nodes[0].placement_set, 0);
    const std::vector<Placement>& set = scene.placement_sets[0];
    ASSERT_EQ(set.size(), 2u);
    EXPECT_EQ(set[0], (Placement{{1, 2, 3}}));
    EXPECT_EQ(set[1].translation, glm::dvec3(4, 5, 6));
    EXPECT_EQ(set[1].rotation, glm::quat(0, 0, 1, 0));
    EXPECT_EQ(set[1].scale, glm::vec3(2, -3, 4));
    // T * R * S: half a turn about y of (1, 1, 1) scaled by (2, -3, 4).
    EXPECT_EQ(matrix_of(set[1]) * glm::dvec4(1, 1, 1, 1), glm::dvec4(4 - 2, 5 - 3, 6 - 4, 1));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Instancing, ReadsNormalizedRotations) {
    GltfBuilder b;
    b.triangle();
    attributes(b)["ROTATION"] = b.accessor(std::vector<std::int16_t>{0, 0, 32767, 0, 0, 0, 0, 32767}, "VEC4", 5122, 2, true);
    const Scene scene = b.load();
    ASSERT_EQ(scene.placement_sets.at(0).size(), 2u);
    EXPECT_EQ(scene.placement_sets[0][0].rotation, glm::quat(0, 0, 0, 1));
    EXPECT_EQ(scene.placement_sets[0][0].translation, glm::dvec3(0));
}

TEST(Instancing, NodesWithTheSameAccessorsShareTheirPlaces) {
    GltfBuilder b;
    add_two(b);
    b.json["nodes"].push_back(b.json["nodes"][0]);
    b.json["scenes"][0]["nodes"] = {0, 1};
    const std::filesystem::path file = b.save_gltf();
    const Scene scene = load_scene({{"a", file, {}}, {"b", file, {}}});
    EXPECT_EQ(scene.placement_sets.size(), 1u);
    for (const Node& node : scene.nodes) EXPECT_EQ(node.placement_set, 0);
}

TEST(Instancing, OfASecondFileCountsFromItsOwnSets) {
    GltfBuilder a, b;
    add_two(a);
    add_two(b);
    const Scene scene = load_scene({{"a", a.save_gltf(), {}}, {"b", b.save_gltf(), {}}});
    EXPECT_EQ(scene.placement_sets.size(), 2u);
    EXPECT_EQ(scene.nodes[1].placement_set, 1);
}

TEST(Instancing, IgnoresAttributesOfTheFilesOwn) {
    GltfBuilder b;
    add_two(b);
    attributes(b)["_COLOR"] = b.floats({0, 1}, "SCALAR");
    EXPECT_EQ(b.load().placement_sets.at(0).size(), 2u);
}

TEST(Instancing, WithoutAMeshHasNoEffect) {
    GltfBuilder b;
    add_two(b);
    b.json["nodes"].push_back({{"extensions", b.json["nodes"][0]["extensions"]}});
    const Scene scene = b.load();
    EXPECT_EQ(scene.nodes[1].placement_set, -1);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].text().find("/nodes/1/extensions/EXT_mesh_gpu_instancing has no effect: the node has no mesh"), std::string::npos);
}

TEST(Instancing, RefusesOtherShapes) {
    GltfBuilder b;
    add_two(b);
    attributes(b)["SCALE"] = b.floats({1, 2}, "SCALAR");
    EXPECT_EQ(b.error(), kAt + "/SCALE is SCALAR of float\n  expected VEC3 of float");
    GltfBuilder c;
    add_two(c);
    attributes(c)["ROTATION"] = c.accessor(std::vector<std::uint16_t>(8, 65535), "VEC4", 5123, 2, true);
    EXPECT_EQ(c.error(), kAt + "/ROTATION is VEC4 of unsigned short, normalized\n  expected VEC4 of float, or of normalized byte or short");
}

TEST(Instancing, RefusesDifferentNumbers) {
    GltfBuilder b;
    add_two(b);
    attributes(b)["SCALE"] = b.floats({1, 1, 1}, "VEC3");
    EXPECT_EQ(b.error(), kAt + "/TRANSLATION has 2 elements, SCALE has 1\n  expected as many elements in every attribute");
}

TEST(Instancing, RefusesNothingAndAccessorsThatAreNotThere) {
    GltfBuilder b;
    b.triangle();
    attributes(b) = json::object();
    EXPECT_EQ(b.error(), kAt + " is empty\n  expected TRANSLATION, ROTATION or SCALE");
    attributes(b)["SCALE"] = 99;
    EXPECT_EQ(b.error(), kAt + "/SCALE is 99\n  expected an index into /accessors: 0 to 0");
}

TEST(Instancing, RefusesWhatIsNotFinite) {
    GltfBuilder b;
    b.triangle();
    attributes(b)["TRANSLATION"] = b.floats({0, 0, 0, 0, std::numeric_limits<float>::quiet_NaN(), 0}, "VEC3");
    EXPECT_EQ(b.error(), kAt + "/TRANSLATION element 1 is not finite\n  expected numbers; the file is damaged");
}

TEST(Instancing, RefusesRotationsWithoutLength) {
    GltfBuilder b;
    b.triangle();
    attributes(b)["ROTATION"] = b.floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4");
    EXPECT_EQ(b.error(), kAt + "/ROTATION element 1 is a quaternion of length 0\n  expected unit quaternions, x y z w");
}

TEST(Instancing, RefusesMoreThanASceneMayHave) {
    GltfBuilder b;
    b.triangle();
    b.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 1 << 24}});  // zeros, without bytes
    attributes(b)["TRANSLATION"] = b.json["accessors"].size() - 1;
    EXPECT_EQ(b.error(), kAt + "/TRANSLATION has 16777216 elements\n  expected at most 16777215 instances");
}

}  // namespace
}  // namespace kadr::test
