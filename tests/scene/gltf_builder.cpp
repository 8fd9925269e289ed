#include "gltf_builder.h"

#include <unistd.h>

#include <atomic>
#include <fstream>

namespace kadr::test {

namespace {

std::filesystem::path fresh_folder() {
    static std::atomic<int> count{0};
    const auto folder = std::filesystem::temp_directory_path() / ("kadr-scene-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(folder);
    return folder;
}

void append_word(std::string& to, std::size_t value) {
    for (int i = 0; i < 4; ++i) to += static_cast<char>(value >> (8 * i) & 0xFF);
}

}  // namespace

std::string base64(std::string_view bytes) {
    static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t j = 0; j < 3; ++j) word = word << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
        for (std::size_t j = 0; j < 4; ++j) text += i + j <= bytes.size() ? kLetters[word >> (18 - 6 * j) & 63] : '=';
    }
    return text;
}

GltfBuilder::GltfBuilder() : folder_(fresh_folder()) {
    json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}, {"nodes", {{{"name", "root"}, {"mesh", 0}}}},
            {"meshes", {{{"name", "mesh"}, {"primitives", nlohmann::json::array()}}}}};
}

GltfBuilder::~GltfBuilder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

int GltfBuilder::view(std::string_view bytes, int stride) {
    while (bytes_.size() % 4) bytes_ += '\0';
    nlohmann::json item = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
    if (stride) item["byteStride"] = stride;
    bytes_ += bytes;
    json["bufferViews"].push_back(std::move(item));
    return static_cast<int>(json["bufferViews"].size()) - 1;
}

int GltfBuilder::accessor_of(int buffer_view, const std::string& type, int component_type, std::size_t count, bool normalized) {
    nlohmann::json item = {{"type", type}, {"componentType", component_type}, {"count", count}};
    if (buffer_view >= 0) item["bufferView"] = buffer_view;
    if (normalized) item["normalized"] = true;
    json["accessors"].push_back(std::move(item));
    return static_cast<int>(json["accessors"].size()) - 1;
}

int GltfBuilder::floats(const std::vector<float>& values, const std::string& type) {
    const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
    return accessor(values, type, 5126, values.size() / components);
}

nlohmann::json& GltfBuilder::primitive(int position, int indices, int mode) {
    nlohmann::json item = {{"attributes", {{"POSITION", position}}}};
    if (indices >= 0) item["indices"] = indices;
    if (mode >= 0) item["mode"] = mode;
    auto& primitives = json["meshes"][0]["primitives"];
    primitives.push_back(std::move(item));
    return primitives.back();
}

nlohmann::json& GltfBuilder::triangle() { return primitive(floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")); }

std::filesystem::path GltfBuilder::save_text(const std::string& name, std::string_view text) const {
    const auto path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
}

std::filesystem::path GltfBuilder::save_gltf(const std::string& name) {
    if (!bytes_.empty() && !json.contains("buffers"))
        json["buffers"] = {{{"byteLength", bytes_.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes_)}}};
    return save_text(name, json.dump());
}

std::filesystem::path GltfBuilder::save_glb(const std::string& name) {
    nlohmann::json document = json;
    if (!bytes_.empty()) document["buffers"] = {{{"byteLength", bytes_.size()}}};
    std::string text = document.dump(), binary = bytes_;
    while (text.size() % 4) text += ' ';
    while (binary.size() % 4) binary += '\0';
    std::string file = "glTF";
    append_word(file, 2);
    append_word(file, 12 + 8 + text.size() + 8 + binary.size());
    append_word(file, text.size());
    file += "JSON" + text;
    append_word(file, binary.size());
    file += std::string("BIN\0", 4) + binary;
    return save_text(name, file);
}

std::string GltfBuilder::error_of(const std::filesystem::path& path) const {
    try {
        load_scene({{"scene", path, {}}});
    } catch (const InputError& error) {
        std::string text = error.what();
        const std::string prefix = folder_.string() + "/";
        for (std::size_t at; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
        return text;
    }
    return "(loads)";
}

std::string GltfBuilder::error() { return error_of(save_gltf()); }

}  // namespace kadr::test
