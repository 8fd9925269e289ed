#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "frame/deformer.h"
#include "frame/material_rig.h"
#include "frame/morph_rig.h"
#include "frame/node_rig.h"
#include "frame/property_rig.h"
#include "frame/references.h"
#include "frame/visibility_rig.h"

namespace kadr {

/// One primitive of one node, in the order of the nodes; its place in that order is the instance's stable id.
struct InstanceSeed {
    int node = -1;      ///< that places it: of a skinned mesh the root of its skin, else the node that has the mesh
    std::uint32_t geometry = 0, material = 0, id = 0;
    int mesh_node = -1; ///< that has the mesh
    int deformer = -1;  ///< index into Bindings::deformers; -1: rigid
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
    MorphRig morphs;
    std::vector<Deformer> deformers;    ///< of seeds whose vertices bend
    std::shared_ptr<DeformedCache> deformed = std::make_shared<DeformedCache>();

    /// World position of a node or of a scene's root.
    glm::dvec3 position_of(const NodeReference& reference, double time_s) const;
    /// The seed of an instance; there is one.
    const InstanceSeed& seed_of(std::uint32_t id) const;
    /// node_from_geometry of a seed: where its normalised vertices lie in the coordinates of its node.
    glm::dmat4 node_from_geometry(const Scene& scene, const InstanceSeed& seed) const;
};

}  // namespace kadr
