#include "frame/shot_needs.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "frame/bind_names.h"
#include "frame/material_rig.h"
#include "frame/morph_rig.h"
#include "frame/problem.h"
#include "frame/visibility_rig.h"

namespace kadr {

namespace {

constexpr const char* kOcclusion = "baked occlusion imitates what both integrators trace";

std::size_t index(int i) { return static_cast<std::size_t>(i); }

std::array<const kernels::TextureSlot*, kTextureUses> slots_of(const kernels::Material& m) {
    return {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emissive_texture, &m.occlusion_texture};
}

/// Why a material that is shown does not need one of its textures; null: it does.
const char* why_not(TextureUse use, const kernels::Material& material, bool lights) {
    if (use == TextureUse::occlusion) return kOcclusion;
    if (use != TextureUse::base_color && material.unlit) return "its materials are unlit";
    if (use == TextureUse::emissive && !lights) return "its materials never emit";
    return nullptr;
}

/// The walk through the nodes that a shot shows.
class Walk {
public:
    Walk(const Shot& shot, const SceneOutline& outline)
        : shot_(shot), outline_(outline), scene_(outline.scene), names_(bind_names(shot, scene_)), rig_(shot, scene_, names_.scenes), properties_(scene_, names_.scenes),
          visibility_(shot, scene_, names_.scenes, properties_), materials_(shot, scene_, properties_, ClipOffsets(scene_.files.size(), {0.0})), morphs_(scene_, names_.scenes) {
        needs_.geometries.resize(scene_.geometries.size());
        needs_.textures.resize(scene_.materials.size());
        needs_.skins.resize(scene_.skins.size());
        worn_.resize(scene_.materials.size());
    }

    ShotNeeds find() {
        for (std::size_t node = 0; node < scene_.nodes.size(); ++node) visit(static_cast<int>(node));
        for (const SceneSpec& spec : shot_.scenes)
            if (spec.instances && spec.instances->scatter) add_surface(*spec.instances->scatter);
        for (std::size_t file = 0; file < scene_.files.size(); ++file) list(static_cast<int>(file));
        return {std::move(needs_), std::move(left_out_)};
    }

private:
    /// Why a node is never seen; null: it is, some time.
    const char* why_unseen(int node) const {
        if (rig_.hidden(node)) return "hide leaves it out";
        if (!rig_.reachable(node)) return "it is not in the file's default scene";
        return visibility_.never_shows(node) ? "it is never visible" : nullptr;
    }

    void visit(int node) {
        if (scene_.nodes[index(node)].primitives.empty() || why_unseen(node)) return;
        for (const MeshPrimitive& primitive : scene_.nodes[index(node)].primitives) show(node, primitive);
        if (const int skin = scene_.nodes[index(node)].skin; skin >= 0) needs_.skins[index(skin)] = true;
    }

    void show(int node, const MeshPrimitive& primitive) {
        const Node& source = scene_.nodes[index(node)];
        GeometryNeeds& geometry = needs_.geometries[index(primitive.geometry)];
        geometry.wanted = geometry.colors = true;
        geometry.skin = geometry.skin || source.skin >= 0;
        const bool weighs = std::any_of(source.weights.begin(), source.weights.end(), [](double weight) { return weight != 0; });
        geometry.targets = geometry.targets || weighs || morphs_.moves(node);
        const auto worn = static_cast<std::uint32_t>(materials_.material_of(rig_.file_of(node), primitive));
        const std::size_t material = index(materials_.source_of(worn));
        worn_[material] = true;
        const auto slots = slots_of(scene_.materials[material]);
        for (std::size_t use = 0; use < slots.size(); ++use) {
            if (slots[use]->texture < 0 || why_not(static_cast<TextureUse>(use), scene_.materials[material], materials_.may_light(worn))) continue;
            needs_.textures[material][use] = true;
            geometry.uv[index(slots[use]->uv_set)] = true;
            geometry.tangents = geometry.tangents || static_cast<TextureUse>(use) == TextureUse::normal;
        }
    }

    /// What copies are strewn on need not be seen itself.
    void add_surface(const ScatterSpec& scatter) {
        std::vector<Diagnostic> unknown;  // said by who strews
        ResolvedReference target;
        collect(unknown, [&] { target = resolve(scene_, {scatter.target, scatter.where}); });
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            const int node = static_cast<int>(i);
            if (rig_.file_of(node) != target.file || !rig_.reachable(node)) continue;
            int above = node;
            while (above >= 0 && above != target.node) above = scene_.nodes[index(above)].parent;
            if (above != target.node) continue;
            for (const MeshPrimitive& primitive : scene_.nodes[i].primitives) needs_.geometries[index(primitive.geometry)].wanted = true;
        }
    }

    void leave_out(const char* kind, int file, const std::string& name, std::string why) {
        std::string full = fmt::format("{}/{}", scene_.files[index(file)].id, name);
        if (listed_.emplace(kind, full).second) left_out_.push_back({kind, std::move(full), std::move(why)});
    }

    void list(int file) {
        const SceneFile& source = scene_.files[index(file)];
        std::set<int> geometries;
        for (int node = source.first_node; node < source.first_node + source.node_count; ++node) {
            for (const MeshPrimitive& primitive : scene_.nodes[index(node)].primitives) geometries.insert(primitive.geometry);
            const char* unseen = scene_.nodes[index(node)].primitives.empty() ? nullptr : why_unseen(node);
            if (unseen) leave_out("node", file, node_path(scene_, file, node).substr(source.id.size() + 1), unseen);
        }
        for (const int geometry : geometries) list_geometry(file, index(geometry));
        for (int material = source.first_material; material < source.first_material + source.material_count; ++material)
            if (!worn_[index(material)]) leave_out("material", file, scene_.material_names[index(material)], "nothing that is shown wears it");
        list_images(file);
        for (int node = source.first_node; node < source.first_node + source.node_count; ++node)
            if (const int skin = scene_.nodes[index(node)].skin; skin >= 0 && !needs_.skins[index(skin)]) leave_out("skin", file, skin_name(skin), "no mesh that is shown has it");
        for (int clip = source.first_clip; clip < source.first_clip + source.clip_count; ++clip)
            if (!scene_.clips[index(clip)].read) leave_out("clip", file, clip_name(source, clip), "no layer plays it");
    }

    std::string skin_name(int skin) const {
        const std::string& name = scene_.skins[index(skin)].name;
        return name.empty() ? fmt::format("skin {}", skin) : name;
    }
    std::string clip_name(const SceneFile& file, int clip) const {
        const std::string& name = scene_.clips[index(clip)].name;
        return name.empty() ? fmt::format("#{}", clip - file.first_clip) : name;
    }

    void list_geometry(int file, std::size_t geometry) {
        const std::string& name = scene_.geometries[geometry].name;
        const GeometryNeeds& needs = needs_.geometries[geometry];
        const GeometryOutline& has = outline_.geometries[geometry];
        if (!needs.wanted) return leave_out("mesh", file, name, "no node that is shown has it");
        const auto attribute = [&](bool unused, const char* which, const char* why) {
            if (unused) leave_out("attribute", file, fmt::format("{}: {}", name, which), why);
        };
        const bool normal_uv = needs.tangents;  // tangents are made along texture coordinates
        attribute(has.uv[0] && !needs.uv[0] && !normal_uv, "TEXCOORD_0", "no texture that is used follows it");
        attribute(has.uv[1] && !needs.uv[1] && !normal_uv, "TEXCOORD_1", "no texture that is used follows it");
        attribute(has.tangents && !needs.tangents, "TANGENT", "no normal texture is used");
        attribute(has.colors && !needs.colors, "COLOR_0", "only copies are strewn on it");
        attribute(has.skin && !needs.skin, "JOINTS and WEIGHTS", "no node shows it with a skin");
        attribute(has.targets > 0 && !needs.targets, "morph targets", "their weights are 0 at all times");
    }

    void list_images(int file) {
        const SceneFile& source = scene_.files[index(file)];
        std::set<std::string> needed;
        std::vector<std::pair<std::string, std::string>> unneeded;  // name, why
        for (int material = source.first_material; material < source.first_material + source.material_count; ++material) {
            const auto slots = slots_of(scene_.materials[index(material)]);
            for (std::size_t use = 0; use < slots.size(); ++use) {
                if (slots[use]->texture < 0) continue;
                const std::string& name = scene_.textures[index(slots[use]->texture)].name;
                if (needs_.textures[index(material)][use]) needed.insert(name);
                else unneeded.emplace_back(name, why_unneeded(index(material), static_cast<TextureUse>(use)));
            }
        }
        for (auto& [name, why] : unneeded)
            if (!needed.count(name)) leave_out("image", file, name, std::move(why));
        for (const std::string& name : source.unused_images) leave_out("image", file, name, "no material of a mesh names it");
    }

    std::string why_unneeded(std::size_t material, TextureUse use) const {
        if (!worn_[material]) return "its materials are on nothing that is shown";
        return why_not(use, scene_.materials[material], false);
    }

    const Shot& shot_;
    const SceneOutline& outline_;
    const Scene& scene_;
    const BoundNames names_;
    const NodeRig rig_;
    const PropertyRig properties_;
    const VisibilityRig visibility_;
    const MaterialRig materials_;
    const MorphRig morphs_;
    SceneNeeds needs_;
    std::vector<bool> worn_;  ///< [material]
    std::set<std::pair<std::string, std::string>> listed_;
    std::vector<Unread> left_out_;
};

}  // namespace

ShotNeeds needs_of(const Shot& shot, const SceneOutline& outline) { return Walk(shot, outline).find(); }

}  // namespace kadr
