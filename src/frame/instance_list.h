#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "anim/placement.h"
#include "scene/scene.h"

namespace kadr {

/// One primitive of one node, in the order of the nodes.
struct InstanceSeed {
    int node = -1;      ///< that places it: of a skinned mesh the root of its skin, else the node that has the mesh
    std::uint32_t geometry = 0, material = 0;
    int mesh_node = -1; ///< that has the mesh
    int deformer = -1;  ///< index into Bindings::deformers; -1: rigid
};

/// One thing to be seen: world_from_geometry = world_from_scene * copy * scene_from_node * local * node_from_geometry.
struct Instance {
    const InstanceSeed* seed = nullptr;
    const Placement* copy = nullptr;   ///< of the whole scene; null: it is not repeated
    const Placement* local = nullptr;  ///< of the node's meshes (EXT_mesh_gpu_instancing); null: in the node's own place
    std::uint32_t id = 0;              ///< its place in the list: stable over the shot
    double clip_offset_s() const { return copy ? copy->clip_offset_s : 0; }
};

/// The instances [first, first + count) of a list.
struct IdRange {
    std::size_t first = 0, count = 0;
};

/// All instances of a shot. Only the placements of copies are stored: an instance is put together when it is asked for,
/// so that a copy of a scene costs its 56 bytes here, whatever the scene holds.
class InstanceList {
public:
    InstanceList() = default;
    /// @param seeds   in the order of the nodes; stay where they are
    /// @param copies  [file]; empty: the scene is not repeated
    InstanceList(std::span<const InstanceSeed> seeds, const Scene& scene, std::vector<std::vector<Placement>> copies);
    InstanceList(InstanceList&&) = default;
    InstanceList& operator=(InstanceList&&) = default;

    std::size_t size() const { return size_; }
    Instance operator[](std::size_t id) const;
    /// Those from `first` on.
    std::vector<Instance> range(std::size_t first, std::size_t count) const;
    /// All instances of the seeds that are chosen, as few ranges as possible.
    std::vector<IdRange> of_seeds(const std::function<bool(const InstanceSeed&)>& chosen) const;
    /// Copies of a file of the shot; empty: it is not repeated.
    std::span<const Placement> copies_of(int file) const { return copies_[static_cast<std::size_t>(file)]; }
    /// Bytes that are kept beside the seeds and the scene.
    std::size_t bytes() const;

private:
    /// The instances of one seed: every copy, and in it every local place.
    struct Group {
        const InstanceSeed* seed;
        std::span<const Placement> copies, locals;
        std::size_t first;
    };
    Instance of_group(const Group& group, std::size_t id) const;

    std::vector<std::vector<Placement>> copies_;
    std::vector<Group> groups_;
    std::size_t size_ = 0;
};

}  // namespace kadr
