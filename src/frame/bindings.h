#pragma once

#include <map>
#include <string>
#include <vector>

#include "frame/material_rig.h"
#include "frame/node_rig.h"
#include "frame/property_rig.h"
#include "frame/references.h"
#include "frame/visibility_rig.h"

namespace kadr {

/// One primitive of one node, in the order of the nodes; its place in that order is the instance's stable id.
struct InstanceSeed {
    int node = -1;
    std::uint32_t geometry = 0, material = 0, id = 0;
};

/// What binding a shot to its scenes finds out once, for every frame to use.
struct Bindings {
    NodeRig rig;
    std::map<std::string, ResolvedReference> references;
    std::vector<InstanceSeed> seeds;    ///< of nodes that a root reaches
    std::vector<int> light_nodes;       ///< nodes with a light that shines
    int camera_node = -1;               ///< of an authored camera
    PropertyRig properties;
    VisibilityRig visibility;
    MaterialRig materials;

    /// World position of a node or of a scene's root.
    glm::dvec3 position_of(const NodeReference& reference, double time_s) const;
};

}  // namespace kadr
