#include "frame/material_rig.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
#include "frame/change.h"
#include "frame/problem.h"

namespace kadr {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

std::string suggestion(const std::string& word, const std::vector<std::string>& names, const char* what) {
    if (const auto nearest = nearest_name(word, names)) return fmt::format("did you mean '{}'?", *nearest);
    if (names.empty()) return fmt::format("the file has no {}; remove the key", what);
    return fmt::format("expected one of the file's {}: {}", what, fmt::join(names, ", "));
}

/// Names of the materials that an entry shows, each once.
std::vector<std::string> material_names(const Scene& scene, const SceneFile& file) {
    std::vector<std::string> names;
    for (int m = file.first_material; m < file.first_material + file.material_count; ++m)
        if (std::find(names.begin(), names.end(), scene.material_names[index(m)]) == names.end()) names.push_back(scene.material_names[index(m)]);
    return names;
}

/// The factors that tracks replace, before they are multiplied.
struct Factors {
    kernels::Material material;
    MaterialSource source;
    void set(const DrivenProperty& driven, double time_s, double clip_offset_s);
    kernels::Material made() const;
};

float to_float(double value) { return static_cast<float>(value); }

void Factors::set(const DrivenProperty& driven, double time_s, double clip_offset_s) {
    TextureTransform& transform = source.transforms[static_cast<std::size_t>(driven.use)];
    const auto value = [&]<class T>(const T& own) { return driven.value(own, time_s, clip_offset_s); };
    const auto replace = [&](float& factor) { factor = to_float(value(static_cast<double>(factor))); };
    switch (driven.property) {
        case Property::base_color: {
            const glm::dvec3 color = value(glm::dvec3(material.base_color.x, material.base_color.y, material.base_color.z));
            material.base_color = {to_float(color.x), to_float(color.y), to_float(color.z)};
            return;
        }
        case Property::alpha: return replace(material.alpha);
        case Property::metallic: return replace(material.metallic);
        case Property::roughness: return replace(material.roughness);
        case Property::emissive: source.emissive = value(source.emissive); return;
        case Property::emissive_strength: source.emissive_strength = value(source.emissive_strength); return;
        case Property::ior: source.ior = value(source.ior); return;
        case Property::alpha_cutoff: return replace(material.alpha_cutoff);
        case Property::normal_scale: return replace(material.normal_scale);
        case Property::occlusion_strength: return replace(material.occlusion_strength);
        case Property::texture_offset: transform.offset = value(transform.offset); return;
        case Property::texture_rotation: transform.rotation_rad = value(transform.rotation_rad); return;
        case Property::texture_scale: transform.scale = value(transform.scale); return;
        default: return;
    }
}

kernels::Material Factors::made() const {
    kernels::Material result = material;
    const glm::dvec3 emission = source.emissive * source.emissive_strength;
    result.emission = {static_cast<float>(emission.x), static_cast<float>(emission.y), static_cast<float>(emission.z)};
    result.dielectric_f0 = dielectric_f0(source.ior);
    kernels::TextureSlot* const slots[] = {&result.base_color_texture, &result.metallic_roughness_texture, &result.normal_texture,
                                           &result.emissive_texture, &result.occlusion_texture};
    for (std::size_t use = 0; use < std::size(slots); ++use) *slots[use] = transformed(*slots[use], source.transforms[use]);
    return result;
}

template <class T>
void drive(std::vector<DrivenProperty>& all, Property property, const std::optional<Track<T>>& track) {
    if (!track) return;
    LayeredTrack<T> own;
    add_part(own, 0, *track);
    all.push_back({property, TextureUse::base_color, std::move(own), {}});
}

void drive_all(std::vector<DrivenProperty>& all, const MaterialSpec& spec) {
    drive(all, Property::base_color, spec.base_color);
    drive(all, Property::metallic, spec.metallic);
    drive(all, Property::roughness, spec.roughness);
    drive(all, Property::ior, spec.ior);
    drive(all, Property::emissive, spec.emissive);
    drive(all, Property::emissive_strength, spec.emissive_strength);
    drive(all, Property::alpha, spec.alpha);
    drive(all, Property::alpha_cutoff, spec.alpha_cutoff);
    drive(all, Property::normal_scale, spec.normal_scale);
}

using Materials = std::array<kernels::Material, kChangeSteps>;

template <class Value>
Changing each(const Materials& at, Value value) {
    Changing values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(at[i]);
    return values;
}

constexpr float kernels::Vec3f::*kChannels[] = {&kernels::Vec3f::x, &kernels::Vec3f::y, &kernels::Vec3f::z};

bool factors_spread(const Materials& at) {
    using M = kernels::Material;
    constexpr double kFactor = 1.0 / 8;
    for (const auto channel : kChannels)
        if (spreads(each(at, [channel](const M& m) { return m.base_color.*channel; }), kFactor)) return true;
    for (const auto factor : {&M::alpha, &M::metallic, &M::roughness, &M::dielectric_f0, &M::alpha_cutoff, &M::normal_scale})
        if (spreads(each(at, [factor](const M& m) { return m.*factor; }), kFactor)) return true;
    return false;
}

bool emission_bends(const Materials& at) {
    for (const auto channel : kChannels)
        if (bends(each(at, [channel](const kernels::Material& m) { return m.emission.*channel; }))) return true;
    return false;
}

bool textures_move(const Materials& at) {
    using M = kernels::Material;
    using S = kernels::TextureSlot;
    constexpr double kTexture = 1.0 / 256;
    for (const auto slot : {&M::base_color_texture, &M::metallic_roughness_texture, &M::normal_texture, &M::emissive_texture})
        for (const auto entry : {&S::m00, &S::m01, &S::m02, &S::m10, &S::m11, &S::m12})
            if ((at[0].*slot).texture >= 0 && spreads(each(at, [slot, entry](const M& m) { return m.*slot.*entry; }), kTexture)) return true;
    return false;
}

/// A mesh has a structure of its own for every material that it is seen with.
constexpr std::size_t kMostMaterialCopies = 1024;

[[noreturn]] void refuse_copies(const SceneSpec& spec, const std::string& material, std::size_t count) {
    throw InputError(problem_at(spec.instances->where, fmt::format("copies play clips at {} different times, and the clips change material '{}' of scene '{}'", count, material, spec.id),
                                fmt::format("expected at most {}: every time needs a material of its own; take fewer copies, or offsets that repeat", kMostMaterialCopies)));
}

}  // namespace

void check_appearance(const Scene& scene, std::size_t entry, const SceneSpec& spec) {
    const SceneFile& file = scene.files[entry];
    std::vector<Diagnostic> problems;
    if (spec.variant && std::find(file.variants.begin(), file.variants.end(), *spec.variant) == file.variants.end())
        problems.push_back(problem_at(spec.variant_where, fmt::format("scene '{}' has no variant '{}'", spec.id, *spec.variant),
                                      suggestion(*spec.variant, file.variants, "variants")));
    const std::vector<std::string> names = material_names(scene, file);
    for (const MaterialSpec& material : spec.materials)
        if (std::find(names.begin(), names.end(), material.name) == names.end())
            problems.push_back(problem_at(material.where, fmt::format("scene '{}' shows no material '{}'", spec.id, material.name),
                                          suggestion(material.name, names, "materials")));
    if (!problems.empty()) throw InputError(std::move(problems));
}

MaterialRig::MaterialRig(const Shot& shot, const Scene& scene, const PropertyRig& properties, const ClipOffsets& offsets) : scene_(&scene) {
    for (std::size_t entry = 0; entry < scene.files.size(); ++entry) add_entry(shot, entry, properties, offsets[entry]);
}

void MaterialRig::add_entry(const Shot& shot, std::size_t entry, const PropertyRig& properties, const std::vector<double>& offsets_s) {
    const SceneFile& file = scene_->files[entry];
    const SceneSpec& spec = shot.scenes.at(entry);
    const auto variant = spec.variant ? std::find(file.variants.begin(), file.variants.end(), *spec.variant) : file.variants.end();
    variant_.push_back(variant == file.variants.end() ? -1 : static_cast<int>(variant - file.variants.begin()));
    for (int material = file.first_material; material < file.first_material + file.material_count; ++material) {
        Own own{material};
        const int in_file = scene_->material_sources[index(material)].index;
        if (in_file >= 0) own.driven = properties.of(static_cast<int>(entry), PropertyOwner::material, in_file);
        if (std::any_of(own.driven.begin(), own.driven.end(), [](const DrivenProperty& driven) { return driven.follows_clips(); })) own.offsets_s = offsets_s;
        if (own.offsets_s.size() > kMostMaterialCopies) refuse_copies(spec, scene_->material_names[index(material)], own.offsets_s.size());
        for (const MaterialSpec& change : spec.materials) {
            if (change.name != scene_->material_names[index(material)]) continue;
            own.blends = change.alpha.has_value();
            drive_all(own.driven, change);
        }
        if (own.driven.empty()) continue;
        own.first = own_.empty() ? scene_->materials.size() : own_.back().first + own_.back().offsets_s.size();
        copy_of_[{static_cast<int>(entry), material}] = static_cast<int>(own.first);
        own_.push_back(std::move(own));
    }
}

int MaterialRig::material_of(int entry, const MeshPrimitive& primitive) const {
    int material = primitive.material;
    for (const VariantMaterial& variant : primitive.variants)
        if (variant.variant == variant_[index(entry)]) material = variant.material;
    const auto copy = copy_of_.find({entry, material});
    return copy == copy_of_.end() ? material : copy->second;
}

const MaterialRig::Own* MaterialRig::own_at(std::uint32_t material) const {
    const auto after = std::upper_bound(own_.begin(), own_.end(), material, [](std::uint32_t m, const Own& own) { return m < own.first; });
    return after == own_.begin() ? nullptr : &after[-1];
}

std::uint32_t MaterialRig::material_in_copy(std::uint32_t material, double clip_offset_s) const {
    const Own* own = own_at(material);
    if (!own || own->offsets_s.size() == 1) return material;
    const auto at = std::lower_bound(own->offsets_s.begin(), own->offsets_s.end(), clip_offset_s);
    return static_cast<std::uint32_t>(own->first + static_cast<std::size_t>(at - own->offsets_s.begin()));
}

kernels::Material MaterialRig::evaluate(const Own& own, double time_s, double clip_offset_s) const {
    Factors factors{scene_->materials[index(own.original)], scene_->material_sources[index(own.original)]};
    for (const DrivenProperty& driven : own.driven) factors.set(driven, time_s, clip_offset_s);
    if (own.blends && factors.material.alpha_mode == kernels::AlphaMode::opaque) factors.material.alpha_mode = kernels::AlphaMode::blend;
    return factors.made();
}

std::vector<kernels::Material> MaterialRig::table(double time_s) const {
    std::vector<kernels::Material> all;
    if (own_.empty()) return all;
    all = scene_->materials;
    for (const Own& own : own_)
        for (const double offset : own.offsets_s) all.push_back(evaluate(own, time_s, offset));
    return all;
}

int MaterialRig::source_of(std::uint32_t material) const {
    const Own* own = own_at(material);
    return own ? own->original : static_cast<int>(material);
}

const kernels::Material& MaterialRig::original_of(std::uint32_t material) const { return scene_->materials[index(source_of(material))]; }

bool MaterialRig::may_emit(std::uint32_t material) const { return original_of(material).unlit || may_light(material); }

/// Whether the shot turns emission off for good: its word on a property is the last one.
bool MaterialRig::put_out(const Own& own) {
    for (const Property property : {Property::emissive, Property::emissive_strength}) {
        const auto last = std::find_if(own.driven.rbegin(), own.driven.rend(), [property](const DrivenProperty& driven) { return driven.property == property; });
        if (last == own.driven.rend() || last->layers) continue;
        const auto is_zero = [](const auto& key) { return key.value == decltype(key.value){}; };
        const auto all_zero = [&](const auto& mix) {
            const auto& keys = mix.parts.front().track->keys;
            return std::all_of(keys.begin(), keys.end(), is_zero);
        };
        if (std::visit(all_zero, last->track)) return true;
    }
    return false;
}

bool MaterialRig::may_light(std::uint32_t material) const {
    const kernels::Material& original = original_of(material);
    if (original.unlit) return false;
    const bool shines = original.emission.x > 0 || original.emission.y > 0 || original.emission.z > 0;
    const Own* own = own_at(material);
    if (!own) return shines;
    return !put_out(*own) && (shines || std::any_of(own->driven.begin(), own->driven.end(), [](const DrivenProperty& driven) {
        return driven.property == Property::emissive || driven.property == Property::emissive_strength;
    }));
}

bool MaterialRig::changes_fast(double begin_s, double end_s) const {
    const auto fast = [&](const Own& own, double clip_offset_s) {
        std::array<kernels::Material, kChangeSteps> at;
        for (int i = 0; i < kChangeSteps; ++i) at[index(i)] = evaluate(own, begin_s + (end_s - begin_s) * i / (kChangeSteps - 1), clip_offset_s);
        return factors_spread(at) || emission_bends(at) || textures_move(at);
    };
    return std::any_of(own_.begin(), own_.end(), [&](const Own& own) {
        return std::any_of(own.offsets_s.begin(), own.offsets_s.end(), [&](double offset) { return fast(own, offset); });
    });
}

std::vector<double> MaterialRig::discontinuities(double begin_s, double end_s) const {
    std::vector<double> times;
    for (const Own& own : own_)
        for (const DrivenProperty& driven : own.driven)
            for (const double offset : own.offsets_s) {
                const std::vector<double> more = driven.discontinuities(begin_s, end_s, offset);
                times.insert(times.end(), more.begin(), more.end());
            }
    return times;
}

}  // namespace kadr
