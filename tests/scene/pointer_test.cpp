// KHR_animation_pointer.
#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace kadr::test {
namespace {

using Json = nlohmann::json;

/// A file with one of everything that can be pointed to, and one animation.
struct PointerFile : GltfBuilder {
    PointerFile() {
        triangle()["material"] = 0;
        json["materials"] = {{{"name", "Paint"}}};
        json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}},
                           {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0}, {"zfar", 10}}}}};
        json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}}}}};
        json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_animation_pointer"};
        json["animations"] = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
    }
    void point(const std::string& pointer, int output, const char* interpolation = "LINEAR") {
        auto& animation = json["animations"][0];
        animation["channels"].push_back({{"sampler", animation["samplers"].size()},
                                         {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
        animation["samplers"].push_back({{"input", floats({0, 2}, "SCALAR")}, {"output", output}, {"interpolation", interpolation}});
    }
};

/// The only property that a clip drives with a pointer of so many components.
PropertyChannel channel_of(const std::string& pointer, int components) {
    PointerFile file;
    std::vector<float> values;
    for (int i = 0; i < 2 * components; ++i) values.push_back(static_cast<float>(i) / 8);
    file.point(pointer, file.floats(values, components == 1 ? "SCALAR" : "VEC" + std::to_string(components)));
    const Scene scene = file.load();
    EXPECT_TRUE(scene.warnings.empty()) << pointer;
    EXPECT_EQ(scene.clips.at(0).end_s, 2);
    EXPECT_EQ(scene.clips.at(0).properties.size(), components == 4 ? 2u : 1u) << pointer;
    return scene.clips.at(0).properties.at(0);
}

TEST(Pointers, NameProperties) {
    struct Case {
        const char* pointer;
        Property property;
        int index;
    };
    const Case cases[] = {
        {"/materials/0/pbrMetallicRoughness/metallicFactor", Property::metallic, 0},
        {"/materials/0/pbrMetallicRoughness/roughnessFactor", Property::roughness, 0},
        {"/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", Property::emissive_strength, 0},
        {"/materials/0/extensions/KHR_materials_ior/ior", Property::ior, 0},
        {"/materials/0/alphaCutoff", Property::alpha_cutoff, 0},
        {"/materials/0/normalTexture/scale", Property::normal_scale, 0},
        {"/materials/0/occlusionTexture/strength", Property::occlusion_strength, 0},
        {"/materials/0/normalTexture/extensions/KHR_texture_transform/rotation", Property::texture_rotation, 0},
        {"/extensions/KHR_lights_punctual/lights/0/intensity", Property::light_intensity, 0},
        {"/extensions/KHR_lights_punctual/lights/0/range", Property::light_range, 0},
        {"/extensions/KHR_lights_punctual/lights/0/spot/innerConeAngle", Property::light_inner, 0},
        {"/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", Property::light_outer, 0},
        {"/cameras/0/perspective/yfov", Property::camera_yfov, 0},
        {"/cameras/0/perspective/znear", Property::camera_znear, 0},
        {"/cameras/0/perspective/zfar", Property::camera_zfar, 0},
        {"/cameras/1/orthographic/xmag", Property::camera_xmag, 1},
        {"/cameras/1/orthographic/ymag", Property::camera_ymag, 1},
        {"/cameras/1/orthographic/znear", Property::camera_znear, 1},
        {"/cameras/1/orthographic/zfar", Property::camera_zfar, 1},
    };
    for (const Case& one : cases) {
        const PropertyChannel channel = channel_of(one.pointer, 1);
        EXPECT_EQ(channel.property, one.property) << one.pointer;
        EXPECT_EQ(channel.index, one.index) << one.pointer;
        EXPECT_EQ(evaluate(std::get<Track<double>>(channel.track), 1), 0.0625) << one.pointer;  // 0 to 1/8 in 2 s
    }
}

TEST(Pointers, NamePairsAndColours) {
    const PropertyChannel offset = channel_of("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset", 2);
    EXPECT_EQ(offset.property, Property::texture_offset);
    EXPECT_EQ(offset.use, TextureUse::base_color);
    EXPECT_EQ(evaluate(std::get<Track<glm::dvec2>>(offset.track), 2), glm::dvec2(0.25, 0.375));
    EXPECT_EQ(channel_of("/materials/0/emissiveTexture/extensions/KHR_texture_transform/scale", 2).use, TextureUse::emissive);
    EXPECT_EQ(channel_of("/materials/0/occlusionTexture/extensions/KHR_texture_transform/scale", 2).use, TextureUse::occlusion);
    EXPECT_EQ(channel_of("/materials/0/pbrMetallicRoughness/metallicRoughnessTexture/extensions/KHR_texture_transform/scale", 2).use, TextureUse::metallic_roughness);
    EXPECT_EQ(evaluate(std::get<Track<glm::dvec3>>(channel_of("/materials/0/emissiveFactor", 3).track), 2), glm::dvec3(0.375, 0.5, 0.625));
    EXPECT_EQ(channel_of("/extensions/KHR_lights_punctual/lights/0/color", 3).property, Property::light_color);
}

TEST(Pointers, ToABaseColourDriveColourAndAlpha) {
    PointerFile file;
    file.point("/materials/0/pbrMetallicRoughness/baseColorFactor", file.floats({1, 0, 0, 1, 0, 0, 1, 0.5f}, "VEC4"));
    const Clip clip = file.load().clips.at(0);
    ASSERT_EQ(clip.properties.size(), 2u);
    EXPECT_EQ(clip.properties[1].property, Property::alpha);
    EXPECT_EQ(evaluate(std::get<Track<glm::dvec3>>(clip.properties[0].track), 1), glm::dvec3(0.5, 0, 0.5));
    EXPECT_EQ(evaluate(std::get<Track<double>>(clip.properties[1].track), 1), 0.75);
}

TEST(Pointers, OfCubicSplinesHaveTheirTangents) {
    PointerFile file;
    file.point("/materials/0/pbrMetallicRoughness/baseColorFactor",
               file.floats({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24}, "VEC4"), "CUBICSPLINE");
    const Clip clip = file.load().clips.at(0);
    const auto& colour = std::get<Track<glm::dvec3>>(clip.properties.at(0).track);
    const auto& alpha = std::get<Track<double>>(clip.properties.at(1).track);
    EXPECT_EQ(colour.keys.at(0).value, glm::dvec3(5, 6, 7));
    EXPECT_EQ(colour.keys.at(1).in_tangent, glm::dvec3(13, 14, 15));
    EXPECT_EQ(alpha.keys.at(0).in_tangent, 4);
    EXPECT_EQ(alpha.keys.at(1).value, 20);
    EXPECT_EQ(alpha.keys.at(1).out_tangent, 24);
}

TEST(Pointers, ToNodesAreTheirChannels) {
    PointerFile file;
    file.point("/nodes/0/translation", file.floats({0, 0, 0, 2, 4, 6}, "VEC3"));
    file.point("/nodes/0/rotation", file.floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4"));
    file.point("/nodes/0/scale", file.floats({1, 1, 1, 3, 3, 3}, "VEC3"));
    const Clip clip = file.load().clips.at(0);
    ASSERT_EQ(clip.channels.size(), 1u);
    EXPECT_EQ(clip.channels[0].node, 0);
    EXPECT_EQ(evaluate(*clip.channels[0].translation, 1), glm::dvec3(1, 2, 3));
    EXPECT_EQ(evaluate(*clip.channels[0].scale, 1), glm::dvec3(2));
    EXPECT_TRUE(clip.channels[0].rotation);
    EXPECT_TRUE(clip.properties.empty());
}

TEST(Pointers, ToVisibilityAreSteps) {
    PointerFile file;
    file.point("/nodes/0/extensions/KHR_node_visibility/visible", file.accessor(std::vector<std::uint8_t>{1, 0}, "SCALAR", 5121, 2), "STEP");
    const PropertyChannel channel = file.load().clips.at(0).properties.at(0);
    EXPECT_EQ(channel.property, Property::node_visible);
    const auto& track = std::get<Track<double>>(channel.track);
    EXPECT_EQ(evaluate(track, 1.99), 1);
    EXPECT_EQ(evaluate(track, 2), 0);
}

TEST(Pointers, OfASecondFileCountFromItsTables) {
    PointerFile a, b;
    b.point("/extensions/KHR_lights_punctual/lights/0/intensity", b.floats({0, 1}, "SCALAR"));
    b.point("/nodes/0/extensions/KHR_node_visibility/visible", b.accessor(std::vector<std::uint8_t>{1, 0}, "SCALAR", 5121, 2), "STEP");
    b.point("/materials/0/alphaCutoff", b.floats({0, 1}, "SCALAR"));
    const Scene scene = load_scene({{"a", a.save_gltf(), {}}, {"b", b.save_gltf(), {}}});
    const Clip& clip = scene.clips.at(1);
    EXPECT_EQ(clip.properties.at(0).index, 1);
    EXPECT_EQ(clip.properties.at(1).index, 1);
    EXPECT_EQ(clip.properties.at(2).index, 0);  // as the file numbers it
}

TEST(Pointers, ThatMakeNoSenseAreRefused) {
    const std::string where = "scene.gltf: error: /animations/0/channels/0/target/extensions/KHR_animation_pointer/pointer ";
    const auto error_of = [](const std::string& pointer) {
        PointerFile file;
        file.point(pointer, file.floats({0, 1}, "SCALAR"));
        return file.error();
    };
    EXPECT_EQ(error_of("/materials/3/alphaCutoff"), where + "is \"/materials/3/alphaCutoff\"\n  expected an index into /materials: 0 to 0");
    EXPECT_EQ(error_of("/nodes/9/scale"), where + "is \"/nodes/9/scale\"\n  expected an index into /nodes: 0 to 0");
    EXPECT_EQ(error_of("materials/0/alphaCutoff"), where + "is \"materials/0/alphaCutoff\"\n  expected a JSON pointer such as /materials/0/emissiveFactor");
    EXPECT_EQ(error_of("/materials/0/emissiveFactor"), "scene.gltf: error: /animations/0/samplers/0/output is SCALAR of float\n"
                                                       "  expected VEC3 of float or of normalized integers");
    PointerFile twice;
    twice.point("/materials/0/alphaCutoff", twice.floats({0, 1}, "SCALAR"));
    twice.point("/materials/0/alphaCutoff", twice.floats({0, 1}, "SCALAR"));
    EXPECT_EQ(twice.error(), "scene.gltf: error: /animations/0/channels/1/target animates /materials/0/alphaCutoff again\n  expected one channel for each property");
    PointerFile linear;
    linear.point("/nodes/0/extensions/KHR_node_visibility/visible", linear.accessor(std::vector<std::uint8_t>{1, 0}, "SCALAR", 5121, 2));
    EXPECT_EQ(linear.error(), "scene.gltf: error: /animations/0/samplers/0/interpolation is LINEAR\n  expected STEP: what is true or false only jumps");
    PointerFile bytes;
    bytes.point("/nodes/0/extensions/KHR_node_visibility/visible", bytes.floats({1, 0}, "SCALAR"), "STEP");
    EXPECT_EQ(bytes.error(), "scene.gltf: error: /animations/0/samplers/0/output is SCALAR of float\n  expected SCALAR of unsigned byte: 0 or 1");
    PointerFile missing;
    missing.point("", missing.floats({1, 0}, "SCALAR"));
    missing.json["animations"][0]["channels"][0]["target"].erase("extensions");
    EXPECT_EQ(missing.error(), where + "is missing\n  expected a JSON pointer: the channel's path is \"pointer\"");
}

TEST(Pointers, ToTheOtherKindOfCameraAreWarnedOf) {
    PointerFile file;
    file.point("/cameras/0/orthographic/xmag", file.floats({1, 2}, "SCALAR"));
    const Scene scene = file.load();
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].found, "/animations point to /cameras/0/orthographic/xmag, which Kadr does not animate");
    EXPECT_TRUE(scene.clips.at(0).properties.empty());
}

}  // namespace
}  // namespace kadr::test
