#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <iostream>

#include "corpus.h"
#include "scene/scene.h"

namespace kadr {
namespace {

using ::testing::ContainsRegex;
using test::assets_folder;
using test::gltf_files;

bool in_malformed(const std::filesystem::path& path) { return path.string().find("/malformed/") != std::string::npos; }

void expect_sound(const Scene& scene) {
    for (const GeometryData& g : scene.geometries) {
        ASSERT_EQ(g.indices.size() % 3, 0u);
        for (const std::uint32_t i : g.indices) ASSERT_LT(i, g.positions.size());
        for (const auto& p : g.positions) ASSERT_LE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1.0f) << g.name;
        for (const auto& n : g.normals) ASSERT_NEAR(dot(n, n), 1.0f, 1e-5f) << g.name;
        for (const std::size_t size : {g.normals.size(), g.tangents.size(), g.uv[0].size(), g.uv[1].size(), g.colors.size()})
            ASSERT_TRUE(size == 0 || size == g.positions.size()) << g.name;
    }
    for (const Node& node : scene.nodes)
        for (const MeshPrimitive& primitive : node.primitives) {
            ASSERT_LT(static_cast<std::size_t>(primitive.geometry), scene.geometries.size());
            ASSERT_LT(static_cast<std::size_t>(primitive.material), scene.materials.size());
        }
    for (const TextureData& texture : scene.textures) ASSERT_GE(texture.texels.size(), static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height) * 4);
    for (const kernels::Material& material : scene.materials) ASSERT_LT(material.base_color_texture.texture, static_cast<int>(scene.textures.size()));
}

TEST(Corpus, LoadsOrNamesTheFeatureThatIsMissing) {
    KADR_NEED_ASSETS();
    int loaded = 0, files = 0;
    for (const auto& path : gltf_files(assets_folder())) {
        if (in_malformed(path)) continue;
        ++files;
        try {
            expect_sound(load_scene({{"scene", path, {}}}));
            ++loaded;
        } catch (const InputError& error) {
            std::cout << std::filesystem::relative(path, assets_folder()).string() << ": " << error.diagnostics().front().found << '\n';
            EXPECT_THAT(error.what(), ContainsRegex("not support|glTF 2.0")) << "refused for no reason";
        }
    }
    std::cout << loaded << " of " << files << " files load\n";
    EXPECT_GE(loaded, 100);
}

TEST(Corpus, MalformedFilesEndInTime) {
    KADR_NEED_ASSETS();
    int refused = 0, files = 0;
    for (const auto& path : gltf_files(assets_folder() / "malformed")) {
        ++files;
        const auto begin = std::chrono::steady_clock::now();
        try {
            expect_sound(load_scene({{"scene", path, {}}}));
            if (std::getenv("KADR_TEST_VERBOSE")) std::cout << path << " loads\n";
        } catch (const InputError& error) {
            ++refused;
            EXPECT_THAT(error.diagnostics().front().found, ::testing::Not(::testing::IsEmpty()));
            if (std::getenv("KADR_TEST_VERBOSE")) std::cout << error.what() << '\n';
        }
        EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2)) << path;
    }
    std::cout << refused << " of " << files << " malformed files are refused\n";
    EXPECT_GT(refused, files / 2);
}

}  // namespace
}  // namespace kadr
