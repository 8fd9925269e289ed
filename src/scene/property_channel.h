#pragma once

#include <variant>

#include <glm/glm.hpp>

#include "anim/track.h"

namespace kadr {

/// What can change over time beside a node's transform.
enum class Property {
    node_visible,
    base_color,
    alpha,
    metallic,
    roughness,
    emissive,
    emissive_strength,
    ior,
    alpha_cutoff,
    normal_scale,
    occlusion_strength,
    texture_offset,
    texture_rotation,
    texture_scale,
    light_color,
    light_intensity,
    light_range,
    light_inner,
    light_outer,
    camera_yfov,
    camera_xmag,
    camera_ymag,
    camera_znear,
    camera_zfar,
};

/// What a property belongs to.
enum class PropertyOwner { node, material, light, camera };

constexpr PropertyOwner owner_of(Property property) {
    if (property == Property::node_visible) return PropertyOwner::node;
    if (property < Property::light_color) return PropertyOwner::material;
    return property < Property::camera_yfov ? PropertyOwner::light : PropertyOwner::camera;
}

/// The textures of a material that can be moved, in the order of MaterialSource::transforms.
enum class TextureUse { base_color, metallic_roughness, normal, emissive, occlusion };
inline constexpr int kTextureUses = 5;

/// Numbers (switches are 1 and 0, in steps), pairs, colours.
using PropertyTrack = std::variant<Track<double>, Track<glm::dvec2>, Track<glm::dvec3>>;

/// One property that a clip drives (KHR_animation_pointer).
struct PropertyChannel {
    Property property = Property::node_visible;
    int index = -1;   ///< node, light, camera: into the Scene's table; material: as the file numbers it
    TextureUse use = TextureUse::base_color;  ///< of texture_offset, texture_rotation and texture_scale
    PropertyTrack track;
};

}  // namespace kadr
