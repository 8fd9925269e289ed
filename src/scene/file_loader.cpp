#include "scene/file_loader.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <exception>

#include "scene/animation_reader.h"
#include "scene/deformation_reader.h"
#include "scene/geometry_builder.h"
#include "scene/instancing_reader.h"
#include "scene/material_reader.h"
#include "scene/node_reader.h"

namespace kadr {

namespace {

/// Memory of one vertex with everything, for the estimate of what a file would need.
constexpr std::uint64_t kVertexBytes = sizeof(float) * (3 + 3 + 4 + 2 + 2 + 4);
constexpr std::uint64_t kTargetBytes = sizeof(float) * 3 * 3 + 4;  // of one vertex of a morph target
constexpr std::uint64_t kAlwaysAllowed = 1ull << 30;   // bytes
constexpr std::uint64_t kLargestGrowth = 64;           // bytes of geometry per byte of file: shared accessors multiply
constexpr std::uint64_t kMostVertices = 1ull << 31;

}  // namespace

FileLoader::FileLoader(const std::filesystem::path& path, const SourceLocation& asked_from) : document_(path, asked_from), textures_(document_) {}

SceneOutline FileLoader::outline(const ClipChoice& clips) {
    scene_.nodes = read_nodes(document_);
    InstancingReader(document_).read(scene_.nodes, scene_.placement_sets);
    std::vector<int> roots = read_roots(document_, scene_.nodes);
    scene_.lights = read_lights(document_);
    scene_.cameras = read_cameras(document_);
    scene_.skins = read_skins(document_, scene_.nodes);
    read_morph_weights(document_, scene_.nodes);
    scene_.clips = read_animations(document_, clips);
    collect_primitives();
    outline_geometries();
    attach_primitives();
    scene_.textures = textures_.outlines();
    scene_.files.push_back(file(with_missing_roots(std::move(roots))));
    return {std::move(scene_), std::move(geometries_)};
}

SceneFile FileLoader::file(std::vector<int> roots) const {
    SceneFile file;
    file.roots = std::move(roots);
    file.variants = read_variants(document_);
    file.extensions = document_.extensions(true);
    file.ignored_extensions = document_.extensions(false);
    file.unused_images = textures_.unused_images();
    return file;
}

/// Primitives of the meshes that nodes use; equal ones share a geometry.
void FileLoader::collect_primitives() {
    const tinygltf::Model& model = document_.model();
    std::vector<bool> used(model.meshes.size());
    for (const tinygltf::Node& node : model.nodes)
        if (node.mesh >= 0) used[static_cast<std::size_t>(node.mesh)] = true;
    of_mesh_.resize(model.meshes.size());
    std::map<GeometryKey, int> known;
    for (std::size_t m = 0; m < used.size(); ++m)
        for (std::size_t p = 0; used[m] && p < model.meshes[m].primitives.size(); ++p) collect(m, p, known);
}

void FileLoader::collect(std::size_t mesh, std::size_t index, std::map<GeometryKey, int>& known) {
    const tinygltf::Primitive& primitive = source(mesh, index);
    std::vector<VariantMapping> variants = read_variant_mappings(document_, mesh, index);
    const int uv_set = tangent_uv_set(mesh, index, variants);
    const GeometryKey key{primitive.attributes, primitive.targets, primitive.indices, primitive.mode, uv_set};
    const auto [place, added] = known.try_emplace(key, static_cast<int>(sources_.size()));
    if (added) sources_.push_back({mesh, index, uv_set});
    of_mesh_[mesh].push_back(static_cast<int>(primitives_.size()));
    primitives_.push_back({mesh, index, place->second, primitive.material, uv_set, std::move(variants)});
}

/// The texture coordinates that the primitive's tangents follow: those of the normal texture of its material, or
/// else of the first variant that has one; -1 where there is none, or the primitive lacks them.
int FileLoader::tangent_uv_set(std::size_t mesh, std::size_t index, const std::vector<VariantMapping>& variants) {
    const tinygltf::Primitive& primitive = source(mesh, index);
    int material = primitive.material, uv_set = normal_uv_set(document_, material);
    for (std::size_t v = 0; uv_set < 0 && v < variants.size(); ++v) uv_set = normal_uv_set(document_, material = variants[v].material);
    if (uv_set < 0 || primitive.attributes.count(fmt::format("TEXCOORD_{}", uv_set))) return uv_set;
    document_.warnings.push_back(document_.warning(fmt::format("/meshes/{}/primitives/{}", mesh, index),
                                                   fmt::format("has no TEXCOORD_{}; the normal texture of material {} is left out", uv_set, material)));
    return -1;
}

void FileLoader::outline_geometries() {
    for (const Source& source : sources_) {
        geometries_.push_back(outline_of(document_, source.mesh, source.primitive));
        scene_.geometries.emplace_back().name = geometry_name(document_, source.mesh, source.primitive);
    }
}

void FileLoader::attach_primitives() {
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
        const tinygltf::Node& node = document_.model().nodes[i];
        if (node.mesh < 0) continue;
        scene_.nodes[i].skin = node.skin;
        for (const int p : of_mesh_[static_cast<std::size_t>(node.mesh)]) scene_.nodes[i].primitives.push_back(attached(primitives_[static_cast<std::size_t>(p)]));
    }
}

MeshPrimitive FileLoader::attached(const Primitive& primitive) {
    MeshPrimitive result{primitive.geometry, material_index(primitive.material, primitive.uv_set)};
    for (const VariantMapping& mapping : primitive.variants) {
        const int material = material_index(mapping.material, primitive.uv_set);
        for (const int variant : mapping.variants) result.variants.push_back({variant, material});
    }
    return result;
}

/// Materials are read when first used, so that of unused ones nothing is known.
/// @param gltf_material  -1: glTF's default material; @param uv_set  that the primitive has tangents for
int FileLoader::material_index(int gltf_material, int uv_set) {
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

/// Gives skins whose joints belong to several trees a root: a node of its own that stands where the scene does.
std::vector<int> FileLoader::with_missing_roots(std::vector<int> roots) {
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

/// Accessors may be shared by any number of primitives, so a small file can ask for any amount of memory.
void FileLoader::check_growth(std::span<const GeometryNeeds> needs) const {
    std::uint64_t vertices = 0, bytes = 0;
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        if (!needs[i].wanted) continue;
        const GeometryOutline outline = outline_of(document_, sources_[i].mesh, sources_[i].primitive);
        if (outline.vertices == 0) continue;
        vertices += outline.vertices;
        bytes += outline.vertices * (kVertexBytes + outline.targets * kTargetBytes) + outline.corners * sizeof(std::uint32_t);
    }
    if (vertices >= kMostVertices || (bytes > kAlwaysAllowed && bytes / kLargestGrowth > document_.total_bytes()))
        document_.fail("/meshes", fmt::format("need {} vertices, {} MiB, from a file of {} bytes", vertices, bytes >> 20, document_.total_bytes()),
                       "expected less than 2^31 vertices, and accessors that are not shared by thousands of primitives");
}

void FileLoader::load_geometries(std::span<const GeometryNeeds> needs, std::span<GeometryData> geometries) {
    check_growth(needs);
    std::vector<BuiltGeometry> built(sources_.size());
    std::vector<std::exception_ptr> failures(sources_.size());
    tbb::parallel_for(std::size_t{0}, built.size(), [&](std::size_t i) {
        if (!needs[i].wanted) return;
        try {
            built[i] = build_geometry(document_, sources_[i].mesh, sources_[i].primitive, sources_[i].uv_set, needs[i]);
        } catch (...) {
            failures[i] = std::current_exception();
        }
    });
    for (const std::exception_ptr& failure : failures)  // the first in the file's order, whatever the threads did
        if (failure) std::rethrow_exception(failure);
    for (std::size_t i = 0; i < built.size(); ++i) {
        for (Diagnostic& warning : built[i].warnings) document_.warnings.push_back(std::move(warning));
        if (needs[i].wanted) geometries[i] = std::move(built[i].data);
    }
    check_skins(geometries);
}

void FileLoader::check_skins(std::span<const GeometryData> geometries) {
    const tinygltf::Model& model = document_.model();
    for (std::size_t node = 0; node < model.nodes.size(); ++node) {
        if (model.nodes[node].mesh < 0 || model.nodes[node].skin < 0) continue;
        for (const int p : of_mesh_[static_cast<std::size_t>(model.nodes[node].mesh)]) {
            const Primitive& primitive = primitives_[static_cast<std::size_t>(p)];
            const GeometryData& geometry = geometries[static_cast<std::size_t>(primitive.geometry)];
            if (!geometry.indices.empty()) check_skin(node, primitive, geometry.skin);
        }
    }
}

/// A node's skin and its mesh meet here alone: whether the joints that vertices name exist.
void FileLoader::check_skin(std::size_t node, const Primitive& primitive, const SkinWeights& weights) {
    const int skin = document_.model().nodes[node].skin;
    const std::string pointer = fmt::format("/meshes/{}/primitives/{}/attributes", primitive.mesh, primitive.index);
    if (source(primitive.mesh, primitive.index).attributes.count("JOINTS_0") == 0) {
        document_.warnings.push_back(document_.warning(pointer, fmt::format("has no JOINTS_0, but node {} has a skin; the primitive stays at its node", node)));
        return;
    }
    const std::size_t joints = document_.model().skins[static_cast<std::size_t>(skin)].joints.size();
    for (std::size_t i = 0; i < weights.joints.size(); ++i)
        if (weights.weights[i] > 0 && weights.joints[i] >= joints)
            document_.fail(pointer + "/JOINTS_0", fmt::format("names joint {}, skin {} of node {} has {}", weights.joints[i], skin, node, joints),
                           fmt::format("expected joints 0 to {}", joints - 1));
}

std::vector<glm::dmat4> FileLoader::bind_matrices(std::size_t skin) const { return read_bind_matrices(document_, skin); }

}  // namespace kadr
