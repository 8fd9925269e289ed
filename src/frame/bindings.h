#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "frame/clip_offsets.h"
#include "frame/deformer.h"
#include "frame/instance_list.h"
#include "frame/material_rig.h"
#include "frame/morph_rig.h"
#include "frame/node_rig.h"
#include "frame/placed_instances.h"
#include "frame/property_rig.h"
#include "frame/references.h"
#include "frame/visibility_rig.h"

namespace kadr {

/// A light of a node, in one copy of its scene.
struct LightSeed {
    int node = -1;
    const Placement* copy = nullptr;  ///< null: the scene is not repeated
    double clip_offset_s() const { return copy ? copy->clip_offset_s : 0; }
};

/// What binding a shot to its scenes finds out once, for every frame to use.
struct Bindings {
    NodeRig rig;
    std::map<std::string, ResolvedReference> references;
    std::vector<InstanceSeed> seeds;    ///< of nodes that a root reaches
    InstanceList instances;             ///< every copy of every seed
    std::vector<IdRange> still;         ///< instances that look and stand the same throughout the shot
    std::vector<IdRange> changing;      ///< the others
    ClipOffsets entry_offsets_s;
    std::vector<double> clip_offsets_s; ///< of all copies, each once, ascending; 0 among them
    std::vector<LightSeed> lights;      ///< lights of the scenes that shine
    int camera_node = -1;               ///< of an authored camera
    PropertyRig properties;
    VisibilityRig visibility;
    MaterialRig materials;
    MorphRig morphs;
    std::vector<Deformer> deformers;    ///< of seeds whose vertices bend; numbers of their meshes ascend
    std::shared_ptr<StillInstances> still_places = std::make_shared<StillInstances>();
    std::shared_ptr<DeformedCache> deformed = std::make_shared<DeformedCache>();

    /// world_from_node of an instance, or of a light's copy. @param copy null: the scene is not repeated
    glm::dmat4 node_transform(int node, const Placement* copy, double time_s) const;
    /// The first copy of a file, which references of the shot mean; null: it is not repeated.
    const Placement* first_copy(int file) const { return instances.copies_of(file).empty() ? nullptr : &instances.copies_of(file).front(); }
    double first_offset_s(int file) const { return first_copy(file) ? first_copy(file)->clip_offset_s : 0; }
    /// Keys inside (begin, end) of a node in the first copy and of all above it.
    std::vector<double> key_times_of(int node, double begin_s, double end_s) const { return rig.key_times_of(node, begin_s, end_s, first_offset_s(rig.file_of(node))); }
    /// world_from_node of the first copy.
    glm::dmat4 node_transform(int node, double time_s) const { return node_transform(node, first_copy(rig.file_of(node)), time_s); }
    /// World position of a node or of a scene's root.
    glm::dvec3 position_of(const NodeReference& reference, double time_s) const;
    const InstanceSeed& seed_of(std::uint32_t id) const { return *instances[id].seed; }
    /// Number of the mesh that an instance with a deformer shows.
    std::uint32_t bent_mesh_of(const Instance& instance) const;
    BentMesh bent_mesh(std::uint32_t number) const;
    /// node_from_geometry of a seed: where its normalised vertices lie in the coordinates of its node.
    glm::dmat4 node_from_geometry(const Scene& scene, const InstanceSeed& seed) const;
    /// The same with the instance's own place below the node.
    glm::dmat4 copied_from_geometry(const Scene& scene, const Instance& instance) const;
};

}  // namespace kadr
