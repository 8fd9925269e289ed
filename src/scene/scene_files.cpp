#include "scene/scene_files.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "scene/file_loader.h"

namespace kadr {

namespace {

/// Where a file's shared tables begin in the whole scene, and how long they are.
struct Tables {
    int geometry = 0, material = 0, texture = 0, light = 0, camera = 0, placement_set = 0;
    int geometry_count = 0, material_count = 0, texture_count = 0;
};

std::size_t index(int i) { return static_cast<std::size_t>(i); }

template <class T>
int append(std::vector<T>& to, std::vector<T>& from) {
    const int offset = static_cast<int>(to.size());
    std::move(from.begin(), from.end(), std::back_inserter(to));
    from.clear();
    return offset;
}

int shifted(int index, int offset) { return index < 0 ? index : index + offset; }

using TextureSlots = std::array<kernels::TextureSlot*, kTextureUses>;

/// In the order of TextureUse.
TextureSlots slots_of(kernels::Material& material) {
    return {&material.base_color_texture, &material.metallic_roughness_texture, &material.normal_texture, &material.emissive_texture, &material.occlusion_texture};
}

Tables append_tables(SceneOutline& whole, SceneOutline& file) {
    Scene& scene = whole.scene;
    Scene& from = file.scene;
    Tables tables;
    tables.geometry_count = static_cast<int>(from.geometries.size());
    tables.material_count = static_cast<int>(from.materials.size());
    tables.texture_count = static_cast<int>(from.textures.size());
    tables.texture = append(scene.textures, from.textures);
    for (kernels::Material& material : from.materials)
        for (kernels::TextureSlot* slot : slots_of(material)) slot->texture = shifted(slot->texture, tables.texture);
    append(scene.material_names, from.material_names);
    append(scene.material_sources, from.material_sources);
    append(whole.geometries, file.geometries);
    tables.geometry = append(scene.geometries, from.geometries);
    tables.material = append(scene.materials, from.materials);
    tables.light = append(scene.lights, from.lights);
    tables.camera = append(scene.cameras, from.cameras);
    tables.placement_set = append(scene.placement_sets, from.placement_sets);
    return tables;
}

/// Where the table begins that a property's index counts in. Materials are found by their file's numbers.
int first_index_of(Property property, const SceneFile& entry, const Tables& tables) {
    switch (owner_of(property)) {
        case PropertyOwner::node: return entry.first_node;
        case PropertyOwner::light: return tables.light;
        case PropertyOwner::camera: return tables.camera;
        case PropertyOwner::material: break;
    }
    return 0;
}

/// The file's nodes and clips once more, for one scene entry of the shot.
void append_tree(Scene& scene, const Scene& file, const Tables& tables, const SceneFileRequest& request) {
    SceneFile entry = file.files.front();
    entry.id = request.id;
    entry.path = request.path;
    entry.first_node = static_cast<int>(scene.nodes.size());
    entry.node_count = static_cast<int>(file.nodes.size());
    entry.first_clip = static_cast<int>(scene.clips.size());
    entry.clip_count = static_cast<int>(file.clips.size());
    entry.first_material = tables.material;
    entry.material_count = tables.material_count;
    for (int& root : entry.roots) root += entry.first_node;
    for (Node node : file.nodes) {
        node.parent = shifted(node.parent, entry.first_node);
        for (int& child : node.children) child += entry.first_node;
        for (MeshPrimitive& primitive : node.primitives) {
            primitive.geometry += tables.geometry;
            primitive.material += tables.material;
            for (VariantMaterial& variant : primitive.variants) variant.material += tables.material;
        }
        node.placement_set = shifted(node.placement_set, tables.placement_set);
        node.light = shifted(node.light, tables.light);
        node.camera = shifted(node.camera, tables.camera);
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
        for (PropertyChannel& channel : clip.properties) channel.index += first_index_of(channel.property, entry, tables);
        scene.clips.push_back(std::move(clip));
    }
    scene.files.push_back(std::move(entry));
}

/// The path by which requests for the same file are known.
std::string key_of(const SceneFileRequest& request) {
    std::error_code failed;
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(request.path, failed);
    return failed ? request.path.string() : canonical.string();
}

void add(ClipChoice& choice, const ClipChoice& more) {
    choice.all = choice.all || more.all;
    choice.names.insert(choice.names.end(), more.names.begin(), more.names.end());
    choice.numbers.insert(choice.numbers.end(), more.numbers.begin(), more.numbers.end());
}

void append_all(std::vector<Diagnostic>& to, std::vector<Diagnostic> from) { std::move(from.begin(), from.end(), std::back_inserter(to)); }

/// Empties the slots that are not needed. @return which textures the others show
std::vector<bool> keep_slots(Scene& scene, const SceneNeeds& needs) {
    std::vector<bool> shown(scene.textures.size(), false);
    for (std::size_t material = 0; material < scene.materials.size(); ++material) {
        const TextureSlots slots = slots_of(scene.materials[material]);
        for (std::size_t use = 0; use < slots.size(); ++use) {
            if (!needs.textures[material][use]) *slots[use] = {};
            if (slots[use]->texture >= 0) shown[index(slots[use]->texture)] = true;
        }
    }
    return shown;
}

/// Textures of no material that needs them leave the table.
void drop_textures(Scene& scene, const std::vector<bool>& needed) {
    std::vector<int> place(scene.textures.size(), -1);
    std::vector<TextureData> kept;
    for (std::size_t i = 0; i < place.size(); ++i) {
        if (!needed[i]) continue;
        place[i] = static_cast<int>(kept.size());
        kept.push_back(std::move(scene.textures[i]));
    }
    scene.textures = std::move(kept);
    for (kernels::Material& material : scene.materials)
        for (kernels::TextureSlot* slot : slots_of(material))
            if (slot->texture >= 0) slot->texture = place[index(slot->texture)];
}

/// Geometries that were not read, or have nothing to draw, leave the table, and the primitives that show them their nodes.
void drop_geometries(Scene& scene) {
    std::vector<int> place(scene.geometries.size(), -1);
    std::vector<GeometryData> kept;
    for (std::size_t i = 0; i < place.size(); ++i) {
        if (scene.geometries[i].indices.empty()) continue;
        place[i] = static_cast<int>(kept.size());
        kept.push_back(std::move(scene.geometries[i]));
    }
    scene.geometries = std::move(kept);
    for (Node& node : scene.nodes) {
        std::erase_if(node.primitives, [&](const MeshPrimitive& primitive) { return place[index(primitive.geometry)] < 0; });
        for (MeshPrimitive& primitive : node.primitives) primitive.geometry = place[index(primitive.geometry)];
    }
}

}  // namespace

struct SceneFiles::Part {
    FileLoader loader;
    Tables tables;
    Scene tree;  ///< of which every entry gets its own; empty once all have
};

SceneFiles::SceneFiles(const std::vector<SceneFileRequest>& requests) {
    std::map<std::string, ClipChoice> clips;
    for (const SceneFileRequest& request : requests) add(clips.try_emplace(key_of(request), ClipChoice{false, {}, {}}).first->second, request.clips);
    std::map<std::string, std::size_t> known;
    for (const SceneFileRequest& request : requests) {
        const auto [place, fresh] = known.try_emplace(key_of(request), parts_.size());
        if (fresh) {
            parts_.push_back(std::unique_ptr<Part>(new Part{FileLoader(request.path, request.where), {}, {}}));
            Part& part = *parts_.back();
            SceneOutline file = part.loader.outline(clips.at(place->first));
            part.tables = append_tables(outline_, file);
            part.tree = std::move(file.scene);
            append_all(outline_.scene.warnings, part.loader.take_warnings());
        }
        entries_.push_back({place->second, outline_.scene.skins.size()});
        append_tree(outline_.scene, parts_[place->second]->tree, parts_[place->second]->tables, request);
    }
    for (const auto& part : parts_) part->tree = {};
}

SceneFiles::~SceneFiles() = default;

Scene SceneFiles::load(const SceneNeeds& needs, const LoadOptions& options) && {
    Scene scene = std::move(outline_.scene);
    const std::vector<bool> textures = keep_slots(scene, needs);
    for (const auto& part : parts_) {
        const Tables& tables = part->tables;
        const auto of_file = [](auto& table, int first, int count) { return std::span(table).subspan(index(first), index(count)); };
        part->loader.load_geometries(of_file(needs.geometries, tables.geometry, tables.geometry_count), of_file(scene.geometries, tables.geometry, tables.geometry_count));
        part->loader.load_textures(options, {textures.begin() + tables.texture, textures.begin() + tables.texture + tables.texture_count},
                                   of_file(scene.textures, tables.texture, tables.texture_count));
    }
    for (std::size_t entry = 0; entry < entries_.size(); ++entry) {
        const std::size_t first = entries_[entry].first_skin, end = entry + 1 < entries_.size() ? entries_[entry + 1].first_skin : scene.skins.size();
        for (std::size_t skin = first; skin < end; ++skin)
            if (needs.skins[skin]) scene.skins[skin].inverse_bind = parts_[entries_[entry].part]->loader.bind_matrices(skin - first);
    }
    for (std::size_t entry = 0; entry < entries_.size(); ++entry) {
        scene.files[entry].content = parts_[entries_[entry].part]->loader.content();
        scene.files[entry].read_bytes = parts_[entries_[entry].part]->loader.read_bytes();
    }
    for (const auto& part : parts_) append_all(scene.warnings, part->loader.take_warnings());
    drop_textures(scene, textures);
    drop_geometries(scene);
    parts_.clear();
    return scene;
}

kernels::Texture TextureData::view() const { return {texels.data(), width, height, format, wrap_s, wrap_t, nearest}; }

SceneNeeds everything_of(const SceneOutline& outline) {
    SceneNeeds needs;
    needs.geometries.assign(outline.scene.geometries.size(), {true, {true, true}, true, true, true, true});
    needs.textures.assign(outline.scene.materials.size(), {true, true, true, true, true});
    needs.skins.assign(outline.scene.skins.size(), true);
    return needs;
}

Scene load_scene(const std::vector<SceneFileRequest>& requests, const LoadOptions& options) {
    SceneFiles files(requests);
    const SceneNeeds all = everything_of(files.outline());
    return std::move(files).load(all, options);
}

}  // namespace kadr
