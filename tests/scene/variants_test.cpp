// KHR_materials_variants and KHR_node_visibility.
#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace kadr::test {
namespace {

using nlohmann::json;

/// A triangle of material 0 that wears material 1 under variant 1 ("Night").
void add_variants(GltfBuilder& b) {
    json& primitive = b.triangle();
    primitive["material"] = 0;
    primitive["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {1}}}};
    b.json["materials"] = {{{"name", "Paint"}, {"emissiveFactor", {0.5, 0, 0}}, {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}},
                           {{"name", "Dark"}}};
    b.json["extensionsUsed"] = {"KHR_materials_variants", "KHR_materials_emissive_strength"};
    b.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "Day"}}, {{"name", "Night"}}};
}

TEST(Variants, AreNamedAndMapped) {
    GltfBuilder b;
    add_variants(b);
    const Scene scene = b.load();
    EXPECT_EQ(scene.files[0].variants, (std::vector<std::string>{"Day", "Night"}));
    EXPECT_EQ(scene.files[0].material_count, 2);
    const MeshPrimitive& primitive = scene.nodes[0].primitives.at(0);
    ASSERT_EQ(primitive.variants.size(), 1u);
    EXPECT_EQ(primitive.variants[0].variant, 1);
    EXPECT_EQ(scene.material_names.at(static_cast<std::size_t>(primitive.variants[0].material)), "Dark");
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Variants, OfASecondFileCountFromItsMaterials) {
    GltfBuilder a, b;
    add_variants(a);
    add_variants(b);
    const Scene scene = load_scene({{"a", a.save_gltf(), {}}, {"b", b.save_gltf(), {}}, {"c", a.save_gltf(), {}}});
    EXPECT_EQ(scene.files[1].first_material, 2);
    EXPECT_EQ(scene.nodes[1].primitives[0].variants[0].material, 3);
    EXPECT_EQ(scene.files[2].first_material, 0);  // the same file: shared
}

TEST(Variants, KeepTheFactorsOfEmission) {
    GltfBuilder b;
    add_variants(b);
    const Scene scene = b.load();
    EXPECT_EQ(scene.materials[0].emission.x, 2);
    EXPECT_EQ(scene.material_sources[0].emissive, glm::dvec3(0.5, 0, 0));
    EXPECT_EQ(scene.material_sources[0].emissive_strength, 4);
    EXPECT_EQ(scene.material_sources[0].index, 0);
}

TEST(Variants, AreRefusedWhereOneIsMappedTwice) {
    GltfBuilder b;
    add_variants(b);
    b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"].push_back({{"material", 0}, {"variants", {1}}});
    EXPECT_EQ(b.error(), "scene.gltf: error: /meshes/0/primitives/0/extensions/KHR_materials_variants/mappings/1/variants names variant 1 again\n"
                         "  expected one material for each variant");
}

TEST(Variants, AreRefusedWhereThereIsNone) {
    GltfBuilder b;
    add_variants(b);
    b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"][0]["variants"] = {2};
    EXPECT_EQ(b.error(), "scene.gltf: error: /meshes/0/primitives/0/extensions/KHR_materials_variants/mappings/0/variants/0 is 2\n"
                         "  expected an index into /variants: 0 to 1");
}

TEST(NodeVisibility, IsRead) {
    GltfBuilder b;
    b.triangle();
    EXPECT_TRUE(b.load().nodes[0].visible);
    b.json["nodes"][0]["extensions"]["KHR_node_visibility"] = json::object();
    EXPECT_TRUE(b.load().nodes[0].visible);
    b.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
    EXPECT_FALSE(b.load().nodes[0].visible);
    b.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = "no";
    EXPECT_EQ(b.error(), "scene.gltf: error: /nodes/0/extensions/KHR_node_visibility/visible is \"no\"\n  expected true or false; repair the file with the tool that wrote it");
}

}  // namespace
}  // namespace kadr::test
