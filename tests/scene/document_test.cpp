#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "gltf_builder.h"
#include "scene/uri.h"

namespace kadr {
namespace {

using test::GltfBuilder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(Uri, StaysInTheFolder) {
    EXPECT_EQ(path_within_folder("a%20b.bin"), "a b.bin");
    EXPECT_EQ(path_within_folder("textures/../x.png"), "x.png");
    EXPECT_EQ(path_within_folder("50%.png"), "50%.png");
    for (const char* outside : {"../x.bin", "a/../../x.bin", "%2e%2e/x.bin", "..%2Fx.bin", "/etc/passwd", "file:///etc/passwd", "http://example.org/x.bin", "a%00.bin", ""})
        EXPECT_EQ(path_within_folder(outside), std::nullopt) << outside;
}

TEST(Uri, DecodesData) {
    const auto text = [](std::string_view uri) {
        const auto bytes = decode_data_uri(uri);
        return bytes ? std::string(bytes->begin(), bytes->end()) : "(none)";
    };
    EXPECT_EQ(text("data:application/octet-stream;base64,S2Fkcg=="), "Kadr");
    EXPECT_EQ(text("data:;base64,S2FkciE"), "Kadr!");
    EXPECT_EQ(text("data:text/plain,a%20b"), "a b");
    EXPECT_EQ(text("data:;base64,S2F*"), "(none)");
    EXPECT_EQ(text("data:;base64"), "(none)");
}

TEST(Document, ReadsExternalFilesWithPercentEncoding) {
    GltfBuilder file;
    file.triangle();
    const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
    file.save_text("the data.bin", std::string(reinterpret_cast<const char*>(positions.data()), 36) + "padding");
    file.json["buffers"] = {{{"byteLength", 36}, {"uri", "the%20data.bin"}}};
    const Scene scene = file.load();
    EXPECT_THAT(scene.geometries, SizeIs(1));
    file.save_text("the data.bin", std::string(36, '\0'));
    EXPECT_NE(file.load().files.at(0).content, scene.files.at(0).content) << "the hash covers external files";
}

TEST(Document, ReadsGlbLikeGltf) {
    GltfBuilder file;
    file.triangle();
    const Scene text = load_scene({{"a", file.save_gltf(), {}}}), binary = load_scene({{"b", file.save_glb(), {}}});
    EXPECT_EQ(text.geometries.at(0).centre, binary.geometries.at(0).centre);
    EXPECT_EQ(text.geometries[0].indices, binary.geometries[0].indices);
    EXPECT_EQ(binary.files.at(0).id, "b");
}

TEST(Document, WarnsOnceOfUnknownExtensions) {
    GltfBuilder file;
    file.triangle();
    file.json["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_materials_unlit", "KHR_materials_clearcoat"};
    const Scene scene = file.load();
    ASSERT_THAT(scene.warnings, SizeIs(1));
    EXPECT_EQ(scene.warnings[0].found, "/extensionsUsed names KHR_materials_clearcoat, which is not supported and has no effect");
}

TEST(Document, WithoutGeometryLoads) {
    GltfBuilder file;
    file.json = {{"asset", {{"version", "2.0"}}}};
    EXPECT_THAT(file.load().nodes, IsEmpty());
    file.json = {{"asset", {{"version", "2.0"}}}, {"nodes", {{{"children", {1}}}, {{"name", "leaf"}}}}};
    const Scene scene = file.load();
    EXPECT_THAT(scene.files.at(0).roots, ::testing::ElementsAre(0)) << "without scenes, every root node shows";
}

/// A change to a sound file with one triangle, and the whole message.
struct Broken {
    const char* name;
    std::function<void(GltfBuilder&)> change;
    const char* message;
};
void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.name; }

class BrokenFile : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenFile, IsRefusedWithPlaceAndRemedy) {
    GltfBuilder file;
    file.triangle();
    file.view(std::vector<std::uint8_t>{0, 1, 2, 3});
    GetParam().change(file);
    EXPECT_EQ(file.error(), GetParam().message);
}

const Broken kBroken[] = {
    {"MaterialIndex", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["material"] = 3; },
     "scene.gltf: error: /meshes/0/primitives/0/material is 3\n  expected an index into /materials, but the file has none"},
    {"NegativeIndex", [](GltfBuilder& f) { f.json["nodes"][0]["mesh"] = -1; },
     "scene.gltf: error: /nodes/0/mesh is -1\n  expected an index into /meshes: 0 to 0"},
    {"WrongType", [](GltfBuilder& f) { f.json["nodes"][0]["translation"] = {1, "2", 3}; },
     "scene.gltf: error: /nodes/0/translation/1 is \"2\"\n  expected a number; repair the file with the tool that wrote it"},
    {"WrongLength", [](GltfBuilder& f) { f.json["nodes"][0]["rotation"] = {1, 2, 3}; },
     "scene.gltf: error: /nodes/0/rotation is an array of 3\n  expected 4 numbers; repair the file with the tool that wrote it"},
    {"Missing", [](GltfBuilder& f) { f.json["accessors"][0].erase("count"); },
     "scene.gltf: error: /accessors/0/count is missing\n  expected an integer: glTF requires it"},
    {"Choice", [](GltfBuilder& f) { f.json["materials"] = {{{"alphaMode", "GLASS"}}}; },
     "scene.gltf: error: /materials/0/alphaMode is \"GLASS\"\n  expected one of: OPAQUE MASK BLEND"},
    {"Range", [](GltfBuilder& f) { f.json["materials"] = {{{"pbrMetallicRoughness", {{"roughnessFactor", 1.5}}}}}; },
     "scene.gltf: error: /materials/0/pbrMetallicRoughness/roughnessFactor is 1.5\n  expected 0 to 1"},
    {"Mode", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["mode"] = 7; },
     "scene.gltf: error: /meshes/0/primitives/0/mode is 7\n  expected 0 to 6"},
    {"PastTheView", [](GltfBuilder& f) { f.json["accessors"][0]["count"] = 4; },
     "scene.gltf: error: /accessors/0 needs 48 bytes from offset 0, buffer view 0 has 36\n"
     "  expected a range inside the buffer view; the file is damaged; export it anew"},
    {"HugeCount", [](GltfBuilder& f) { f.json["accessors"][0]["count"] = 4294967295u; },
     "scene.gltf: error: /accessors/0/count is 4294967295\n  expected 1 to 2147483648"},
    {"HugeZeros", [](GltfBuilder& f) { f.json["accessors"][0] = {{"type", "VEC3"}, {"componentType", 5126}, {"count", 2147483647}}; },
     "scene.gltf: error: /accessors/0/count is 2147483647 without a buffer view\n  expected at most 1 GiB of zeros in a file"},
    {"PastTheBuffer", [](GltfBuilder& f) { f.json["bufferViews"][1]["byteOffset"] = 4294967290u; },
     "scene.gltf: error: /bufferViews/1 covers bytes 4294967290 to 4294967294, buffer 0 has 40\n"
     "  expected a range inside the buffer; the file is damaged; export it anew"},
    {"ComponentType", [](GltfBuilder& f) { f.json["accessors"][0]["componentType"] = 5124; },
     "scene.gltf: error: /accessors/0/componentType is 5124\n  expected one of: 5120 5121 5122 5123 5125 5126"},
    {"PositionType", [](GltfBuilder& f) { f.json["accessors"][0]["componentType"] = 5125; },
     "scene.gltf: error: /meshes/0/primitives/0/attributes/POSITION is VEC3 of unsigned int\n"
     "  expected VEC3 of float, or with KHR_mesh_quantization of byte or short"},
    {"IndexBeyondVertices", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["indices"] = f.accessor_of(1, "SCALAR", 5121, 4); },
     "scene.gltf: error: /meshes/0/primitives/0/indices element 3 is 3\n  expected vertices 0 to 2"},
    {"Restart", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["indices"] = f.accessor(std::vector<std::uint8_t>{0, 1, 255, 2}, "SCALAR", 5121, 4); },
     "scene.gltf: error: /meshes/0/primitives/0/indices element 2 is the primitive restart value 255\n  expected vertices 0 to 2"},
    {"AttributeCount", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = f.floats({0, 0, 1, 1}, "VEC2"); },
     "scene.gltf: error: /meshes/0/primitives/0/attributes/TEXCOORD_0 has 2 elements, POSITION has 3\n  expected as many elements in every attribute"},
    {"NotANumber", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
          f.floats({0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0, 0, 1, 0}, "VEC3"); },
     "scene.gltf: error: /meshes/0/primitives/0/attributes/POSITION element 1 is not finite\n  expected finite numbers; export the mesh anew"},
    {"SparseIndex", [](GltfBuilder& f) {
         const int indices = f.view(std::vector<std::uint16_t>{9, 0}), values = f.view(std::vector<float>{1, 2, 3});
         f.json["accessors"][0]["sparse"] = {{"count", 1}, {"indices", {{"bufferView", indices}, {"componentType", 5123}}}, {"values", {{"bufferView", values}}}};
     }, "scene.gltf: error: /accessors/0/sparse/indices replace element 9\n  expected elements 0 to 2; the file is damaged"},
    {"Cycle", [](GltfBuilder& f) { f.json["nodes"] = {{{"name", "top"}}, {{"children", {2}}}, {{"children", {1}}}}; },
     "scene.gltf: error: /nodes/1 is its own ancestor, or hangs below a node that is\n  expected a tree without cycles"},
    {"TwoParents", [](GltfBuilder& f) { f.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"name", "child"}}}; },
     "scene.gltf: error: /nodes/1/children names node 2, which node 0 has already\n  expected a tree: one parent for each node"},
    {"OutsideTheFolder", [](GltfBuilder& f) { f.json["buffers"] = {{{"byteLength", 40}, {"uri", "../secret.bin"}}}; },
     "scene.gltf: error: /buffers/0/uri is \"../secret.bin\"\n  expected a relative path that stays in the asset's folder; copy the file next to the asset"},
    {"MissingBuffer", [](GltfBuilder& f) { f.json["buffers"] = {{{"byteLength", 40}, {"uri", "gone.bin"}}}; },
     "scene.gltf: error: /buffers/0/uri is \"gone.bin\": there is no such file\n  expected a readable file next to the asset"},
    {"ShortBuffer", [](GltfBuilder& f) { f.json["buffers"] = {{{"byteLength", 40}, {"uri", "data:;base64,S2Fkcg=="}}}; },
     "scene.gltf: error: /buffers/0/byteLength is 40, its data has 4 bytes\n  the data is truncated; copy or export it anew"},
    {"RequiredExtension", [](GltfBuilder& f) { f.json["extensionsRequired"] = {"ACME_teapot"}; },
     "scene.gltf: error: /extensionsRequired/0 is ACME_teapot, which Kadr does not support\n  export the file without requiring that extension"},
    {"Draco", [](GltfBuilder& f) { f.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
     "scene.gltf: error: /extensionsRequired/0 is KHR_draco_mesh_compression: Draco compressed meshes are not supported yet\n"
     "  export the file without mesh compression"},
    {"Version", [](GltfBuilder& f) { f.json["asset"]["version"] = "1.0"; },
     "scene.gltf: error: /asset/version is \"1.0\"\n  expected \"2.0\"; convert the file to glTF 2.0"},
    {"MinVersion", [](GltfBuilder& f) { f.json["asset"]["minVersion"] = "2.1"; },
     "scene.gltf: error: /asset/minVersion is \"2.1\"\n  Kadr reads glTF 2.0"},
    {"DefaultScene", [](GltfBuilder& f) { f.json["scene"] = 1; },
     "scene.gltf: error: /scene is 1\n  expected an index into /scenes: 0 to 0"},
    {"Projection", [](GltfBuilder& f) { f.json["nodes"][0]["matrix"] = {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; },
     "scene.gltf: error: /nodes/0/matrix has 0.5 as element 3\n  expected 0, 0, 0, 1 in the last row: an affine transform"},
    {"ThirdUvSet", [](GltfBuilder& f) {
         f.json["images"] = {{{"uri", "x.png"}}};
         f.json["textures"] = {{{"source", 0}}};
         f.json["materials"] = {{{"emissiveTexture", {{"index", 0}, {"texCoord", 2}}}}};
         f.json["meshes"][0]["primitives"][0]["material"] = 0;
     }, "scene.gltf: error: /materials/0/emissiveTexture uses TEXCOORD_2: more than two sets of texture coordinates are not supported yet\n"
        "  expected texCoord 0 or 1"},
};
INSTANTIATE_TEST_SUITE_P(All, BrokenFile, ::testing::ValuesIn(kBroken), [](const auto& broken) { return std::string(broken.param.name); });

TEST(Document, MissingFileIsReportedAtTheShot) {
    try {
        load_scene({{"hero", "nowhere/hero.glb", {"pan.yaml", 7, 9}}});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "pan.yaml:7:9: error: cannot read nowhere/hero.glb: there is no such file\n"
                                   "  expected a glTF 2.0 file (.gltf or .glb); paths are relative to the shot file");
    }
}

TEST(Document, TextThatIsNoGltf) {
    const GltfBuilder file;
    EXPECT_EQ(file.error_of(file.save_text("x.gltf", "")), "x.gltf: error: is empty\n  expected a glTF 2.0 file (.gltf or .glb)");
    EXPECT_THAT(file.error_of(file.save_text("x.gltf", "hello")), HasSubstr("x.gltf: error: is not valid JSON: parse error at line 1, column 1"));
    EXPECT_EQ(file.error_of(file.save_text("x.gltf", R"({"asset": {"version": "2.0"}, "scene": 1e400})")), "x.gltf: error: is not valid JSON: number overflow parsing '1e400'\n  expected a glTF 2.0 file (.gltf or .glb)");
    EXPECT_EQ(file.error_of(file.save_text("x.gltf", "[1]")), "x.gltf: error: its JSON is not an object\n  expected a glTF 2.0 file (.gltf or .glb)");
    EXPECT_EQ(file.error_of(file.save_text("x.gltf", std::string(1000000, '['))), "x.gltf: error: its JSON nests 1000000 levels deep\n  expected at most 64 levels");
    EXPECT_EQ(file.error_of(file.folder()), "error: cannot read " + file.folder().string() + ": it is not a regular file\n  expected a glTF 2.0 file (.gltf or .glb); paths are relative to the shot file");
}

TEST(Document, DeepNodeChainsLoad) {
    GltfBuilder file;
    file.triangle();
    constexpr int kDepth = 20000;
    for (int i = 1; i < kDepth; ++i) {
        file.json["nodes"].push_back({{"name", "link"}});
        file.json["nodes"][static_cast<std::size_t>(i) - 1]["children"] = {i};
    }
    EXPECT_THAT(file.load().nodes, SizeIs(kDepth));
}

TEST(Document, SharedAccessorsCannotMultiplyWithoutLimit) {
    GltfBuilder file;
    const int position = file.accessor_of(-1, "VEC3", 5126, 4000000);
    for (int i = 0; i < 8; ++i) file.primitive(position)["attributes"]["_COPY_" + std::to_string(i)] = position;
    EXPECT_THAT(file.error(), HasSubstr("scene.gltf: error: /meshes need 32000000 vertices, "));
}

}  // namespace
}  // namespace kadr
