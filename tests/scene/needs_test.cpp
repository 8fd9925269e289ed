// Only what is needed is read: what is not may be missing, damaged or of any size.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "gltf_builder.h"
#include "scene/scene_files.h"

namespace kadr {
namespace {

using test::GltfBuilder;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// A triangle with all attributes and a material whose five textures are files that are not there.
struct Everything : GltfBuilder {
    Everything() {
        triangle()["material"] = 0;
        json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")}}};
        auto& attributes = json["meshes"][0]["primitives"][0]["attributes"];
        attributes["NORMAL"] = floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        attributes["TANGENT"] = floats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4");
        attributes["TEXCOORD_0"] = attributes["TEXCOORD_1"] = floats({0, 1, 1, 1, 0, 0}, "VEC2");
        attributes["COLOR_0"] = floats({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
        attributes["WEIGHTS_0"] = floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
        attributes["JOINTS_0"] = accessor(std::vector<std::uint8_t>(12, 0), "VEC4", 5121, 3);
        json["nodes"][0]["skin"] = 0;
        json["skins"] = {{{"joints", {0}}, {"inverseBindMatrices", accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 5126, 1)}}};
        const char* const names[] = {"color.png", "metal.png", "normal.png", "glow.png", "shade.png"};
        for (int i = 0; i < kTextureUses; ++i) {
            json["images"].push_back({{"uri", names[i]}});
            json["textures"].push_back({{"source", i}});
        }
        const auto texture = [](int i) { return nlohmann::json{{"index", i}}; };
        json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture(0)}, {"metallicRoughnessTexture", texture(1)}}},
                              {"normalTexture", texture(2)},
                              {"emissiveTexture", texture(3)},
                              {"occlusionTexture", texture(4)}}};
    }
    /// The scene as far as it is needed.
    template <class Change>
    Scene load_with(Change change) {
        SceneFiles files({{"scene", save_gltf(), {}}});
        SceneNeeds needs;
        needs.geometries.resize(1);
        needs.textures.resize(1);
        needs.skins.resize(1);
        change(needs);
        return std::move(files).load(needs);
    }
    /// Damages the data of an accessor: it can be read, but not used.
    void poison(int accessor) {
        json["accessors"][static_cast<std::size_t>(accessor)]["bufferView"] = nan_view_ < 0 ? nan_view_ = view(std::vector<float>(16, std::nanf(""))) : nan_view_;
    }

private:
    int nan_view_ = -1;
};

TEST(Needs, OfNothingReadNothing) {
    const Scene scene = Everything().load_with([](SceneNeeds&) {});
    EXPECT_THAT(scene.geometries, IsEmpty());
    EXPECT_THAT(scene.textures, IsEmpty());
    EXPECT_THAT(scene.nodes.at(0).primitives, IsEmpty());
    EXPECT_THAT(scene.skins.at(0).inverse_bind, IsEmpty());
    EXPECT_EQ(scene.material_names, std::vector<std::string>{"material 0"}) << "a shot may speak of it";
    for (const kernels::TextureSlot& slot : {scene.materials[0].base_color_texture, scene.materials[0].occlusion_texture}) EXPECT_EQ(slot.texture, -1);
}

TEST(Needs, AreReadAttributeByAttribute) {
    // Each attribute alone is damaged: it is found by who needs it, and by nobody else.
    struct Case {
        const char* name;
        void (*need)(GeometryNeeds&);
    };
    const Case cases[] = {{"TEXCOORD_0", [](GeometryNeeds& g) { g.uv[0] = true; }}, {"COLOR_0", [](GeometryNeeds& g) { g.colors = true; }},
                          {"TANGENT", [](GeometryNeeds& g) { g.tangents = true; }}, {"WEIGHTS_0", [](GeometryNeeds& g) { g.skin = true; }},
                          {"target", [](GeometryNeeds& g) { g.targets = true; }}};
    for (const Case& one : cases) {
        Everything file;
        auto& primitive = file.json["meshes"][0]["primitives"][0];
        const std::string name = one.name;
        file.poison(name == "target" ? primitive["targets"][0]["POSITION"].get<int>() : primitive["attributes"][name].get<int>());
        const auto load = [&](bool needed) {
            return file.load_with([&](SceneNeeds& needs) {
                needs.geometries[0].wanted = true;
                if (needed) one.need(needs.geometries[0]);
            });
        };
        const GeometryData geometry = load(false).geometries.at(0);
        EXPECT_THAT(geometry.positions, SizeIs(3)) << name;
        EXPECT_THAT(geometry.uv[0], IsEmpty());
        EXPECT_THAT(geometry.uv[1], IsEmpty());
        EXPECT_THAT(geometry.colors, IsEmpty());
        EXPECT_THAT(geometry.tangents, IsEmpty());
        EXPECT_THAT(geometry.targets, IsEmpty());
        EXPECT_EQ(geometry.skin.per_vertex, 0);
        EXPECT_THROW(load(true), InputError) << name;
    }
}

TEST(Needs, OfColorsEndWhereAllAreWhite) {
    const auto colors_of = [](const std::vector<float>& colors) {
        GltfBuilder file;
        file.triangle()["attributes"]["COLOR_0"] = file.floats(colors, "VEC3");
        return file.load().geometries.at(0).colors.size();
    };
    EXPECT_EQ(colors_of({1, 1, 1, 1, 1, 1, 1, 1, 1}), 0u) << "they change nothing";
    EXPECT_EQ(colors_of({1, 1, 1, 1, 1, 1, 1, 1, 0.999f}), 3u);
}

TEST(Needs, OfTexturesAreReadRoleByRole) {
    for (int role = 0; role < kTextureUses; ++role) {
        Everything file;
        const auto load = [&](int needed) {
            return file.load_with([needed](SceneNeeds& needs) { needs.textures[0][static_cast<std::size_t>(needed)] = true; });
        };
        EXPECT_THROW(load(role), InputError) << "its file is not there";
        const std::string png = "\x89PNG\r\n\x1A\n" + std::string("\0\0\0\rIHDR\0\0\0\2\0\0\0\1\x08\2\0\0\0{@\xe8\xdd\0\0\0\rIDATx\x9c" "c\xf8\xcf\0\4\xff\1\7\0\1\xff\xe2#\x9eY\0\0\0\0IEND\xae" "B`\x82", 62);
        file.save_text(file.json["images"][static_cast<std::size_t>(role)]["uri"].get<std::string>(), png);
        const Scene scene = load(role);
        ASSERT_THAT(scene.textures, SizeIs(1)) << "and the others are not there either";
        EXPECT_EQ(scene.textures[0].width, 2);
        const kernels::Material& m = scene.materials.at(0);
        const kernels::TextureSlot slots[] = {m.base_color_texture, m.metallic_roughness_texture, m.normal_texture, m.emissive_texture, m.occlusion_texture};
        for (int other = 0; other < kTextureUses; ++other) EXPECT_EQ(slots[other].texture, other == role ? 0 : -1);
    }
}

TEST(Needs, SkinsHaveMatricesWhereTheyBend) {
    const Scene scene = Everything().load_with([](SceneNeeds& needs) { needs.skins[0] = true; });
    EXPECT_THAT(scene.skins.at(0).inverse_bind, SizeIs(1));
}

TEST(Needs, OfClipsAreThoseThatPlay) {
    GltfBuilder file;
    file.triangle();
    const int times = file.floats({0, 1}, "SCALAR"), places = file.floats({0, 0, 0, 1, 0, 0}, "VEC3"), broken = file.floats({1, 0}, "SCALAR");
    const auto clip = [&](const char* name, int input) {
        return nlohmann::json{{"name", name},
                              {"samplers", {{{"input", input}, {"output", places}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}};
    };
    file.json["animations"] = {clip("Walk", times), clip("Run", broken)};
    const auto path = file.save_gltf();
    EXPECT_THROW(load_scene({{"a", path, {}}}), InputError) << "the times of Run decrease";
    const Scene scene = load_scene({{"a", path, {}, {false, {"Walk"}, {}}}});
    EXPECT_THAT(scene.clips.at(0).channels, SizeIs(1));
    EXPECT_TRUE(scene.clips.at(0).read);
    EXPECT_EQ(scene.clips.at(1).name, "Run");
    EXPECT_EQ(scene.clips.at(1).channel_count, 1);
    EXPECT_FALSE(scene.clips.at(1).read);
    EXPECT_THROW(load_scene({{"a", path, {}, {false, {"Walk"}, {}}}, {"b", path, {}, {false, {}, {1}}}}), InputError) << "entries of a file share its clips";
}

TEST(Needs, ShowWhatTheFilesHold) {
    Everything file;
    file.json["extensionsUsed"] = {"KHR_materials_unlit", "KHR_materials_sheen", "KHR_materials_unlit"};
    file.json["images"].push_back({{"uri", "spare.png"}});
    const SceneFiles files({{"scene", file.save_gltf(), {}}});
    const GeometryOutline& outline = files.outline().geometries.at(0);
    EXPECT_EQ(outline.vertices, 3u);
    EXPECT_EQ(outline.corners, 3u);
    EXPECT_EQ(outline.targets, 1u);
    EXPECT_TRUE(outline.normals && outline.tangents && outline.colors && outline.skin && outline.uv[0] && outline.uv[1]);
    EXPECT_THAT(files.outline().scene.geometries.at(0).positions, IsEmpty());
    const SceneFile& scene = files.outline().scene.files.at(0);
    EXPECT_THAT(scene.extensions, ElementsAre("KHR_materials_unlit"));
    EXPECT_THAT(scene.ignored_extensions, ElementsAre("KHR_materials_sheen"));
    EXPECT_THAT(scene.unused_images, ElementsAre("spare.png"));
}

TEST(Needs, DecideWhatTheHashOfAFileCovers) {
    Everything file;
    const auto hash = [&](bool colors) {
        return file.load_with([&](SceneNeeds& needs) {
                       needs.geometries[0].wanted = true;
                       needs.geometries[0].colors = colors;
                   })
            .files.at(0)
            .content;
    };
    const Hash without = hash(false), with = hash(true);
    EXPECT_NE(with, without);
    EXPECT_EQ(with, hash(true));
}

/// A GLB file whose second half is `bytes` of image that no material shows. The file is sparse: it takes no space.
std::filesystem::path huge_glb(GltfBuilder& file, std::uint64_t bytes) {
    file.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 1 << 20}, {"byteLength", bytes}});
    file.json["images"].push_back({{"bufferView", file.json["bufferViews"].size() - 1}, {"mimeType", "image/png"}});
    const std::filesystem::path path = file.save_glb();
    std::string data;
    {
        std::ifstream stream(path, std::ios::binary);
        data.assign(std::istreambuf_iterator<char>(stream), {});
    }
    const auto u32 = [&](std::size_t at) { return *reinterpret_cast<std::uint32_t*>(&data[at]); };
    nlohmann::json json = nlohmann::json::parse(data.substr(20, u32(12)));
    const std::string binary = data.substr(20 + u32(12) + 8);
    json["buffers"][0]["byteLength"] = (1 << 20) + bytes;
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::ofstream out(path, std::ios::binary);
    const auto put = [&](std::uint64_t value) {
        const auto word = static_cast<std::uint32_t>(value);
        out.write(reinterpret_cast<const char*>(&word), 4);
    };
    const std::uint64_t length = (1 << 20) + bytes;
    out.write("glTF", 4);
    put(2), put(20 + text.size() + 8 + length), put(text.size()), put(0x4E4F534A);
    out << text;
    put(length), put(0x004E4942);
    out << binary;
    out.close();
    std::filesystem::resize_file(path, 20 + text.size() + 8 + length);
    return path;
}

TEST(Needs, LeaveTheRestOfAFileOnTheDisk) {
    GltfBuilder file;
    file.triangle();
    const std::filesystem::path path = huge_glb(file, 3ull << 30);
    const Scene scene = load_scene({{"scene", path, {}}});
    EXPECT_THAT(scene.geometries, SizeIs(1));
    EXPECT_THAT(scene.files[0].unused_images, SizeIs(1));
    EXPECT_LT(scene.files[0].read_bytes, 2000u) << "the JSON and the triangle, of 3 GiB";
}

TEST(Needs, DoNotTouchFilesThatAreNoFiles) {
    Everything file;
    ASSERT_EQ(mkfifo((file.folder() / "shade.png").c_str(), 0600), 0);
    const auto load = [&](bool occlusion) {
        return file.load_with([occlusion](SceneNeeds& needs) {
            needs.geometries[0].wanted = true;
            needs.textures[0][4] = occlusion;
        });
    };
    EXPECT_THAT(load(false).geometries, SizeIs(1));
    EXPECT_THROW(load(true), InputError) << "it is not a regular file";
}

}  // namespace
}  // namespace kadr
