#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "frame/frame_state.h"

namespace kadr {

/// What a shot can ask of a renderer: each costs memory, time or both, and only where it is asked for.
enum class Feature {
    integrator_path,
    integrator_direct,
    camera_lens,
    camera_orthographic,
    shutter_curve,
    shutter_rolling,
    blur_camera,
    blur_instances,
    blur_vertices,
    blur_lights,
    moves_instances,
    switches_instances,
    copies,
    skins,
    morph_targets,
    vertex_colors,
    second_uv_set,
    dielectric,
    index_of_refraction,
    exact_fresnel,
    metallic,
    mirror,
    unlit,
    alpha_mask,
    alpha_blend,
    back_face_culling,
    texture_base_color,
    texture_metallic_roughness,
    texture_normal,
    texture_emissive,
    light_directional,
    light_sun,
    light_point,
    light_sphere,
    light_spot,
    light_area,
    light_mesh,
    environment_color,
    environment_image,
    transparent_background,
    layer_albedo,
    layer_normal,
    layer_depth,
    layer_motion,
    layer_samples,
    layer_error,
    denoiser,
};

/// How a feature is spoken of.
struct FeatureInfo {
    Feature feature;
    const char* group;   ///< "textures"
    const char* name;    ///< "base colour"
    const char* askers;  ///< what asks for it, several of them: "materials"
};
/// Every feature, in the order of the enum.
std::span<const FeatureInfo> all_features();
const FeatureInfo& info_of(Feature feature);

/// A feature that a shot needs, and why.
struct Requirement {
    Feature feature;
    std::string first;      ///< the first that asks for it, as a person finds it: "material 'Visor'", "render.integrator"
    std::size_t count = 1;  ///< how many ask for it
    bool operator==(const Requirement&) const = default;
};

/// All that a shot needs over its frames, in the order of Feature.
struct RequirementSet {
    std::vector<Requirement> entries;
    const Requirement* find(Feature feature) const;
    bool needs(Feature feature) const { return find(feature) != nullptr; }
    bool operator==(const RequirementSet&) const = default;
};

/// Frames that are looked at for what changes, evenly spread over the shot.
inline constexpr std::size_t kMostFramesLookedAt = 256;

/// What a shot needs in its range of frames. Complete: what may move and was not seen to stand still counts as moving,
/// where the shot has more frames than are looked at.
RequirementSet requirements_of(const BoundShot& shot);

}  // namespace kadr
