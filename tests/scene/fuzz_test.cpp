#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <random>

#include "gltf_builder.h"

namespace kadr {
namespace {

using test::GltfBuilder;

/// A small file with a little of everything.
std::string seed_file(GltfBuilder& file) {
    const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
    const int indices = file.accessor(std::vector<std::uint16_t>{0, 1, 2, 1, 3, 2}, "SCALAR", 5123, 6);
    nlohmann::json& primitive = file.primitive(positions, indices);
    primitive["attributes"]["NORMAL"] = file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    primitive["attributes"]["TEXCOORD_0"] = file.floats({0, 0, 1, 0, 0, 1, 1, 1}, "VEC2");
    primitive["attributes"]["COLOR_0"] = file.accessor(std::vector<std::uint8_t>(16, 200), "VEC4", 5121, 4, true);
    primitive["material"] = 0;
    const int times = file.floats({0, 1}, "SCALAR"), moves = file.floats({0, 0, 0, 1, 2, 3}, "VEC3");
    const int at = file.view(std::vector<std::uint16_t>{1, 3}), values = file.view(std::vector<float>{2, 0, 0, 2, 2, 0});
    file.json["accessors"][0]["sparse"] = {{"count", 2}, {"indices", {{"bufferView", at}, {"componentType", 5123}}}, {"values", {{"bufferView", values}}}};
    file.json.merge_patch(nlohmann::json::parse(R"({
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
        "nodes": [{"mesh": 0, "children": [1, 2]}, {"camera": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 1,2,3,1]}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {"outerConeAngle": 0.5}}]}},
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.1, 0.2]}}}}}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071}],
        "images": [{"mimeType": "image/png", "bufferView": 0}],
        "animations": [{"samplers": [{"input": 0, "output": 0}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]})"));
    file.json["animations"][0]["samplers"][0] = {{"input", times}, {"output", moves}};
    static constexpr unsigned char kPixel[] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0, 0x3a, 0x7e, 0x9b, 0x55,
                                               0, 0, 0, 10, 'I', 'D', 'A', 'T', 0x78, 0x9c, 0x63, 0x68, 0, 0, 0, 0x82, 0, 0x81, 0x77, 0xcd, 0x72, 0xb6, 0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};
    file.json["images"][0]["bufferView"] = file.view(std::string_view(reinterpret_cast<const char*>(kPixel), sizeof kPixel));
    std::ifstream stream(file.save_glb(), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string mutated(std::string bytes, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
        const std::size_t at = below(bytes.size());
        switch (below(5)) {
            case 0: bytes[at] = static_cast<char>(below(256)); break;
            case 1: bytes[at] = "0123456789-.e[]{},:\""[below(20)]; break;   // keeps JSON alive more often
            case 2: bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))); break;
            case 3: bytes.resize(at + 1); break;
            default: {                                                       // a digit of a number
                const std::size_t digit = bytes.find_first_of("0123456789", at);
                if (digit != std::string::npos) bytes[digit] = static_cast<char>('0' + below(10));
            }
        }
    }
    return bytes;
}

TEST(Fuzz, MutatedFilesLoadOrAreRefused) {
    GltfBuilder file;
    const std::string seed = seed_file(file);
    ASSERT_EQ(file.error_of(file.folder() / "scene.glb"), "(loads)");
    constexpr unsigned kSeed = 20261;
    std::mt19937 random(kSeed);
    int refused = 0, tries = 0;
    const auto begin = std::chrono::steady_clock::now();
    for (; tries < 3000 && std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(2500); ++tries) {
        const auto path = file.save_text("mutant.glb", mutated(seed, random));
        try {
            load_scene({{"scene", path, {}}});
        } catch (const InputError&) {
            ++refused;
        }  // anything else ends the test with the exception's text
    }
    std::cout << refused << " of " << tries << " mutants are refused (seed " << kSeed << ")\n";
    EXPECT_GT(refused, tries / 10);
}

}  // namespace
}  // namespace kadr
