#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "corpus.h"
#include "gltf_builder.h"
#include "scene/geometry_builder.h"
#include "scene/tangents.h"

namespace kadr {
namespace {

using test::GltfBuilder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Positions as the file has them. One float of rounding in [-1, 1], so 1e-6 of the mesh's size is enough.
std::vector<glm::dvec3> file_positions(const GeometryData& g) {
    std::vector<glm::dvec3> result;
    for (const auto& p : g.positions) result.push_back(g.centre + g.scale * glm::dvec3(p.x, p.y, p.z));
    return result;
}
void expect_positions(const GeometryData& g, const std::vector<glm::dvec3>& expected) {
    const auto found = file_positions(g);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(glm::distance(found[i], expected[i]), 0, 1e-6 * g.scale) << i;
}

TEST(Geometry, IsNormalisedAroundItsCentre) {
    GltfBuilder file;
    file.primitive(file.floats({10, 0, 0, 30, 4, 0, 10, 0, 2}, "VEC3"));
    const Scene scene = file.load();
    ASSERT_THAT(scene.geometries, SizeIs(1));
    const GeometryData& g = scene.geometries[0];
    EXPECT_EQ(g.name, "mesh/0");
    EXPECT_EQ(g.centre, glm::dvec3(20, 2, 1));
    EXPECT_EQ(g.scale, 10);
    EXPECT_EQ(g.positions[0].x, -1.0f);
    EXPECT_EQ(g.positions[1].x, 1.0f);
    EXPECT_THAT(g.indices, ElementsAre(0, 1, 2));
    EXPECT_THAT(g.normals, IsEmpty()) << "flat";
    expect_positions(g, {{10, 0, 0}, {30, 4, 0}, {10, 0, 2}});
}

TEST(Geometry, OfEqualPointsHasScaleOne) {
    GltfBuilder file;
    file.primitive(file.floats({5, 5, 5, 5, 5, 5, 5, 5, 5}, "VEC3"));
    const Scene scene = file.load();
    EXPECT_EQ(scene.geometries.at(0).scale, 1);
    EXPECT_EQ(scene.geometries[0].centre, glm::dvec3(5));
}

template <class T>
void expect_quantised(int component_type, bool normalized) {
    GltfBuilder file;
    const T top = std::numeric_limits<T>::max(), half = static_cast<T>(top / 2);
    const std::size_t stride = (3 * sizeof(T) + 3) / 4 * 4;
    std::string bytes(3 * stride, '\0');
    const T values[3][3] = {{0, 0, 0}, {top, 0, 0}, {0, half, 0}};
    for (std::size_t i = 0; i < 3; ++i) std::memcpy(&bytes[i * stride], values[i], sizeof values[i]);
    file.primitive(file.accessor_of(file.view(bytes, static_cast<int>(stride)), "VEC3", component_type, 3, normalized));
    file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const double unit = normalized ? top : 1;
    expect_positions(file.load().geometries.at(0), {{0, 0, 0}, {top / unit, 0, 0}, {0, half / unit, 0}});
}

TEST(Geometry, ReadsEveryComponentType) {
    for (const bool normalized : {false, true}) {
        expect_quantised<std::int8_t>(5120, normalized);
        expect_quantised<std::uint8_t>(5121, normalized);
        expect_quantised<std::int16_t>(5122, normalized);
        expect_quantised<std::uint16_t>(5123, normalized);
    }
}

TEST(Geometry, ReadsEveryIndexType) {
    const auto indices_of = [](auto value, int type) {
        GltfBuilder file;
        using T = decltype(value);
        const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
        file.primitive(positions, file.accessor(std::vector<T>{2, 1, 3, 0, 1, 2}, "SCALAR", type, 6));
        return file.load().geometries.at(0).indices;
    };
    EXPECT_THAT(indices_of(std::uint8_t{}, 5121), ElementsAre(2, 1, 3, 0, 1, 2));
    EXPECT_THAT(indices_of(std::uint16_t{}, 5123), ElementsAre(2, 1, 3, 0, 1, 2));
    EXPECT_THAT(indices_of(std::uint32_t{}, 5125), ElementsAre(2, 1, 3, 0, 1, 2));
}

TEST(Geometry, ReadsInterleavedAttributes) {
    GltfBuilder file;
    const int view = file.view(std::vector<float>{0, 0, 0, 0, 0, 2, /**/ 1, 0, 0, 0, 0, 3, /**/ 0, 1, 0, 0, 0, 4}, 24);
    const int position = file.accessor_of(view, "VEC3", 5126, 3), normal = file.accessor_of(view, "VEC3", 5126, 3);
    file.json["accessors"][static_cast<std::size_t>(normal)]["byteOffset"] = 12;
    file.primitive(position)["attributes"]["NORMAL"] = normal;
    const Scene scene = file.load();
    expect_positions(scene.geometries.at(0), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    for (const auto& n : scene.geometries[0].normals) EXPECT_EQ(n.z, 1.0f) << "unit length";
}

nlohmann::json sparse(GltfBuilder& file, const std::vector<std::uint16_t>& at, const std::vector<float>& values) {
    const int index_view = file.view(at), value_view = file.view(values);
    return {{"count", at.size()}, {"indices", {{"bufferView", index_view}, {"componentType", 5123}}}, {"values", {{"bufferView", value_view}}}};
}

TEST(Geometry, ReadsSparseAccessors) {
    GltfBuilder file;
    const int position = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    file.primitive(position);
    file.json["accessors"][0]["sparse"] = sparse(file, {2}, {0, 7, 0});
    expect_positions(file.load().geometries.at(0), {{0, 0, 0}, {1, 0, 0}, {0, 7, 0}});
}

TEST(Geometry, ReadsSparseAccessorsWithoutBufferView) {
    GltfBuilder file;
    const int position = file.accessor_of(-1, "VEC3", 5126, 3);
    const int indices = file.accessor_of(-1, "SCALAR", 5123, 3);
    file.primitive(position, indices);
    file.json["accessors"][0]["sparse"] = sparse(file, {1, 2}, {1, 0, 0, 0, 1, 0});
    const int index_view = file.view(std::vector<std::uint16_t>{1, 2}), value_view = file.view(std::vector<std::uint16_t>{2, 1});
    file.json["accessors"][1]["sparse"] = {{"count", 2}, {"indices", {{"bufferView", index_view}, {"componentType", 5123}}}, {"values", {{"bufferView", value_view}}}};
    const Scene scene = file.load();
    expect_positions(scene.geometries.at(0), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_THAT(scene.geometries[0].indices, ElementsAre(0, 2, 1));
}

TEST(Geometry, TurnsStripsAndFansIntoTriangles) {
    const auto indices_of = [](int mode) {
        GltfBuilder file;
        file.primitive(file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3"), -1, mode);
        return file.load().geometries.at(0).indices;
    };
    EXPECT_THAT(indices_of(5), ElementsAre(0, 1, 2, /**/ 1, 3, 2, /**/ 2, 3, 4));
    EXPECT_THAT(indices_of(6), ElementsAre(1, 2, 0, /**/ 2, 3, 0, /**/ 3, 4, 0));
}

TEST(Geometry, SkipsPointsAndLinesWithAWarning) {
    GltfBuilder file;
    file.primitive(file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"), -1, 0);
    const Scene scene = file.load();
    EXPECT_THAT(scene.geometries, IsEmpty());
    EXPECT_THAT(scene.nodes.at(0).primitives, IsEmpty());
    ASSERT_THAT(scene.warnings, SizeIs(1));
    EXPECT_EQ(scene.warnings[0].found, "/meshes/0/primitives/0/mode is 0 (points); the primitive is skipped");
    EXPECT_TRUE(scene.warnings[0].warning);
}

TEST(Geometry, ReadsColoursAndCoordinatesOfNormalisedIntegers) {
    GltfBuilder file;
    nlohmann::json& primitive = file.triangle();
    primitive["attributes"]["COLOR_0"] = file.accessor_of(file.view(std::vector<std::uint8_t>{255, 0, 0, 0, 0, 255, 0, 0, 0, 0, 51, 0}, 4), "VEC3", 5121, 3, true);
    primitive["attributes"]["TEXCOORD_0"] = file.accessor(std::vector<std::uint16_t>{0, 0, 65535, 0, 0, 13107}, "VEC2", 5123, 3, true);
    primitive["attributes"]["TEXCOORD_1"] = file.floats({5, 6, 7, 8, 9, 10}, "VEC2");
    const Scene scene = file.load();
    const GeometryData& g = scene.geometries.at(0);
    EXPECT_EQ(g.colors.at(0).x, 1.0f);
    EXPECT_EQ(g.colors.at(0).w, 1.0f);
    EXPECT_FLOAT_EQ(g.colors.at(2).z, 0.2f);
    EXPECT_EQ(g.uv[0].at(1).x, 1.0f);
    EXPECT_FLOAT_EQ(g.uv[0].at(2).y, 0.2f);
    EXPECT_EQ(g.uv[1].at(2).y, 10.0f);
}

TEST(Geometry, IsSharedByEqualPrimitives) {
    GltfBuilder file;
    file.triangle();
    file.json["meshes"].push_back(file.json["meshes"][0]);
    file.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}}, {{"mesh", 1}}};
    file.json["scenes"][0]["nodes"] = {0, 1, 2};
    const auto path = file.save_gltf();
    const Scene scene = load_scene({{"a", path, {}}, {"b", path, {}}});
    EXPECT_THAT(scene.geometries, SizeIs(1));
    EXPECT_THAT(scene.materials, SizeIs(1));
    ASSERT_THAT(scene.nodes, SizeIs(6));
    for (const Node& node : scene.nodes) EXPECT_EQ(node.primitives.at(0).geometry, 0);
    EXPECT_EQ(scene.files.at(1).first_node, 3);
    EXPECT_THAT(scene.files.at(1).roots, ElementsAre(3, 4, 5));
}

GeometryData quad(bool mirrored) {
    GeometryData g;
    g.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    g.normals.assign(4, {0, 0, 1});
    const float l = mirrored ? 1.0f : 0.0f;
    g.uv[0] = {{l, 1}, {1 - l, 1}, {1 - l, 0}, {l, 0}};  // v = 0 is the top
    g.indices = {0, 1, 2, 0, 2, 3};
    return g;
}

TEST(Tangents, PointAlongUWithBitangentsToTheTop) {
    GeometryData g = quad(false);
    add_tangents(g, 0);
    for (const auto& t : g.tangents) {
        EXPECT_FLOAT_EQ(t.x, 1);
        EXPECT_EQ(t.w, 1) << "cross(+z, +x) = +y is the top of the image";
    }
    GeometryData m = quad(true);
    add_tangents(m, 0);
    for (const auto& t : m.tangents) {
        EXPECT_FLOAT_EQ(t.x, -1);
        EXPECT_EQ(t.w, -1);
    }
}

TEST(Tangents, OfFlatMeshesBelongToTriangles) {
    GeometryData g = quad(false);
    g.normals.clear();
    add_tangents(g, 0);
    EXPECT_THAT(g.positions, SizeIs(6));
    EXPECT_THAT(g.tangents, SizeIs(6));
    EXPECT_THAT(g.normals, IsEmpty());
}

TEST(Tangents, AgreeWithThoseOfAnOutsideFile) {
    KADR_NEED_ASSETS();
    const auto path = test::gltf_files(test::assets_folder() / "NormalTangentMirrorTest").at(0);
    const Scene scene = load_scene({{"scene", path, {}}});
    std::size_t same_side = 0, close = 0, all = 0;
    for (const GeometryData& g : scene.geometries) {
        if (g.tangents.empty()) continue;
        GeometryData own = g;
        own.tangents.clear();
        add_tangents(own, 0);
        for (std::size_t i = 0; i < g.tangents.size(); ++i) {
            const auto &a = g.tangents[i], &b = own.tangents[i];
            ++all;
            same_side += a.w == b.w;
            close += a.x * b.x + a.y * b.y + a.z * b.z > 0.9f;
        }
    }
    ASSERT_GT(all, 100u);
    // Vertices at mirror seams are where an unsplit mesh may differ.
    EXPECT_GT(static_cast<double>(same_side), 0.95 * static_cast<double>(all));
    EXPECT_GT(static_cast<double>(close), 0.95 * static_cast<double>(all));
}

}  // namespace
}  // namespace kadr
