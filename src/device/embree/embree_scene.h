#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "device/device.h"
#include "device/embree/deforming_meshes.h"
#include "device/embree/embree_api.h"
#include "device/embree/geometry_user.h"
#include "device/embree/instance_level.h"
#include "device/tables/emitter_tables.h"
#include "device/tables/environment_tables.h"
#include "device/tables/light_tables.h"
#include "device/tables/material_table.h"
#include "device/tables/packed_geometry.h"
#include "film/film.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// A scene as Embree and the kernels want it.
///
/// What stands still for the whole shot and is not repeated is flattened: its vertices go into the frame's render space,
/// one scene without instances, where rays are more than twice as cheap. The rest are instances of meshes in their
/// own coordinates. Geometry is built once a shot, instances when they change.
class EmbreeScene {
public:
    EmbreeScene(RTCDevice device, const Scene& scene, const Image* environment, const BuildSettings& build = {});
    ~EmbreeScene();

    void set_frame(const SceneSnapshot& snapshot);

    const kernels::SceneView& view() const { return view_; }
    RTCScene flat() const { return flat_triangles_ > 0 ? flat_.get() : nullptr; }
    RTCScene instanced() const { return instance_count_ > 0 ? upper_.scene() : nullptr; }
    unsigned requirements() const { return requirements_; }
    std::uint64_t flat_triangles() const { return flat_triangles_; }
    std::uint64_t instance_count() const { return instance_count_; }
    std::uint64_t moving_count() const { return moving_count_; }
    /// Structures built, changed and left alone by the last set_frame.
    const StructureCounts& structures() const { return structures_; }
    const DeformingMeshes& deforming() const { return deforming_; }

private:
    void build_flat(const SceneSnapshot& snapshot, const std::vector<bool>& flattened);
    void build_instances(const SceneSnapshot& snapshot, const std::vector<bool>& flattened, std::size_t first);
    void lay_out_motions(const SceneSnapshot& snapshot, const std::vector<bool>& flattened, std::size_t first);
    void set_instance(const SceneSnapshot& snapshot, std::size_t index, RTCScene mesh);
    RTCScene mesh_scene(unsigned geometry, unsigned material);
    EmbreeGeometryHandle make_triangles(const kernels::Geometry& geometry, unsigned material);
    void set_previous(const SceneSnapshot& snapshot);
    void set_requirements();

    /// Entries of the tables that are taken.
    struct TableSizes {
        unsigned matrices = 1, keys = 0, geometries = 0;
    };
    /// The instances that the snapshot before shared with others. They come first in all tables.
    struct StillPart {
        SharedList<SnapshotInstance>::Shared list;  ///< also keeps it from being made anew at the same address
        TableSizes tables;
        std::uint64_t shown = 0;  ///< instances of the upper level
    };

    RTCDevice device_;
    const Scene& scene_;
    const BuildSettings build_;
    bool cull_backfaces_ = false;

    // Tables that the view points into.
    std::vector<kernels::Geometry> geometries_;
    std::vector<kernels::Texture> textures_;
    MaterialTable materials_;
    std::vector<kernels::Instance> instances_;
    std::vector<kernels::InstanceMotion> motions_;
    std::vector<kernels::Affine> matrices_;
    std::vector<kernels::TransformKey> keys_;
    LightTables lights_;
    EmitterTables emitters_;
    EnvironmentTables environment_;
    std::vector<kernels::CameraKey> camera_keys_;
    std::vector<kernels::Affine> previous_matrices_;
    kernels::CameraKey previous_camera_key_{};
    kernels::SceneView view_{};

    std::vector<std::unique_ptr<PackedGeometry>>
        packed_;  ///< [geometry] in mesh coordinates; null until an instance needs it
    std::vector<std::unique_ptr<PackedGeometry>> baked_;  ///< [instance] flattened
    std::vector<std::unique_ptr<GeometryUser>> users_;    ///< of mesh scenes
    std::vector<std::unique_ptr<GeometryUser>> flat_users_;
    std::map<std::pair<unsigned, unsigned>, EmbreeSceneHandle> mesh_scenes_;  ///< by geometry and material
    EmbreeSceneHandle flat_;
    InstanceLevel upper_;
    DeformingMeshes deforming_;
    std::size_t rigid_geometries_ = 0;  ///< of geometries_; those of bending meshes follow
    std::vector<bool> flattened_;  ///< of the frame before
    std::vector<std::uint32_t> flat_ids_;  ///< of what is flattened
    StillPart still_;
    RenderSpace flat_space_;
    bool have_frame_ = false;
    std::uint64_t geometry_key_ = 0, emitter_key_ = 0;
    unsigned requirements_ = 0;
    StructureCounts structures_;
    std::uint64_t flat_triangles_ = 0, instance_count_ = 0, moving_count_ = 0;
};

}  // namespace kadr
