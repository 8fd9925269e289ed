#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "anim/placement.h"
#include "anim/track.h"
#include "base/error.h"
#include "base/hash.h"
#include "kernels/scene/scene_types.h"
#include "scene/property_channel.h"

namespace kadr {

/// How much each joint of a skin carries each vertex. Unused slots weigh 0 and come last.
struct SkinWeights {
    int per_vertex = 0;                  ///< slots; 0: the primitive has no joints
    std::vector<std::uint16_t> joints;   ///< [vertex][slot] positions in Skin::joints
    std::vector<float> weights;          ///< [vertex][slot] at least 0, summing to 1
};

/// One morph target: what it adds to the vertices that it moves, in the geometry's normalised units.
struct MorphTarget {
    std::vector<std::uint32_t> vertices;                        ///< ascending; those with any difference
    std::vector<kernels::Vec3f> positions, normals, tangents;   ///< parallel to vertices; empty: no differences
};

/// One glTF primitive as triangles, in normalised coordinates: mesh position = centre + scale * position, with
/// positions in [-1, 1]. Node transforms apply to mesh positions, so
/// world_from_geometry = world_from_node * translate(centre) * scale(scale).
struct GeometryData {
    std::string name;                                 ///< "mesh/primitive", for messages
    std::vector<kernels::Vec3f> positions, normals;   ///< normals empty: flat
    std::vector<std::uint32_t> indices;               ///< three a triangle
    std::vector<kernels::Vec4f> tangents;
    std::array<std::vector<kernels::Vec2f>, 2> uv;
    std::vector<kernels::Vec4f> colors;
    SkinWeights skin;
    std::vector<MorphTarget> targets;
    glm::dvec3 centre{0};
    double scale = 1;
};

struct TextureData {
    std::string name;
    std::vector<std::uint8_t> texels;  ///< width * height * 4 channels in `format`
    int width = 0, height = 0;
    kernels::TexelFormat format = kernels::TexelFormat::rgba8_srgb;
    kernels::Wrap wrap_s = kernels::Wrap::repeat, wrap_t = kernels::Wrap::repeat;
    bool nearest = false;
    kernels::Texture view() const;
};

/// KHR_lights_punctual: shines along the node's -z.
struct SceneLight {
    std::string name;
    kernels::LightKind kind = kernels::LightKind::point;
    glm::dvec3 color{1};
    double intensity = 1;       ///< lux or candela
    double range_m = 0;         ///< 0: infinite
    double inner_rad = 0, outer_rad = 0.7853981633974483;
};

struct SceneCamera {
    std::string name;
    bool orthographic = false;
    double yfov_rad = 0.8, aspect = 0;   ///< aspect 0: the image's
    double xmag = 1, ymag = 1;           ///< orthographic half extents, metres
    double znear = 0, zfar = 0;          ///< zfar 0: infinite
};

/// KHR_texture_transform: uv' = T(offset) * R(rotation) * S(scale) * uv.
struct TextureTransform {
    glm::dvec2 offset{0};
    double rotation_rad = 0;  ///< counter-clockwise as seen in an image whose v grows downward
    glm::dvec2 scale{1};
    bool operator==(const TextureTransform&) const = default;
};
/// The slot with the transform as its matrix.
kernels::TextureSlot transformed(kernels::TextureSlot slot, const TextureTransform& transform);

inline constexpr double kDefaultIor = 1.5;  ///< index of refraction of materials without KHR_materials_ior

/// What a dielectric of an index of refraction reflects of light that comes straight on; all of it where the index is 0.
float dielectric_f0(double ior);

/// What a material was made of, for tracks that change one of its factors.
struct MaterialSource {
    int index = -1;            ///< of the material in its file; -1: glTF's default material
    glm::dvec3 emissive{0};    ///< the factor; times the strength it is Material::emission
    double emissive_strength = 1;
    double ior = kDefaultIor;  ///< index of refraction, from which Material::dielectric_f0 is
    std::array<TextureTransform, kTextureUses> transforms;  ///< [TextureUse]
};

/// The material that a primitive has under a variant of its file.
struct VariantMaterial {
    int variant = -1;    ///< index into SceneFile::variants
    int material = -1;   ///< index into Scene::materials
};

struct MeshPrimitive {
    int geometry = -1;   ///< index into Scene::geometries
    int material = -1;   ///< index into Scene::materials (always set: the glTF default material is added)
    std::vector<VariantMaterial> variants = {};  ///< KHR_materials_variants; variants that are not here keep `material`
};

struct Node {
    std::string name;            ///< as in the file; may be empty or repeated
    int parent = -1;
    std::vector<int> children;   ///< indices into Scene::nodes
    /// parent_from_node: a fixed matrix, or T, R, S (which clips animate).
    std::optional<glm::dmat4> matrix;
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
    std::vector<MeshPrimitive> primitives;
    int placement_set = -1;      ///< index into Scene::placement_sets: its meshes stand at each of them (EXT_mesh_gpu_instancing)
    int light = -1, camera = -1; ///< indices into Scene::lights, Scene::cameras
    bool visible = true;         ///< KHR_node_visibility: false hides the node and all below it
    int skin = -1;               ///< index into Scene::skins: the mesh follows its joints, not this node
    std::vector<double> weights; ///< of the mesh's morph targets, as many as it has
};

/// The joints that carry a mesh.
struct Skin {
    std::string name;
    std::vector<int> joints;                ///< indices into Scene::nodes
    std::vector<glm::dmat4> inverse_bind;   ///< [joint] joint_from_mesh at rest
    int root = -1;                          ///< the node nearest to the joints that is above them all, or one of them
};

/// One animated node of a clip. Absent tracks leave the node's own value.
struct NodeChannels {
    int node = -1;
    std::optional<Track<glm::dvec3>> translation, scale;
    std::optional<Track<glm::dquat>> rotation;
    std::vector<Track<double>> weights;  ///< [morph target], all with the same keys; empty: not animated
};

struct Clip {
    std::string name;
    double begin_s = 0, end_s = 0;
    std::vector<NodeChannels> channels;
    int channel_count = 0;  ///< in the file, with those that are ignored
    bool read = true;       ///< false: known by name alone, because nothing plays it
    std::vector<PropertyChannel> properties = {};  ///< what the clip drives beside nodes' transforms
    /// Whether any of its channels means something here.
    bool animates() const { return !channels.empty() || !properties.empty(); }
};

/// The part of a Scene that came from one glTF file of the shot. Ranges are half open.
struct SceneFile {
    std::string id;              ///< of the shot's scene entry
    std::filesystem::path path;
    Hash content;                ///< of the file and of everything it names
    std::vector<int> roots;      ///< nodes of the file's default scene
    int first_node = 0, node_count = 0;
    int first_clip = 0, clip_count = 0;
    int first_material = 0, material_count = 0;  ///< entries of the same file share them
    std::vector<std::string> variants;           ///< names; KHR_materials_variants
    std::vector<std::string> extensions;         ///< that it names and Kadr follows
    std::vector<std::string> ignored_extensions; ///< that it names and Kadr does not know
    std::vector<std::string> unused_images;      ///< that no material of a mesh names
    std::size_t read_bytes = 0;                  ///< of the file and of what it names: those that were asked for
};

/// Everything the glTF files of a shot hold, merged into one index space; built once a shot.
struct Scene {
    std::vector<SceneFile> files;        ///< one per scene entry of the shot, in its order
    std::vector<Node> nodes;             ///< nodes outside the default scenes are present but reached from no root
    std::vector<GeometryData> geometries;
    std::vector<kernels::Material> materials;
    std::vector<std::string> material_names;
    std::vector<MaterialSource> material_sources;   ///< [material]
    std::vector<TextureData> textures;   ///< one per (image, colour space, sampler)
    std::vector<std::vector<Placement>> placement_sets;  ///< node_from_copy; of EXT_mesh_gpu_instancing, never empty
    std::vector<SceneLight> lights;
    std::vector<SceneCamera> cameras;
    std::vector<Skin> skins;
    std::vector<Clip> clips;
    std::vector<Diagnostic> warnings;
};

/// The clips of a file that are read; the others are known by name alone.
struct ClipChoice {
    bool all = true;
    std::vector<std::string> names;
    std::vector<int> numbers;   ///< as the file numbers them
    bool holds(const std::string& name, int number) const {
        return all || std::find(names.begin(), names.end(), name) != names.end() || std::find(numbers.begin(), numbers.end(), number) != numbers.end();
    }
};

/// What a shot asks for: which file, under which id. `where` is the place in the shot file, for messages.
struct SceneFileRequest {
    std::string id;
    std::filesystem::path path;
    SourceLocation where;
    ClipChoice clips = {};
};

struct LoadOptions {
    bool decode_textures = true;   ///< `kadr check` reads image headers alone
    int texture_limit_px = 0;      ///< larger textures are averaged down to this longest side; 0: as they are
};

/// Reads glTF files (.gltf, .glb), all that is in them. Two requests for the same file share geometries, materials and
/// textures. SceneFiles (scene_files.h) reads what a shot needs alone.
/// @throws InputError  naming the file and the JSON pointer ("/meshes/0/primitives/1/indices")
Scene load_scene(const std::vector<SceneFileRequest>& requests, const LoadOptions& options = {});

}  // namespace kadr
