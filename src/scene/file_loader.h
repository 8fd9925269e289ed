#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"
#include "scene/scene_needs.h"
#include "scene/texture_set.h"
#include "scene/variant_reader.h"

namespace kadr {

/// One file on its own: indices start at 0, nodes are those of the file.
class FileLoader {
public:
    /// @throws InputError
    FileLoader(const std::filesystem::path& path, const SourceLocation& asked_from);

    /// Everything but vertices, texels and matrices of skins. Once.
    SceneOutline outline(const ClipChoice& clips);

    /// Fills in the geometries and textures that are needed. Primitives without triangles stay empty.
    /// @param geometries, textures  the outline's, in their places
    void load_geometries(std::span<const GeometryNeeds> needs, std::span<GeometryData> geometries);
    void load_textures(const LoadOptions& options, const std::vector<bool>& needed, std::span<TextureData> textures) { textures_.load(options, needed, textures); }
    std::vector<glm::dmat4> bind_matrices(std::size_t skin) const;

    /// Of what has been read so far.
    Hash content() const { return document_.content(); }
    std::size_t read_bytes() const { return document_.read_bytes(); }
    std::vector<Diagnostic> take_warnings() { return std::exchange(document_.warnings, {}); }

private:
    struct Primitive {
        std::size_t mesh, index;
        int geometry;          ///< position in sources_
        int material;          ///< glTF's; -1: the default
        int uv_set;            ///< that tangents are made for; -1: none, and normal textures are left out
        std::vector<VariantMapping> variants;
    };
    /// What a geometry is built from.
    struct Source {
        std::size_t mesh, primitive;
        int uv_set;            ///< of Primitive
    };
    /// What makes two primitives the same geometry.
    struct GeometryKey {
        std::map<std::string, int> attributes;
        std::vector<std::map<std::string, int>> targets;
        int indices, mode, normal_uv_set;
        auto operator<=>(const GeometryKey&) const = default;
    };

    const tinygltf::Primitive& source(std::size_t mesh, std::size_t index) const { return document_.model().meshes[mesh].primitives[index]; }
    void collect_primitives();
    void collect(std::size_t mesh, std::size_t index, std::map<GeometryKey, int>& known);
    int tangent_uv_set(std::size_t mesh, std::size_t index, const std::vector<VariantMapping>& variants);
    void attach_primitives();
    MeshPrimitive attached(const Primitive& primitive);
    int material_index(int gltf_material, int uv_set);
    std::vector<int> with_missing_roots(std::vector<int> roots);
    void outline_geometries();
    SceneFile file(std::vector<int> roots) const;
    void check_growth(std::span<const GeometryNeeds> needs) const;
    void check_skins(std::span<const GeometryData> geometries);
    void check_skin(std::size_t node, const Primitive& primitive, const SkinWeights& weights);

    GltfDocument document_;
    TextureSet textures_;
    Scene scene_;                                        ///< the outline, until it is taken
    std::vector<GeometryOutline> geometries_;
    std::vector<Primitive> primitives_;
    std::vector<std::vector<int>> of_mesh_;              ///< positions in primitives_
    std::vector<Source> sources_;                        ///< [geometry]
    std::map<std::pair<int, bool>, int> materials_;
};

}  // namespace kadr
