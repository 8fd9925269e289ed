#pragma once

#include <map>
#include <string>
#include <vector>

#include "anim/timing.h"
#include "frame/node_rig.h"
#include "frame/references.h"

namespace kadr {

/// What the names of a shot mean in its scenes. Needs the trees of the files alone: no geometry, no textures.
struct BoundNames {
    std::vector<BoundScene> scenes;                       ///< [scene entry]
    std::map<std::string, ResolvedReference> references;  ///< by text
    int camera_node = -1;                                 ///< of an authored camera
    Timing timing;                                        ///< the shot's, with its frames filled in
};

/// @throws InputError  with all that BoundShot says of names and settings
BoundNames bind_names(const Shot& shot, const Scene& scene);

}  // namespace kadr
