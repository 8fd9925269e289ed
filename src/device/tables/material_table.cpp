#include "device/tables/material_table.h"

#include "device/tables/least_green.h"

namespace kadr {
namespace {

bool is_zero(const kernels::Vec3f& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// The kernels::requirement bits of what a material is covered with.
unsigned needs_of_maps(const kernels::Material& m) {
    using namespace kernels::requirement;
    const bool emits = !is_zero(m.emission);  // else its texture is multiplied by nothing
    unsigned needs = m.unlit || m.alpha_mode != kernels::AlphaMode::opaque ? kMaps | kSpecials : 0;
    for (const kernels::TextureSlot* slot :
         {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emissive_texture})
        if (slot->texture >= 0 && (slot != &m.emissive_texture || emits))
            needs |= slot->uv_set == 0 ? kMaps : kMaps | kSpecials;
    return needs;
}

bool equal(const kernels::Vec3f& a, const kernels::Vec3f& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

}  // namespace

bool MaterialTable::set(const SceneSnapshot& snapshot) {
    materials_ = snapshot.materials;
    exact_fresnel_ = snapshot.settings.exact_fresnel;
    bool same = emissions_.size() == count();
    emissions_.resize(count());
    for (std::size_t i = 0; i < count(); ++i) {
        same = same && equal(emissions_[i], data()[i].emission);
        emissions_[i] = data()[i].emission;
    }
    return same;
}

void MaterialTable::note_shown(const SceneSnapshot& snapshot, std::span<const kernels::Instance> instances,
                               std::span<const kernels::Geometry> geometries) {
    std::vector<bool> seen(count(), false);
    shows_colors_ = false;
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const kernels::Geometry& geometry = geometries[instances[i].geometry];
        if (snapshot.instances[i].mask == 0 || geometry.triangle_count == 0) continue;
        seen[instances[i].material] = true;
        shows_colors_ = shows_colors_ || geometry.colors;
    }
    shown_.clear();
    for (unsigned material = 0; material < seen.size(); ++material)
        if (seen[material]) shown_.push_back(material);
    least_green_.resize(scene_.textures.size());
    for (const unsigned material : shown_) {
        const int texture = data()[material].metallic_roughness_texture.texture;
        if (texture < 0) continue;
        std::optional<float>& least = least_green_[static_cast<std::size_t>(texture)];
        if (!least) least = least_green(scene_.textures[static_cast<std::size_t>(texture)]);
    }
}

/// The kernels::requirement bits of how a material reflects.
unsigned MaterialTable::needs_of_lobe(const kernels::Material& m) const {
    using namespace kernels::requirement;
    const bool mirror = is_mirror(m, [this](int texture) { return *least_green_[static_cast<std::size_t>(texture)]; });
    const bool dielectric = !m.unlit && (m.metallic < 1 || m.metallic_roughness_texture.texture >= 0);
    return (mirror ? kMirrors : 0) | (!m.unlit && m.dielectric_f0 != kernels::kDielectricF0 ? kIor : 0) | (exact_fresnel_ && dielectric ? kFresnel : 0);
}

unsigned MaterialTable::requirements() const {
    unsigned needs = shows_colors_ ? kernels::requirement::kMaps | kernels::requirement::kSpecials : 0;
    for (const unsigned material : shown_) {
        const kernels::Material& m = data()[material];
        needs |= needs_of_maps(m) | needs_of_lobe(m);
    }
    return needs;
}

bool needs_filter(const kernels::Material& material, bool cull) {
    return material.alpha_mode != kernels::AlphaMode::opaque || (cull && !material.double_sided);
}

}  // namespace kadr
