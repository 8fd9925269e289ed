#pragma once

#include <cstdint>
#include <vector>

#include "device/device.h"
#include "device/hiprt/bending_meshes.h"
#include "device/hiprt/device_table.h"
#include "device/hiprt/instance_tables.h"
#include "device/hiprt/shared_tables.h"
#include "device/tables/emitter_tables.h"
#include "device/tables/light_tables.h"
#include "device/tables/material_table.h"

namespace kadr {

/// What changes from frame to frame, as HIPRT and the kernels want it on the GPU: one frame, or one part of its shutter.
///
/// Every instance is one of HIPRT's: meshes stay in their own coordinates. The structure over all instances is built
/// anew whenever they change (HIPRT's update of it is a race); those of rigid meshes are shared by all frames.
class HiprtFrame {
public:
    explicit HiprtFrame(SharedTables& shared);

    /// Becomes the snapshot's frame, on the stream of the builder, without waiting. No launch may still look at the one
    /// before. After an exception the next call starts anew.
    /// @throws GpuOutOfMemory, InputError  for what the GPU cannot show, by name
    void set(const SceneSnapshot& snapshot);
    /// Drops the structure of all instances; the next set() starts anew.
    void forget();

    const kernels::SceneView& view() const { return view_; }  ///< for the kernels: addresses of the GPU
    hiprt::Scene top() const { return top_.handle(); }        ///< null: nothing to see
    const unsigned* instance_of() const { return instance_of_.data(); }
    unsigned requirements() const { return requirements_; }
    bool asks_functions() const { return asks_functions_; }  ///< whether rays ask our functions about some geometry
    std::uint64_t instance_count() const { return tables_.shown.size(); }
    std::uint64_t moving_count() const { return tables_.moving; }
    const StructureCounts& structures() const { return structures_; }
    const BendingCounts& bending() const { return bending_.counts(); }

private:
    void build_geometry(const SceneSnapshot& snapshot);
    void require_meshes(const SceneSnapshot& snapshot);
    std::vector<kernels::Geometry> list_geometries(const SceneSnapshot& snapshot, bool on_host) const;
    ShownMesh mesh_of(const SceneSnapshot& snapshot, std::size_t instance) const;
    bool is_filtered(const SnapshotInstance& instance) const;
    void build_top_level();
    kernels::SceneView host_view() const;
    void set_shared(const SceneSnapshot& snapshot);
    void set_lights(const SceneSnapshot& snapshot);
    void set_camera(const SceneSnapshot& snapshot);
    void set_previous(const SceneSnapshot& snapshot);
    void set_requirements();

    SharedTables& shared_;
    const Scene& scene_;
    StructureBuilder& builder_;
    UploadQueue& uploads_;
    GpuMemory& memory_;
    RigidMeshes& rigid_;
    BendingMeshes bending_;

    // Of the host.
    MaterialTable materials_;
    LightTables lights_;
    EmitterTables emitters_;
    InstanceTables tables_;
    std::vector<kernels::Geometry> host_geometries_;
    std::vector<bool> filtered_mesh_;  ///< [geometry]: some instance of it is filtered
    std::vector<bool> filtered_bend_;  ///< [deformed mesh of the snapshot]

    // Of the GPU.
    DeviceTable<kernels::Material> material_table_;
    DeviceTable<kernels::Geometry> geometries_;
    DeviceTable<kernels::Instance> instances_;
    DeviceTable<kernels::InstanceMotion> motions_;
    DeviceTable<kernels::Affine> matrices_{MemoryUse::motion}, previous_matrices_{MemoryUse::motion};
    DeviceTable<kernels::TransformKey> keys_{MemoryUse::motion};
    DeviceTable<kernels::Light> light_keys_;
    DeviceTable<int> light_first_, light_key_count_;
    DeviceTable<kernels::EmissiveTriangle> emissive_triangles_;
    DeviceTable<float> emissive_cdf_, instance_density_;
    DeviceTable<kernels::CameraKey> camera_keys_, previous_camera_;
    DeviceTable<hiprt::Instance> hiprt_instances_{MemoryUse::motion};
    DeviceTable<std::uint32_t> masks_{MemoryUse::motion};
    DeviceTable<unsigned> instance_of_;
    DeviceTable<kernels::TransformHeader> headers_{MemoryUse::motion};
    DeviceTable<kernels::FrameSrt> srt_{MemoryUse::motion};
    DeviceTable<kernels::FrameMatrix> frame_matrices_{MemoryUse::motion};
    HiprtTopLevel top_;  ///< goes before the structures that it shows

    kernels::SceneView view_{};
    bool have_frame_ = false;
    std::uint64_t geometry_key_ = 0;
    RenderSpace space_;
    bool cull_backfaces_ = false, asks_functions_ = false;
    unsigned requirements_ = 0;
    StructureCounts structures_;
};

}  // namespace kadr
