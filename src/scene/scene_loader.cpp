#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <exception>
#include <map>
#include <memory>

#include "scene/animation_reader.h"
#include "scene/deformation_reader.h"
#include "scene/geometry_builder.h"
#include "scene/gltf_document.h"
#include "scene/instancing_reader.h"
#include "scene/material_reader.h"
#include "scene/node_reader.h"
#include "scene/scene.h"
#include "scene/texture_set.h"
#include "scene/variant_reader.h"

namespace kadr {

namespace {

/// Memory of one vertex with everything, for the estimate of what a file would need.
constexpr std::uint64_t kVertexBytes = sizeof(float) * (3 + 3 + 4 + 2 + 2 + 4);
constexpr std::uint64_t kTargetBytes = sizeof(float) * 3 * 3 + 4;  // of one vertex of a morph target
constexpr std::uint64_t kAlwaysAllowed = 1ull << 30;   // bytes
constexpr std::uint64_t kLargestGrowth = 64;           // bytes of geometry per byte of file: shared accessors multiply
constexpr std::uint64_t kMostVertices = 1ull << 31;

/// What makes two primitives the same geometry.
struct GeometryKey {
    std::map<std::string, int> attributes;
    std::vector<std::map<std::string, int>> targets;
    int indices, mode, normal_uv_set;
    auto operator<=>(const GeometryKey&) const = default;
};

/// One file on its own: indices start at 0, nodes are those of the file.
class FileLoader {
public:
    FileLoader(const std::filesystem::path& path, const SourceLocation& asked_from) : document_(path, asked_from), textures_(document_) {}

    Scene load(const LoadOptions& options) {
        scene_.nodes = read_nodes(document_);
        InstancingReader(document_).read(scene_.nodes, scene_.placement_sets);
        std::vector<int> file_roots = read_roots(document_, scene_.nodes);
        scene_.lights = read_lights(document_);
        scene_.cameras = read_cameras(document_);
        scene_.skins = read_skins(document_, scene_.nodes);
        read_morph_weights(document_, scene_.nodes);
        scene_.clips = read_animations(document_);
        collect_primitives();
        check_growth();
        build_geometries();
        attach_primitives();
        const std::vector<int> roots = add_missing_roots(std::move(file_roots));
        scene_.textures = textures_.load(options);
        scene_.warnings = std::move(document_.warnings);
        SceneFile file;
        file.content = document_.content();
        file.roots = roots;
        file.variants = read_variants(document_);
        scene_.files.push_back(std::move(file));
        return std::move(scene_);
    }

private:
    struct Primitive {
        std::size_t mesh, index;
        int geometry;          ///< position in keys_
        int material;          ///< glTF's; -1: the default
        int uv_set;            ///< that tangents are made for; -1: none, and normal textures are left out
        std::vector<VariantMapping> variants;
    };

    const tinygltf::Primitive& source(std::size_t mesh, std::size_t index) const { return document_.model().meshes[mesh].primitives[index]; }

    /// Primitives of the meshes that nodes use; equal ones share a geometry.
    void collect_primitives() {
        const tinygltf::Model& model = document_.model();
        std::vector<bool> used(model.meshes.size());
        for (const tinygltf::Node& node : model.nodes)
            if (node.mesh >= 0) used[static_cast<std::size_t>(node.mesh)] = true;
        of_mesh_.resize(model.meshes.size());
        std::map<GeometryKey, int> known;
        for (std::size_t m = 0; m < used.size(); ++m)
            for (std::size_t p = 0; used[m] && p < model.meshes[m].primitives.size(); ++p) collect(m, p, known);
    }

    void collect(std::size_t mesh, std::size_t index, std::map<GeometryKey, int>& known) {
        const tinygltf::Primitive& primitive = source(mesh, index);
        std::vector<VariantMapping> variants = read_variant_mappings(document_, mesh, index);
        const int uv_set = tangent_uv_set(mesh, index, variants);
        const GeometryKey key{primitive.attributes, primitive.targets, primitive.indices, primitive.mode, uv_set};
        const auto [place, added] = known.try_emplace(key, static_cast<int>(built_from_.size()));
        if (added) built_from_.push_back({{mesh, index}, uv_set});
        of_mesh_[mesh].push_back(static_cast<int>(primitives_.size()));
        primitives_.push_back({mesh, index, place->second, primitive.material, uv_set, std::move(variants)});
    }

    /// The texture coordinates that the primitive's tangents follow: those of the normal texture of its material, or
    /// else of the first variant that has one; -1 where there is none, or the primitive lacks them.
    int tangent_uv_set(std::size_t mesh, std::size_t index, const std::vector<VariantMapping>& variants) {
        const tinygltf::Primitive& primitive = source(mesh, index);
        int material = primitive.material, uv_set = normal_uv_set(document_, material);
        for (std::size_t v = 0; uv_set < 0 && v < variants.size(); ++v) uv_set = normal_uv_set(document_, material = variants[v].material);
        if (uv_set < 0 || primitive.attributes.count(fmt::format("TEXCOORD_{}", uv_set))) return uv_set;
        document_.warnings.push_back(document_.warning(fmt::format("/meshes/{}/primitives/{}", mesh, index),
                                                       fmt::format("has no TEXCOORD_{}; the normal texture of material {} is left out", uv_set, material)));
        return -1;
    }

    /// Accessors may be shared by any number of primitives, so a small file can ask for any amount of memory.
    void check_growth() const {
        std::uint64_t vertices = 0, bytes = 0;
        for (const auto& [from, uv_set] : built_from_) {
            const tinygltf::Primitive& primitive = source(from.first, from.second);
            const auto position = primitive.attributes.find("POSITION");
            if (position == primitive.attributes.end()) continue;
            const auto count_of = [&](int accessor) { return static_cast<std::uint64_t>(document_.model().accessors[static_cast<std::size_t>(accessor)].count); };
            const std::uint64_t count = count_of(position->second);
            const std::uint64_t order = primitive.indices >= 0 ? count_of(primitive.indices) : count;
            vertices += count;
            bytes += count * (kVertexBytes + primitive.targets.size() * kTargetBytes) + order * (primitive.mode > TINYGLTF_MODE_TRIANGLES ? 16 : 4);
        }
        if (vertices >= kMostVertices || (bytes > kAlwaysAllowed && bytes / kLargestGrowth > document_.total_bytes()))
            document_.fail("/meshes", fmt::format("need {} vertices, {} MiB, from a file of {} bytes", vertices, bytes >> 20, document_.total_bytes()),
                           "expected less than 2^31 vertices, and accessors that are not shared by thousands of primitives");
    }

    void build_geometries() {
        std::vector<BuiltGeometry> built(built_from_.size());
        std::vector<std::exception_ptr> failures(built_from_.size());
        tbb::parallel_for(std::size_t{0}, built.size(), [&](std::size_t i) {
            try {
                const auto& [from, uv_set] = built_from_[i];
                built[i] = build_geometry(document_, from.first, from.second, uv_set);
            } catch (...) {
                failures[i] = std::current_exception();
            }
        });
        for (const std::exception_ptr& failure : failures)  // the first in the file's order, whatever the threads did
            if (failure) std::rethrow_exception(failure);
        for (BuiltGeometry& one : built) {
            for (Diagnostic& warning : one.warnings) document_.warnings.push_back(std::move(warning));
            const bool empty = one.data.indices.empty();
            geometry_of_.push_back(empty ? -1 : static_cast<int>(scene_.geometries.size()));
            if (!empty) scene_.geometries.push_back(std::move(one.data));
        }
    }

    void attach_primitives() {
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            const int mesh = document_.model().nodes[i].mesh;
            if (mesh < 0) continue;
            for (const int p : of_mesh_[static_cast<std::size_t>(mesh)]) {
                const Primitive& primitive = primitives_[static_cast<std::size_t>(p)];
                const int geometry = geometry_of_[static_cast<std::size_t>(primitive.geometry)];
                if (geometry >= 0) scene_.nodes[i].primitives.push_back(attached(primitive, geometry));
                if (geometry >= 0) check_skin(i, primitive, scene_.geometries[static_cast<std::size_t>(geometry)].skin);
            }
        }
    }

    MeshPrimitive attached(const Primitive& primitive, int geometry) {
        MeshPrimitive result{geometry, material_index(primitive.material, primitive.uv_set)};
        for (const VariantMapping& mapping : primitive.variants) {
            const int material = material_index(mapping.material, primitive.uv_set);
            for (const int variant : mapping.variants) result.variants.push_back({variant, material});
        }
        return result;
    }

    /// Gives skins whose joints belong to several trees a root: a node of its own that stands where the scene does.
    std::vector<int> add_missing_roots(std::vector<int> roots) {
        int added = -1;
        for (Skin& skin : scene_.skins) {
            if (skin.root >= 0) continue;
            if (added < 0) {
                added = static_cast<int>(scene_.nodes.size());
                scene_.nodes.emplace_back();
                roots.push_back(added);
            }
            skin.root = added;
        }
        return roots;
    }

    /// A node's skin and its mesh meet here alone: whether the joints that vertices name exist.
    void check_skin(std::size_t node, const Primitive& primitive, const SkinWeights& weights) {
        const int skin = document_.model().nodes[node].skin;
        if (skin < 0) return;
        scene_.nodes[node].skin = skin;
        const std::string pointer = fmt::format("/meshes/{}/primitives/{}/attributes", primitive.mesh, primitive.index);
        if (weights.per_vertex == 0) {
            document_.warnings.push_back(document_.warning(pointer, fmt::format("has no JOINTS_0, but node {} has a skin; the primitive stays at its node", node)));
            return;
        }
        const std::size_t joints = scene_.skins[static_cast<std::size_t>(skin)].joints.size();
        for (std::size_t i = 0; i < weights.joints.size(); ++i)
            if (weights.weights[i] > 0 && weights.joints[i] >= joints)
                document_.fail(pointer + "/JOINTS_0", fmt::format("names joint {}, skin {} of node {} has {}", weights.joints[i], skin, node, joints),
                               fmt::format("expected joints 0 to {}", joints - 1));
    }

    /// Materials are read when first used, so that textures of unused ones are not decoded.
    /// @param gltf_material  -1: glTF's default material; @param uv_set  that the primitive has tangents for
    int material_index(int gltf_material, int uv_set) {
        const int normal_set = normal_uv_set(document_, gltf_material);
        const bool drop_normal_map = normal_set >= 0 && normal_set != uv_set;
        const auto [place, added] = materials_.try_emplace({gltf_material, drop_normal_map}, static_cast<int>(scene_.materials.size()));
        if (!added) return place->second;
        if (gltf_material < 0) {
            scene_.materials.push_back({});
            scene_.material_names.push_back("default");
            scene_.material_sources.push_back({});
            return place->second;
        }
        const auto index = static_cast<std::size_t>(gltf_material);
        kernels::Material material = read_material(document_, index, textures_);
        if (drop_normal_map) material.normal_texture = {};
        scene_.materials.push_back(material);
        const std::string& name = document_.model().materials[index].name;
        scene_.material_names.push_back(name.empty() ? fmt::format("material {}", index) : name);
        scene_.material_sources.push_back(material_source(document_, index));
        return place->second;
    }

    GltfDocument document_;
    TextureSet textures_;
    Scene scene_;
    std::vector<Primitive> primitives_;
    std::vector<std::vector<int>> of_mesh_;                                            ///< positions in primitives_
    std::vector<std::pair<std::pair<std::size_t, std::size_t>, int>> built_from_;      ///< (mesh, primitive), uv set
    std::vector<int> geometry_of_;
    std::map<std::pair<int, bool>, int> materials_;
};

/// Where a file's shared tables begin in the whole scene.
struct Offsets {
    int geometry, material, light, camera, material_count, placement_set;
};

template <class T>
int append(std::vector<T>& to, std::vector<T>& from) {
    const int offset = static_cast<int>(to.size());
    std::move(from.begin(), from.end(), std::back_inserter(to));
    from.clear();
    return offset;
}

int shifted(int index, int offset) { return index < 0 ? index : index + offset; }

Offsets append_tables(Scene& scene, Scene& file) {
    const int texture = append(scene.textures, file.textures);
    for (kernels::Material& material : file.materials)
        for (kernels::TextureSlot* slot : {&material.base_color_texture, &material.metallic_roughness_texture, &material.normal_texture,
                                           &material.emissive_texture, &material.occlusion_texture})
            slot->texture = shifted(slot->texture, texture);
    append(scene.material_names, file.material_names);
    append(scene.material_sources, file.material_sources);
    const int material_count = static_cast<int>(file.materials.size());
    append(scene.warnings, file.warnings);
    return {append(scene.geometries, file.geometries), append(scene.materials, file.materials), append(scene.lights, file.lights), append(scene.cameras, file.cameras), material_count, append(scene.placement_sets, file.placement_sets)};
}

/// Where the table begins that a property's index counts in. Materials are found by their file's numbers.
int first_index_of(Property property, const SceneFile& entry, const Offsets& offsets) {
    switch (owner_of(property)) {
        case PropertyOwner::node: return entry.first_node;
        case PropertyOwner::light: return offsets.light;
        case PropertyOwner::camera: return offsets.camera;
        case PropertyOwner::material: break;
    }
    return 0;
}

/// The file's nodes and clips once more, for one scene entry of the shot.
void append_tree(Scene& scene, const Scene& file, const Offsets& offsets, const SceneFileRequest& request) {
    SceneFile entry = file.files.front();
    entry.id = request.id;
    entry.path = request.path;
    entry.first_node = static_cast<int>(scene.nodes.size());
    entry.node_count = static_cast<int>(file.nodes.size());
    entry.first_clip = static_cast<int>(scene.clips.size());
    entry.clip_count = static_cast<int>(file.clips.size());
    entry.first_material = offsets.material;
    entry.material_count = offsets.material_count;
    for (int& root : entry.roots) root += entry.first_node;
    for (Node node : file.nodes) {
        node.parent = shifted(node.parent, entry.first_node);
        for (int& child : node.children) child += entry.first_node;
        for (MeshPrimitive& primitive : node.primitives) {
            primitive.geometry += offsets.geometry;
            primitive.material += offsets.material;
            for (VariantMaterial& variant : primitive.variants) variant.material += offsets.material;
        }
        node.placement_set = shifted(node.placement_set, offsets.placement_set);
        node.light = shifted(node.light, offsets.light);
        node.camera = shifted(node.camera, offsets.camera);
        node.skin = shifted(node.skin, static_cast<int>(scene.skins.size()));
        scene.nodes.push_back(std::move(node));
    }
    for (Skin skin : file.skins) {
        for (int& joint : skin.joints) joint += entry.first_node;
        skin.root += entry.first_node;
        scene.skins.push_back(std::move(skin));
    }
    for (Clip clip : file.clips) {
        for (NodeChannels& channels : clip.channels) channels.node += entry.first_node;
        for (PropertyChannel& channel : clip.properties) channel.index += first_index_of(channel.property, entry, offsets);
        scene.clips.push_back(std::move(clip));
    }
    scene.files.push_back(std::move(entry));
}

}  // namespace

kernels::Texture TextureData::view() const { return {texels.data(), width, height, format, wrap_s, wrap_t, nearest}; }

Scene load_scene(const std::vector<SceneFileRequest>& requests, const LoadOptions& options) {
    struct Loaded {
        Scene scene;
        Offsets offsets;
    };
    std::map<std::string, Loaded> files;
    Scene scene;
    for (const SceneFileRequest& request : requests) {
        std::error_code failed;
        const std::filesystem::path canonical = std::filesystem::weakly_canonical(request.path, failed);
        const std::string key = failed ? request.path.string() : canonical.string();
        auto found = files.find(key);
        if (found == files.end()) {
            Loaded loaded{FileLoader(request.path, request.where).load(options), {}};
            loaded.offsets = append_tables(scene, loaded.scene);
            found = files.emplace(key, std::move(loaded)).first;
        }
        append_tree(scene, found->second.scene, found->second.offsets, request);
    }
    return scene;
}

}  // namespace kadr
