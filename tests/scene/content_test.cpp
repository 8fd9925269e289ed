// Materials, textures, lights, cameras, nodes and animations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_builder.h"

namespace kadr {
namespace {

using kernels::AlphaMode;
using kernels::TexelFormat;
using kernels::Wrap;
using test::GltfBuilder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// PNG of 2 x 1 pixels, RGB: red and blue.
const unsigned char kPng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02,
    0x00, 0x00, 0x00, 0x7b, 0x40, 0xe8, 0xdd, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8, 0xcf, 0x00, 0x04, 0xff, 0x01, 0x07, 0x00,
    0x01, 0xff, 0xe2, 0x23, 0x9e, 0x59, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

std::string png() { return {reinterpret_cast<const char*>(kPng), sizeof kPng}; }
std::string png_uri() { return "data:image/png;base64," + test::base64(png()); }

/// A textured triangle whose material may be changed.
struct Textured : GltfBuilder {
    Textured() {
        triangle()["material"] = 0;
        json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = floats({0, 1, 1, 1, 0, 0}, "VEC2");
        json["images"] = {{{"uri", png_uri()}}};
        json["textures"] = {{{"source", 0}}};
        json["materials"] = {{{"name", "paint"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    }
    nlohmann::json& material() { return json["materials"][0]; }
};

TEST(Materials, HaveGltfsDefaults) {
    GltfBuilder file;
    file.triangle();
    const Scene scene = file.load();
    ASSERT_THAT(scene.materials, SizeIs(1));
    EXPECT_EQ(scene.material_names.at(0), "default");
    EXPECT_EQ(scene.materials[0].base_color.x, 1.0f);
    EXPECT_EQ(scene.materials[0].roughness, 1.0f);
    EXPECT_EQ(scene.materials[0].base_color_texture.texture, -1);
}

TEST(Materials, ReadFactorsAndExtensions) {
    Textured file;
    file.material().merge_patch(nlohmann::json::parse(R"({
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6},
        "emissiveFactor": [1, 0.5, 0], "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}, "KHR_materials_unlit": {}}})"));
    const kernels::Material m = file.load().materials.at(0);
    EXPECT_FLOAT_EQ(m.base_color.y, 0.2f);
    EXPECT_FLOAT_EQ(m.alpha, 0.4f);
    EXPECT_FLOAT_EQ(m.metallic, 0.5f);
    EXPECT_FLOAT_EQ(m.roughness, 0.6f);
    EXPECT_FLOAT_EQ(m.emission.x, 8.0f);
    EXPECT_FLOAT_EQ(m.emission.y, 4.0f);
    EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
    EXPECT_FLOAT_EQ(m.alpha_cutoff, 0.25f);
    EXPECT_TRUE(m.double_sided);
    EXPECT_TRUE(m.unlit);
}

kernels::Material with_ior(const nlohmann::json& ior) {
    Textured file;
    file.material()["extensions"]["KHR_materials_ior"] = ior;
    return file.load().materials.at(0);
}

TEST(Materials, ReflectByTheirIndexOfRefraction) {
    EXPECT_EQ(Textured().load().materials.at(0).dielectric_f0, kernels::kDielectricF0);
    EXPECT_EQ(with_ior(nlohmann::json::object()).dielectric_f0, kernels::kDielectricF0);
    EXPECT_EQ(with_ior({{"ior", 1.5}}).dielectric_f0, kernels::kDielectricF0);
    EXPECT_EQ(with_ior({{"ior", 1}}).dielectric_f0, 0.0f);
    EXPECT_FLOAT_EQ(with_ior({{"ior", 1.33}}).dielectric_f0, static_cast<float>(0.33 * 0.33 / (2.33 * 2.33)));  // water
    EXPECT_FLOAT_EQ(with_ior({{"ior", 5}}).dielectric_f0, 4.0f / 9);
    EXPECT_EQ(with_ior({{"ior", 0}}).dielectric_f0, 1.0f);
}

TEST(Materials, AnIndexOfRefractionBelowThatOfNothingIsAnError) {
    try {
        with_ior({{"ior", 0.9}});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("/materials/0/extensions/KHR_materials_ior/ior is 0.9\n  expected an index of refraction of at least 1, or 0: all light is reflected"));
    }
}

TEST(Materials, TransformTextureCoordinates) {
    Textured file;
    file.material()["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
        {"offset", {0.25, 0.5}}, {"rotation", std::acos(-1.0) / 2}, {"scale", {2, 3}}, {"texCoord", 1}};
    const kernels::TextureSlot slot = file.load().materials.at(0).base_color_texture;
    EXPECT_EQ(slot.uv_set, 1);
    const auto map = [&](float u, float v) { return std::pair{slot.m00 * u + slot.m01 * v + slot.m02, slot.m10 * u + slot.m11 * v + slot.m12}; };
    // v grows downward, so a quarter turn counter-clockwise takes +u to the top, -v.
    EXPECT_NEAR(map(1, 0).first, 0.25, 1e-6);
    EXPECT_NEAR(map(1, 0).second, 0.5 - 2, 1e-6);
    EXPECT_NEAR(map(0, 1).first, 0.25 + 3, 1e-6);
    EXPECT_NEAR(map(0, 1).second, 0.5, 1e-6);
}

TEST(Textures, AreOnePerImageColourSpaceAndSampler) {
    Textured file;
    file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}, {{"wrapS", 10497}}};
    file.json["images"].push_back({{"uri", png_uri()}});  // the same bytes
    file.json["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 0}, {"sampler", 0}}, {{"source", 0}, {"sampler", 1}}};
    file.material()["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}};
    file.material()["emissiveTexture"] = {{"index", 2}};
    file.material()["occlusionTexture"] = {{"index", 3}};
    const Scene scene = file.load();
    ASSERT_THAT(scene.textures, SizeIs(3)) << "colour, data, and colour with its own sampler";
    const kernels::Material& m = scene.materials.at(0);
    EXPECT_EQ(m.metallic_roughness_texture.texture, m.occlusion_texture.texture) << "a sampler of defaults is none";
    const TextureData& color = scene.textures.at(static_cast<std::size_t>(m.base_color_texture.texture));
    EXPECT_EQ(color.format, TexelFormat::rgba8_srgb);
    EXPECT_EQ(color.width, 2);
    EXPECT_EQ(color.texels, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 0, 255, 255}));
    EXPECT_EQ(scene.textures.at(static_cast<std::size_t>(m.metallic_roughness_texture.texture)).format, TexelFormat::rgba8_linear);
    const TextureData& emissive = scene.textures.at(static_cast<std::size_t>(m.emissive_texture.texture));
    EXPECT_EQ(emissive.wrap_s, Wrap::clamp_to_edge);
    EXPECT_EQ(emissive.wrap_t, Wrap::mirrored_repeat);
    EXPECT_TRUE(emissive.nearest);
}

TEST(Textures, OfUnusedMaterialsAreNotRead) {
    Textured file;
    file.json["images"].push_back({{"uri", "gone.png"}});
    file.json["textures"].push_back({{"source", 1}});
    file.json["materials"].push_back({{"emissiveTexture", {{"index", 1}}}});
    EXPECT_THAT(file.load().textures, SizeIs(1));
}

TEST(Textures, AreOnlyLookedAtForChecks) {
    Textured file;
    const Scene scene = file.load(LoadOptions{false});
    ASSERT_THAT(scene.textures, SizeIs(1));
    EXPECT_EQ(scene.textures[0].width, 2);
    EXPECT_THAT(scene.textures[0].texels, IsEmpty());
    EXPECT_EQ(scene.files.at(0).content, file.load().files.at(0).content);
}

TEST(Textures, ThatCannotBeUsedAreNamed) {
    Textured file;
    const auto with = [&](const nlohmann::json& image) {
        file.json["images"] = {image};
        return file.error();
    };
    EXPECT_EQ(with({{"uri", "gone.png"}}), "scene.gltf: error: /images/0/uri is \"gone.png\": there is no such file\n  expected a readable file next to the asset");
    file.save_text("x.webp", std::string("RIFF\x10\0\0\0WEBPVP8 ", 16));
    EXPECT_EQ(with({{"uri", "x.webp"}}), "scene.gltf: error: /images/0 (x.webp) is a WebP image\n  expected PNG or JPEG; convert the image");
    std::string huge = png();
    huge[16] = 0x7F;
    file.save_text("huge.png", huge);
    EXPECT_EQ(with({{"uri", "huge.png"}}), "scene.gltf: error: /images/0 (huge.png) has 2130706434 x 1 pixels\n  expected 1 to 32768 a side and at most 2^28 in all");
    file.save_text("cut.png", png().substr(0, 45));
    EXPECT_EQ(with({{"uri", "cut.png"}}), "scene.gltf: error: /images/0 (cut.png) cannot be decoded\n  the image is damaged; save it anew as PNG or baseline JPEG");
}

TEST(Textures, WithoutImageAreLeftOutOrRefused) {
    Textured file;
    file.json["textures"] = {nlohmann::json::object()};
    const Scene scene = file.load();
    EXPECT_EQ(scene.materials.at(0).base_color_texture.texture, -1);
    EXPECT_EQ(scene.warnings.at(0).found, "/textures/0 names no image (source); the texture is left out");
    file.json["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
    EXPECT_THAT(file.error(), HasSubstr("/textures/0 has its image only in KHR_texture_basisu, which is not supported yet"));
}

TEST(NormalTextures, NeedCoordinatesAndGiveTangents) {
    Textured file;
    file.material()["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
    const Scene with = file.load();
    EXPECT_THAT(with.geometries.at(0).tangents, SizeIs(3));
    EXPECT_FLOAT_EQ(with.materials.at(0).normal_scale, 0.5f);
    file.json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
    const Scene without = file.load();
    EXPECT_THAT(without.geometries.at(0).tangents, IsEmpty());
    EXPECT_EQ(without.materials.at(0).normal_texture.texture, -1);
    EXPECT_EQ(without.warnings.at(0).found, "/meshes/0/primitives/0 has no TEXCOORD_0; the normal texture of material 0 is left out");
}

TEST(NormalTextures, AreWhatTangentsAreKeptFor) {
    Textured file;
    auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["NORMAL"] = file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    attributes["TANGENT"] = file.floats({0, 2, 0, -1, 0, 2, 0, -1, 0, 2, 0, -1}, "VEC4");
    EXPECT_THAT(file.load().geometries.at(0).tangents, IsEmpty());
    file.material()["normalTexture"] = {{"index", 0}};
    const Scene scene = file.load();
    ASSERT_THAT(scene.geometries.at(0).tangents, SizeIs(3));
    EXPECT_FLOAT_EQ(scene.geometries[0].tangents[0].y, 1);
    EXPECT_EQ(scene.geometries[0].tangents[0].w, -1);
}

TEST(Lights, AndCamerasHangOnNodes) {
    GltfBuilder file;
    file.triangle();
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = nlohmann::json::parse(R"([
        {"type": "spot", "name": "lamp", "color": [1, 0.5, 0], "intensity": 40, "range": 9, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}},
        {"type": "directional"}])");
    file.json["cameras"] = nlohmann::json::parse(R"([
        {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "aspectRatio": 1.5}},
        {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 3, "znear": 0, "zfar": 10}}])");
    file.json["nodes"] = nlohmann::json::parse(R"([{"extensions": {"KHR_lights_punctual": {"light": 0}}}, {"camera": 1}])");
    file.json["scenes"][0]["nodes"] = {0, 1};
    const auto path = file.save_gltf();
    const Scene scene = load_scene({{"a", path, {}}});
    EXPECT_EQ(scene.nodes.at(0).light, 0);
    EXPECT_EQ(scene.nodes.at(1).camera, 1);
    const SceneLight& lamp = scene.lights.at(0);
    EXPECT_EQ(lamp.kind, kernels::LightKind::spot);
    EXPECT_EQ(lamp.name, "lamp");
    EXPECT_EQ(lamp.color, glm::dvec3(1, 0.5, 0));
    EXPECT_EQ(lamp.intensity, 40);
    EXPECT_EQ(lamp.range_m, 9);
    EXPECT_DOUBLE_EQ(lamp.inner_rad, 0.1);
    EXPECT_DOUBLE_EQ(lamp.outer_rad, 0.2);
    EXPECT_EQ(scene.lights.at(1).kind, kernels::LightKind::directional);
    EXPECT_FALSE(scene.cameras.at(0).orthographic);
    EXPECT_DOUBLE_EQ(scene.cameras[0].yfov_rad, 0.7);
    EXPECT_DOUBLE_EQ(scene.cameras[0].aspect, 1.5);
    EXPECT_EQ(scene.cameras[0].zfar, 0);
    EXPECT_TRUE(scene.cameras.at(1).orthographic);
    EXPECT_EQ(scene.cameras[1].ymag, 3);
}

TEST(Nodes, HaveMatricesOrParts) {
    GltfBuilder file;
    file.triangle();
    file.json["nodes"] = nlohmann::json::parse(R"([
        {"translation": [1, 2, 3], "rotation": [0, 0, 2, 0], "scale": [-1, 1, 1], "children": [1]},
        {"matrix": [1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 4, 5, 6, 1]}])");
    const Scene scene = file.load();
    EXPECT_EQ(scene.nodes.at(0).translation, glm::dvec3(1, 2, 3));
    EXPECT_EQ(scene.nodes[0].rotation, glm::dquat(0, 0, 0, 1)) << "w x y z, unit length";
    EXPECT_EQ(scene.nodes[0].scale.x, -1);
    EXPECT_FALSE(scene.nodes[0].matrix);
    EXPECT_EQ(scene.nodes.at(1).parent, 0);
    ASSERT_TRUE(scene.nodes[1].matrix);
    EXPECT_EQ((*scene.nodes[1].matrix)[3], glm::dvec4(4, 5, 6, 1));
}

struct Animated : GltfBuilder {
    explicit Animated(const char* interpolation, const char* path, int output) {
        triangle();
        (void)output;
        json["animations"] = {{{"name", "clip"}, {"samplers", {{{"input", 0}, {"output", 0}, {"interpolation", interpolation}}}},
                               {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
    }
    void data(int input, int output) {
        json["animations"][0]["samplers"][0]["input"] = input;
        json["animations"][0]["samplers"][0]["output"] = output;
    }
};

TEST(Animations, ReadLinearAndStepKeys) {
    Animated file("STEP", "translation", 0);
    file.data(file.floats({0.5, 2}, "SCALAR"), file.floats({1, 2, 3, 4, 5, 6}, "VEC3"));
    const Scene scene = file.load();
    const Clip& clip = scene.clips.at(0);
    EXPECT_EQ(clip.name, "clip");
    EXPECT_EQ(clip.begin_s, 0.5);
    EXPECT_EQ(clip.end_s, 2);
    const auto& track = clip.channels.at(0).translation;
    ASSERT_TRUE(track);
    EXPECT_EQ(track->interpolation, Interpolation::step);
    EXPECT_EQ(track->keys.at(1).time_s, 2);
    EXPECT_EQ(track->keys[1].value, glm::dvec3(4, 5, 6));
}

TEST(Animations, ReadCubicTangents) {
    Animated file("CUBICSPLINE", "scale", 0);
    file.data(file.floats({0, 1}, "SCALAR"), file.floats({1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5, 6, 6, 6}, "VEC3"));
    const auto track = file.load().clips.at(0).channels.at(0).scale;
    ASSERT_TRUE(track);
    EXPECT_EQ(track->interpolation, Interpolation::cubic);
    EXPECT_EQ(track->keys.at(0).in_tangent.x, 1);
    EXPECT_EQ(track->keys[0].value.x, 2);
    EXPECT_EQ(track->keys[0].out_tangent.x, 3);
    EXPECT_EQ(track->keys.at(1).value.x, 5);
}

TEST(Animations, ReadRotationsOfNormalisedIntegers) {
    Animated file("LINEAR", "rotation", 0);
    file.data(file.floats({0, 1}, "SCALAR"), file.accessor(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 32767, 0, 0}, "VEC4", 5122, 2, true));
    const auto track = file.load().clips.at(0).channels.at(0).rotation;
    ASSERT_TRUE(track);
    EXPECT_EQ(track->keys.at(0).value, glm::dquat(1, 0, 0, 0));
    EXPECT_EQ(track->keys.at(1).value, glm::dquat(0, 0, 1, 0));
}

TEST(Animations, ThatPointIntoExtensionsGiveOneWarning) {
    Animated file("LINEAR", "pointer", 0);
    nlohmann::json& channels = file.json["animations"][0]["channels"];
    channels[0]["target"].erase("node");
    channels.push_back(channels[0]);
    channels[0]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = "/materials/0/extensions/KHR_materials_sheen/sheenRoughnessFactor";
    channels[1]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = "/nodes/0/name";
    const Scene scene = file.load();
    ASSERT_THAT(scene.warnings, SizeIs(1));
    EXPECT_EQ(scene.warnings[0].found, "/animations point to /materials/0/extensions/KHR_materials_sheen/sheenRoughnessFactor, /nodes/0/name, which Kadr does not animate");
}

TEST(Animations, ThatMakeNoSenseAreRefused) {
    const auto error = [](const char* interpolation, const std::vector<float>& times, const std::vector<float>& values) {
        Animated file(interpolation, "translation", 0);
        file.data(file.floats(times, "SCALAR"), file.floats(values, "VEC3"));
        return file.error();
    };
    EXPECT_EQ(error("LINEAR", {0, 1, 1}, {1, 2, 3, 4, 5, 6, 7, 8, 9}),
              "scene.gltf: error: /animations/0/samplers/0/input element 2 is 1 s after 1 s\n  expected strictly increasing times");
    EXPECT_EQ(error("CUBICSPLINE", {0, 1}, {1, 2, 3, 4, 5, 6}), "scene.gltf: error: /animations/0/samplers/0/output has 2 elements for 2 times\n  expected 6");
}

}  // namespace
}  // namespace kadr
