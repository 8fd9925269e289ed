#pragma once

#include <string>

#include "frame/snapshot.h"

namespace kadr {

/// "scene/Parent/Node" of the node that an instance shows a mesh of.
std::string node_path_of(const BoundShot& shot, const SnapshotInstance& instance);

}  // namespace kadr
