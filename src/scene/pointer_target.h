#pragma once

#include <optional>
#include <string>
#include <variant>

#include "scene/gltf_document.h"
#include "scene/property_channel.h"

namespace kadr {

/// What a pointer of KHR_animation_pointer names.
struct PointerTarget {
    int node = -1;          ///< of a node's own transform or weights: as if the channel named them itself; -1: a property
    std::string node_path;  ///< "translation", "rotation", "scale", "weights"
    Property property = Property::node_visible;
    TextureUse use = TextureUse::base_color;
    int index = -1;         ///< as the file numbers nodes, materials, lights and cameras
    int components = 1;     ///< of the sampler's output; base colours have four: colour and alpha
    bool is_switch = false; ///< boolean: unsigned bytes, in steps
};

/// @param where  JSON pointer of the member that holds the text, for messages
/// @return none for a property that Kadr does not animate
/// @throws InputError  for text that is no JSON pointer, or an object that the file does not have
std::optional<PointerTarget> parse_pointer(const GltfDocument& document, const std::string& text, const std::string& where);

}  // namespace kadr
