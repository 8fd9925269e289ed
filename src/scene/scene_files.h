#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "scene/scene.h"
#include "scene/scene_needs.h"

namespace kadr {

/// The glTF files of a shot, opened: first their trees are read, which say what there is, then what is needed of it.
class SceneFiles {
public:
    /// Two requests for the same file share geometries, materials and textures.
    /// @throws InputError  naming the file and the JSON pointer ("/meshes/0/primitives/1/indices")
    explicit SceneFiles(const std::vector<SceneFileRequest>& requests);
    ~SceneFiles();
    SceneFiles(const SceneFiles&) = delete;
    SceneFiles& operator=(const SceneFiles&) = delete;

    const SceneOutline& outline() const { return outline_; }
    /// The scene with what is needed; primitives whose geometry is not are gone, as are textures that are not. Once.
    /// @throws InputError
    Scene load(const SceneNeeds& needs, const LoadOptions& options = {}) &&;

private:
    struct Part;  ///< a file and where its tables begin
    struct Entry {
        std::size_t part = 0;        ///< into parts_
        std::size_t first_skin = 0;  ///< into the scene's
    };

    SceneOutline outline_;
    std::vector<std::unique_ptr<Part>> parts_;
    std::vector<Entry> entries_;     ///< [request]
};

}  // namespace kadr
