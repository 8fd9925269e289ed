#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "device/embree/structure.h"
#include "device/embree/geometry_user.h"
#include "device/tables/bounds_tree.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// How the structure of a bending mesh follows its vertices.
enum class StructureUpdate {
    build,     ///< anew, at Embree's default quality
    build_low, ///< anew, at low quality: a quarter of the time, for rays a fifth slower
    refit,     ///< the same tree with new bounds
};

/// What is known of a mesh's structure and of its vertices in the new frame.
struct StructureState {
    unsigned keys_before = 0;  ///< of the vertices that it was made for; 0: there is none
    bool low = false;          ///< built at low quality
    unsigned keys = 1;         ///< of the new vertices
    double growth = 1;         ///< BoundsTree::cost of the tree with the new vertices over that when it was built
};

/// Growth of the tree's cost beyond which a structure is built anew. What BoundsTree measures grows more slowly than what
/// rays pay: at this growth rays through a refitted structure are up to a fifth slower than through a new one
/// (trace_structure in tools/bench/structure_bench.cpp: 1.09 and 1.19 times in two runs; 1.27 at a growth of 1.1, 1.35 at 1.2).
inline constexpr double kMostGrowth = 1.05;

/// A tree that its vertices have left is built at low quality, frame by frame while they move on as fast. Embree refits
/// only what it has built at default quality, so once they have calmed down a tree worth keeping is built. Of vertices
/// with several keys Embree builds one kind of tree and refits none.
StructureUpdate choose_update(const StructureState& state);

/// Meshes that bend, each in a structure of its own that instances show.
///
/// A mesh keeps its structure from frame to frame. One whose vertices did not change is not touched; choose_update says
/// what happens to the others.
class DeformingMeshes {
public:
    DeformingMeshes(RTCDevice device, const Scene& scene, const BuildSettings& build = {}) : device_(device), scene_(scene), build_(build) {}

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
    std::uint64_t built_low() const { return built_low_; }  ///< of those, at low quality
    std::uint64_t refitted() const { return refitted_; }  ///< structures refitted for this frame

private:
    struct Entry {
        std::shared_ptr<const DeformedMesh> mesh;  ///< the vertices that the structure points at
        EmbreeSceneHandle structure;
        EmbreeGeometryHandle triangles;
        std::unique_ptr<GeometryUser> user;        ///< whose address Embree keeps
        BoundsTree bounds;
        double cost_when_built = 0;
        bool low = false;                          ///< built at low quality
        std::vector<kernels::Vec3f> previous;
    };
    using Key = std::pair<unsigned, unsigned>;     ///< number of the mesh, material

    const Entry& find(const SnapshotInstance& instance) const;
    void update(Entry& entry, const std::shared_ptr<const DeformedMesh>& mesh, const kernels::Material& material, bool cull_backfaces);
    void create(Entry& entry, const kernels::Material& material, bool cull_backfaces, RTCBuildQuality quality);
    void point_at(Entry& entry, const DeformedMesh& mesh);

    RTCDevice device_;
    const Scene& scene_;
    BuildSettings build_;
    std::map<Key, Entry> entries_;
    std::vector<unsigned> number_of_;  ///< [deformed mesh of the snapshot]
    bool bends_ = false;
    std::uint64_t built_ = 0, built_low_ = 0, refitted_ = 0;
};

}  // namespace kadr
