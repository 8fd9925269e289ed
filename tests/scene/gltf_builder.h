#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "scene/scene.h"

namespace kadr::test {

std::string base64(std::string_view bytes);

/// Writes small glTF files. `json` may be changed freely before it is saved.
class GltfBuilder {
public:
    GltfBuilder();
    ~GltfBuilder();  ///< removes the folder
    GltfBuilder(const GltfBuilder&) = delete;

    /// Appends bytes (aligned to four) as a buffer view. @return its index
    int view(std::string_view bytes, int stride = 0);
    template <class T>
    int view(const std::vector<T>& values, int stride = 0) {
        return view(std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)), stride);
    }
    /// An accessor over a whole new view.
    template <class T>
    int accessor(const std::vector<T>& values, const std::string& type, int component_type, std::size_t count, bool normalized = false) {
        return accessor_of(view(values), type, component_type, count, normalized);
    }
    int accessor_of(int buffer_view, const std::string& type, int component_type, std::size_t count, bool normalized = false);
    int floats(const std::vector<float>& values, const std::string& type);

    /// A primitive of the only mesh, which node 0 shows.
    nlohmann::json& primitive(int position, int indices = -1, int mode = -1);
    /// The unit triangle as positions (0,0,0) (1,0,0) (0,1,0).
    nlohmann::json& triangle();

    std::filesystem::path folder() const { return folder_; }
    std::filesystem::path save_gltf(const std::string& name = "scene.gltf");
    std::filesystem::path save_glb(const std::string& name = "scene.glb");
    std::filesystem::path save_text(const std::string& name, std::string_view text) const;

    Scene load(const LoadOptions& options = {}) { return load_scene({{"scene", save_gltf(), {}}}, options); }
    /// The message of the InputError, with the folder taken out; "(loads)" when there is none.
    std::string error();
    std::string error_of(const std::filesystem::path& path) const;

    nlohmann::json json;

private:
    std::filesystem::path folder_;
    std::string bytes_;
};

}  // namespace kadr::test
