#include "extremes/full_scene.h"

namespace kadr::test {

namespace {

using Json = nlohmann::json;

constexpr int kUnsignedShort = 5123;

/// One white pixel, PNG.
constexpr unsigned char kPixel[] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0, 0x3a, 0x7e, 0x9b, 0x55,
                                    0, 0, 0, 10, 'I', 'D', 'A', 'T', 0x78, 0x9c, 0x63, 0x68, 0, 0, 0, 0x82, 0, 0x81, 0x77, 0xcd, 0x72, 0xb6, 0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};

/// A square of two triangles with every attribute.
Json square(GltfBuilder& file, bool rich) {
    Json attributes = {{"POSITION", file.floats({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3")}};
    if (rich) {
        attributes["NORMAL"] = file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        attributes["TANGENT"] = file.floats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4");
        attributes["TEXCOORD_0"] = file.floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2");
        attributes["COLOR_0"] = file.floats({1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, "VEC4");
    }
    const int indices = file.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR", kUnsignedShort, 6);
    return {{"attributes", attributes}, {"indices", indices}};
}

Json textured_square(GltfBuilder& file) {
    Json primitive = square(file, true);
    primitive["material"] = 0;
    return primitive;
}

Json skinned_square(GltfBuilder& file) {
    Json primitive = square(file, false);
    primitive["attributes"]["JOINTS_0"] = file.accessor(std::vector<std::uint16_t>{0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", kUnsignedShort, 4);
    primitive["attributes"]["WEIGHTS_0"] = file.floats({0.75f, 0.25f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4");
    return primitive;
}

Json morphing_square(GltfBuilder& file) {
    Json primitive = square(file, false);
    for (const float height : {0.2f, 0.4f})
        primitive["targets"].push_back({{"POSITION", file.floats({0, 0, height, 0, 0, 0, 0, 0, height, 0, 0, 0}, "VEC3")}});
    return primitive;
}

void add_meshes(GltfBuilder& file) {
    file.json["meshes"] = {{{"name", "square"}, {"primitives", {textured_square(file)}}},
                           {{"name", "cloth"}, {"primitives", {skinned_square(file)}}},
                           {{"name", "morph"}, {"primitives", {morphing_square(file)}}, {"weights", {0.25, 0.5}}}};
}

void add_nodes(GltfBuilder& file) {
    file.json["nodes"] = Json::parse(R"([
        {"name": "Root", "children": [1, 2, 3, 5, 6, 7, 8, 9], "translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]},
        {"name": "Square", "mesh": 0, "translation": [-1, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]},
        {"name": "Cloth", "mesh": 1, "skin": 0},
        {"name": "Hip", "children": [4], "translation": [1, 0, 0]},
        {"name": "Knee", "translation": [0, 0.5, 0]},
        {"name": "Morph", "mesh": 2, "translation": [0, 1, -1], "weights": [0.1, 0.2]},
        {"name": "Camera", "camera": 0, "translation": [0, 0, 6]},
        {"name": "Lamp", "translation": [0, 1, 4], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"name": "Crowd", "mesh": 0},
        {"name": "Matrix", "mesh": 0, "matrix": [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 2, 0, -1, 1]}])");
    file.json["nodes"][8]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", file.floats({-2, -1, -2, 2, -1, -2}, "VEC3")}, {"ROTATION", file.floats({0, 0, 0, 1, 0, 0, 0, 1}, "VEC4")}, {"SCALE", file.floats({1, 1, 1, 0.5f, 0.5f, 0.5f}, "VEC3")}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    file.json["skins"] = {{{"joints", {3, 4}}, {"inverseBindMatrices", file.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5f, 0, 1}, "MAT4")}}};
    file.json["accessors"].back()["count"] = 2;
}

void add_appearance(GltfBuilder& file) {
    file.json.merge_patch(Json::parse(R"({
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_emissive_strength", "EXT_mesh_gpu_instancing", "KHR_animation_pointer"],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "zfar": 100, "aspectRatio": 1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "spot", "color": [1, 0.9, 0.8], "intensity": 20, "range": 50, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}}]}},
        "materials": [{"name": "Paint", "alphaMode": "MASK", "alphaCutoff": 0.5, "emissiveFactor": [0.1, 0.2, 0.3],
            "emissiveTexture": {"index": 0},
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}},
            "normalTexture": {"index": 0, "scale": 0.5}, "occlusionTexture": {"index": 0, "strength": 0.5},
            "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.7, 0.6, 1], "metallicFactor": 0.25, "roughnessFactor": 0.5,
                "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"offset": [0.1, 0.2], "rotation": 0.3, "scale": [2, 3], "texCoord": 0}}}}}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 10497, "magFilter": 9729, "minFilter": 9987}],
        "images": [{"mimeType": "image/png", "bufferView": 0}]})"));
    file.json["images"][0]["bufferView"] = file.view(std::string_view(reinterpret_cast<const char*>(kPixel), sizeof kPixel));
}

class Clip {
public:
    explicit Clip(GltfBuilder& file) : file_(file), times_(file.floats({0, 1}, "SCALAR")) {}

    void add(Json target, const std::vector<float>& values, const char* type, const char* interpolation = "LINEAR") {
        samplers_.push_back({{"input", times_}, {"output", file_.floats(values, type)}, {"interpolation", interpolation}});
        channels_.push_back({{"sampler", samplers_.size() - 1}, {"target", std::move(target)}});
    }
    void point(const char* pointer, const std::vector<float>& values, const char* type) {
        add({{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}, values, type);
    }
    void save() { file_.json["animations"] = {{{"name", "all"}, {"samplers", samplers_}, {"channels", channels_}}}; }

private:
    GltfBuilder& file_;
    int times_;
    Json samplers_ = Json::array(), channels_ = Json::array();
};

void add_clip(GltfBuilder& file) {
    Clip clip(file);
    clip.add({{"node", 1}, {"path", "translation"}}, {-1, 0, 0, -1.5f, 0, 0}, "VEC3");
    clip.add({{"node", 1}, {"path", "rotation"}}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.6f, 0, 0.8f, 0, 0, 0, 0}, "VEC4", "CUBICSPLINE");
    clip.add({{"node", 4}, {"path", "rotation"}}, {0, 0, 0, 1, 0, 0.6f, 0, 0.8f}, "VEC4");
    clip.add({{"node", 1}, {"path", "scale"}}, {1, 1, 1, 1.5f, 1, 1}, "VEC3");
    clip.add({{"node", 5}, {"path", "weights"}}, {0, 0, 1, 0.5f}, "SCALAR");
    clip.point("/materials/0/pbrMetallicRoughness/roughnessFactor", {0.25f, 0.75f}, "SCALAR");
    clip.point("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset", {0, 0, 1, 0.5f}, "VEC2");
    clip.point("/materials/0/emissiveFactor", {0, 0, 0, 0.5f, 0.5f, 0.5f}, "VEC3");
    clip.point("/extensions/KHR_lights_punctual/lights/0/intensity", {20, 40}, "SCALAR");
    clip.point("/extensions/KHR_lights_punctual/lights/0/range", {50, 60}, "SCALAR");
    clip.point("/cameras/0/perspective/yfov", {0.7f, 0.8f}, "SCALAR");
    clip.save();
}

}  // namespace

void fill_with_everything(GltfBuilder& file) {
    add_meshes(file);
    add_nodes(file);
    add_appearance(file);
    add_clip(file);
}

}  // namespace kadr::test
