#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace kadr {

/// A folder that is there as long as the test.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "kadr-test-XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

inline void write_text(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

/// One triangle, 2 m wide.
inline const char* triangle_gltf() {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"Triangle","mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"}]})";
}

/// Writes triangle.gltf and tiny.yaml, 12 x 8 pixels, 4 frames that all differ (it grows lighter), into a folder.
/// @return the shot file
inline std::filesystem::path write_tiny_shot(const std::filesystem::path& folder, const std::string& output) {
    write_text(folder / "triangle.gltf", triangle_gltf());
    write_text(folder / "tiny.yaml",
               "kadr: 1\nname: tiny\ntiming: { fps: 24, frames: 0-3 }\nimage: { size: [12, 8] }\n"
               "scenes:\n  - { id: triangle, gltf: triangle.gltf }\n"
               "camera: { position: [0, 0, 4], look_at: [0, 0, 0] }\n"
               "environment: { color: [1, 1, 1], strength: { keys: { 0 f: 1, 100 f: 2 } } }\n"
               "render: { samples: 4 }\noutput:\n" + output);
    return folder / "tiny.yaml";
}

}  // namespace kadr
