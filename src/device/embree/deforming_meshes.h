#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "device/embree/bounds_tree.h"
#include "device/embree/embree_api.h"
#include "device/embree/geometry_user.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// Meshes that bend, each in a structure of its own that instances show.
///
/// A mesh keeps its structure from frame to frame. One whose vertices did not change is not touched. One that keeps its
/// shape while the shutter is open is refitted until a measure of the structure's quality says that rays would become
/// more than a fifth slower, and built anew then. One that bends while the shutter is open is built anew in every frame:
/// Embree refits no structure with several keys.
class DeformingMeshes {
public:
    DeformingMeshes(RTCDevice device, const Scene& scene) : device_(device), scene_(scene) {}

    /// Brings the structures up to date and appends what the kernels fetch to `geometries`, one entry for each pair of
    /// a deformed mesh of the snapshot and a material that it is shown with.
    void set_frame(const SceneSnapshot& snapshot, const kernels::SceneView& view, bool cull_backfaces, std::vector<kernels::Geometry>& geometries);
    /// Positions one frame earlier, for the motion layer.
    void set_previous(const SceneSnapshot& snapshot, std::vector<kernels::Geometry>& geometries);

    /// Of an instance of the snapshot that set_frame saw: its structure, and its place among the kernels' geometries.
    RTCScene structure(const SnapshotInstance& instance) const { return find(instance).structure.get(); }
    unsigned geometry(const SnapshotInstance& instance) const { return find(instance).user->geometry; }

    bool bends() const { return bends_; }  ///< whether any mesh bends while the shutter is open
    std::uint64_t built() const { return built_; }        ///< structures built anew for this frame
    std::uint64_t refitted() const { return refitted_; }  ///< structures refitted for this frame

private:
    struct Entry {
        std::shared_ptr<const DeformedMesh> mesh;  ///< the vertices that the structure points at
        EmbreeSceneHandle structure;
        EmbreeGeometryHandle triangles;
        std::unique_ptr<GeometryUser> user;        ///< whose address Embree keeps
        BoundsTree bounds;
        double cost_when_built = 0;
        std::vector<kernels::Vec3f> previous;
    };
    using Key = std::pair<unsigned, unsigned>;     ///< deformer, material

    const Entry& find(const SnapshotInstance& instance) const;
    void update(Entry& entry, const std::shared_ptr<const DeformedMesh>& mesh, const kernels::Material& material, bool cull_backfaces);
    void create(Entry& entry, const kernels::Material& material, bool cull_backfaces);
    void point_at(Entry& entry, const DeformedMesh& mesh);
    kernels::Geometry view_of(const Entry& entry) const;

    RTCDevice device_;
    const Scene& scene_;
    std::map<Key, Entry> entries_;
    std::vector<unsigned> deformer_of_;  ///< [deformed mesh of the snapshot]
    bool bends_ = false;
    std::uint64_t built_ = 0, refitted_ = 0;
};

}  // namespace kadr
