#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "device/device.h"
#include "device/hiprt/gpu_bender.h"
#include "device/hiprt/gpu_mesh.h"
#include "device/hiprt/structure_builder.h"
#include "device/tables/bounds_tree.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"
#include "scene/scene.h"

namespace kadr {

/// Meshes that bend from frame to frame: their vertices are made anew (by our kernels, from poses; copied where a mesh
/// has none), and their structures, built fast, get new bounds, or are built anew once the old tree has become too bad. Those that bend while the shutter is open are boxes
/// to HIPRT, built anew for every frame.
class BendingMeshes {
public:
    /// @param kernel  of the kernels that make vertices and boxes
    BendingMeshes(const Scene& scene, StructureBuilder& builder, UploadQueue& uploads, GpuBender::KernelOf kernel)
        : scene_(scene),
          builder_(builder),
          uploads_(uploads),
          bender_(scene, builder.memory(), uploads, builder.stream(), std::move(kernel)) {}

    /// Brings what is shown up to date. @param filtered  [deformed mesh of the snapshot] rays ask our filter function
    /// @throws InputError  for a mesh that is too large, with its name
    void set_frame(const SceneSnapshot& snapshot, const std::vector<bool>& filtered);
    /// Drops the structures of meshes that are shown no more. Nothing may show them.
    void forget(const SceneSnapshot& snapshot);
    /// Positions one frame earlier, for the motion layer.
    void set_previous(const SceneSnapshot& snapshot);

    hiprt::Geometry structure(const SceneSnapshot& snapshot, int deformed) const {
        return find(snapshot, deformed).structure.handle();
    }
    kernels::Geometry host(const SceneSnapshot& snapshot, int deformed) const;
    kernels::Geometry device(const SceneSnapshot& snapshot, int deformed) const;
    std::uint64_t built() const { return built_; }
    std::uint64_t updated() const { return updated_; }
    std::uint64_t kept() const { return kept_; }
    bool empty() const { return entries_.empty(); }
    const BendingCounts& counts() const { return counts_; }
    bool blurs() const { return blurs_; }  ///< whether some mesh bends while the shutter is open

private:
    struct Entry {
        std::shared_ptr<const DeformedMesh> mesh;  ///< the vertices that the structure was made for; null: none
        GpuMesh data;
        HiprtGeometry structure;
        bool filtered = false;
        BoundsTree bounds;
        double cost_when_built = 0;
    };
    const Entry& find(const SceneSnapshot& snapshot, int deformed) const;
    kernels::Geometry host_of(const DeformedMesh& mesh) const;
    void update(Entry& entry, const std::shared_ptr<const DeformedMesh>& mesh, bool filtered);
    void place_vertices(Entry& entry, const DeformedMesh& mesh);

    const Scene& scene_;
    StructureBuilder& builder_;
    UploadQueue& uploads_;
    GpuBender bender_;
    std::map<std::uint32_t, Entry> entries_;  ///< by number of the mesh
    std::uint64_t built_ = 0, updated_ = 0, kept_ = 0;
    BendingCounts counts_;
    bool blurs_ = false;
};

}  // namespace kadr
