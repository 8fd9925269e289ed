#include "stress/gltf_file.h"

#include <algorithm>
#include <cstring>
#include <span>

#include <nlohmann/json.hpp>

#include "frame/view_axes.h"
#include "stress/file.h"

namespace kadr::stress {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126, kUnsignedInt = 5125;  // component types of glTF

Json json_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
Json json_of(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }

class Writer {
public:
    explicit Writer(const Stage& stage) : stage_(stage) {}

    Json document() {
        json_ = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
        json_["nodes"] = {{{"name", "Stage"}, {"translation", json_of(stage_.world.offset)}, {"scale", json_of(glm::dvec3(stage_.world.scale))}}};
        for (const Object& object : stage_.objects) add(object);
        if (stage_.camera.authored) add_camera();
        json_["buffers"] = {{{"uri", stage_.name + ".bin"}, {"byteLength", bytes_.size()}}};
        return std::move(json_);
    }
    const std::vector<unsigned char>& bytes() const { return bytes_; }

private:
    template <class T>
    int accessor(const std::vector<T>& values, const char* type, int component_type, std::size_t count) {
        const std::size_t size = values.size() * sizeof(T), at = bytes_.size();  // all parts are multiples of four bytes
        bytes_.resize(at + size);
        std::memcpy(bytes_.data() + at, values.data(), size);
        json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", size}});
        json_["accessors"].push_back({{"bufferView", json_["bufferViews"].size() - 1}, {"componentType", component_type}, {"count", count}, {"type", type}});
        return static_cast<int>(json_["accessors"].size()) - 1;
    }

    int vectors(const std::vector<glm::dvec3>& values) {
        std::vector<float> floats;
        for (const glm::dvec3& v : values)
            for (int c = 0; c < 3; ++c) floats.push_back(static_cast<float>(v[c]));
        return accessor(floats, "VEC3", kFloat, values.size());
    }

    /// glTF wants the bounds of positions, as the file's floats have them.
    void add_bounds(int positions) {
        Json& item = json_["accessors"][static_cast<std::size_t>(positions)];
        const std::size_t count = item["count"], at = json_["bufferViews"].back()["byteOffset"];
        std::vector<float> values(3 * count);
        std::memcpy(values.data(), bytes_.data() + at, values.size() * sizeof(float));
        for (std::size_t c = 0; c < 3; ++c) {
            float low = values[c], high = values[c];
            for (std::size_t i = c; i < values.size(); i += 3) low = std::min(low, values[i]), high = std::max(high, values[i]);
            item["min"].push_back(low);
            item["max"].push_back(high);
        }
    }

    int add_mesh(const Object& object) {
        std::vector<glm::dvec3> positions = object.mesh.positions;
        // The object's own scale comes after the vertices: the offset is one of the stage.
        for (glm::dvec3& p : positions) p = stage_.vertices.scale * p + glm::conjugate(object.rotate) * stage_.vertices.offset / object.scale;
        const int position = vectors(positions);
        add_bounds(position);
        const int normal = vectors(object.mesh.normals);
        const int indices = accessor(object.mesh.indices, "SCALAR", kUnsignedInt, object.mesh.indices.size());
        const Json primitive = {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", indices}, {"material", add_material(object.material)}};
        json_["meshes"].push_back({{"name", object.name}, {"primitives", Json::array({primitive})}});
        return static_cast<int>(json_["meshes"].size()) - 1;
    }

    int add_material(const Material& material) {
        const glm::dvec3& color = material.base_color;
        Json item = {{"pbrMetallicRoughness",
                      {{"baseColorFactor", {color.x, color.y, color.z, 1}}, {"metallicFactor", material.metallic}, {"roughnessFactor", material.roughness}}}};
        if (material.ior) {
            item["extensions"]["KHR_materials_ior"]["ior"] = *material.ior;
            require("KHR_materials_ior");
        }
        if (material.emission > 0) {
            item["emissiveFactor"] = {1, 1, 1};
            item["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = material.emission;
            require("KHR_materials_emissive_strength");
        }
        json_["materials"].push_back(std::move(item));
        return static_cast<int>(json_["materials"].size()) - 1;
    }

    void require(const char* extension) {
        Json& required = json_["extensionsRequired"];
        if (std::find(required.begin(), required.end(), extension) != required.end()) return;
        required.push_back(extension);
        json_["extensionsUsed"].push_back(extension);
    }

    void add(const Object& object) {
        if (object.copies && object.copies->empty()) return;
        Json node = {{"name", object.name}, {"mesh", add_mesh(object)}};
        node["translation"] = json_of(stage_.vertices.scale * object.translate);
        node["rotation"] = json_of(object.rotate);
        node["scale"] = json_of(object.scale);
        if (object.copies) {
            node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = vectors(*object.copies);
            require("EXT_mesh_gpu_instancing");
        }
        const std::size_t index = add_node(std::move(node));
        if (object.motion.in_clip) add_clip(object.motion, index);
    }

    std::size_t add_node(Json node) {
        const std::size_t index = json_["nodes"].size();
        json_["nodes"].push_back(std::move(node));
        json_["nodes"][0]["children"].push_back(index);
        return index;
    }

    void add_clip(const Motion& motion, std::size_t node) {
        add_channel("translation", "VEC3", motion.translate, node);
        add_channel("rotation", "VEC4", motion.rotate, node);
        add_channel("scale", "VEC3", motion.scale, node);
    }

    void add_channel(const char* path, const char* type, const std::vector<MotionKey>& keys, std::size_t node) {
        if (keys.empty()) return;
        std::vector<float> times, values;
        for (const MotionKey& key : keys) {
            times.push_back(static_cast<float>(key.time_s));
            for (const double value : key.value) values.push_back(static_cast<float>(value));
        }
        Json& clip = json_["animations"][0];
        const std::size_t sampler = clip["samplers"].size();
        const int input = accessor(times, "SCALAR", kFloat, times.size()), output = accessor(values, type, kFloat, keys.size());
        json_["accessors"][static_cast<std::size_t>(input)].update({{"min", {times.front()}}, {"max", {times.back()}}});
        clip["samplers"].push_back({{"input", input}, {"output", output}});
        clip["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
    }

    void add_camera() {
        const Camera& camera = stage_.camera;
        const glm::dvec3 position = stage_.vertices.of(camera.position), forward = glm::normalize(camera.look_at - camera.position);
        // znear is required and unused: rays begin at the camera.
        json_["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", glm::radians(camera.vertical_fov_deg)}, {"znear", 1e-3}}}}};
        add_node({{"name", "Camera"}, {"camera", 0}, {"translation", json_of(position)}, {"rotation", json_of(look_rotation(forward, {0, 1, 0}))}});
    }

    const Stage& stage_;
    Json json_;
    std::vector<unsigned char> bytes_;
};

}  // namespace

std::filesystem::path write_gltf(const Stage& stage, const std::filesystem::path& folder) {
    Writer writer(stage);
    const std::string text = writer.document().dump();
    const std::filesystem::path file = folder / (stage.name + ".gltf");
    write_file(folder / (stage.name + ".bin"), writer.bytes());
    write_file(file, text);
    return file;
}

}  // namespace kadr::stress
