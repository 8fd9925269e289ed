#pragma once

#include <string>
#include <vector>

#include "scene/scene_needs.h"
#include "shot/shot.h"

namespace kadr {

/// Something of a shot's files that the shot does not use, so that it is not read.
struct Unread {
    std::string kind;  ///< "image", "mesh", "attribute", "material", "node", "skin", "clip"
    std::string name;  ///< with the scene entry before it: "hero/Visor"
    std::string why;
    bool operator==(const Unread&) const = default;
};

struct ShotNeeds {
    SceneNeeds scene;
    std::vector<Unread> left_out;
};

/// What a shot needs of its files, whichever of its frames are rendered: so frames that are rendered apart are made from
/// the same inputs.
/// @throws InputError  as bind_names
ShotNeeds needs_of(const Shot& shot, const SceneOutline& outline);

}  // namespace kadr
