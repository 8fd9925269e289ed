#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "device/hiprt/gpu_mesh.h"
#include "device/hiprt/structure_builder.h"
#include "device/tables/packed_geometry.h"
#include "scene/scene.h"

namespace kadr {

/// A mesh, and whether rays ask our filter function at every hit on it.
using MeshUse = std::pair<unsigned, bool>;

/// Meshes that keep their shape: copied to the GPU when first shown, with structures of high quality made as small as
/// they can be, which stay for the whole shot.
class RigidMeshes {
public:
    RigidMeshes(const Scene& scene, StructureBuilder& builder, UploadQueue& uploads);

    /// Makes what is not there yet, all of it in one batch a kind. @param uses  of meshes that have triangles
    /// @throws InputError  for a mesh that is too large for HIPRT, with its name
    void require(const std::set<MeshUse>& uses);
    /// Drops all structures, to be built at the next lower quality. @return whether there is one
    bool lower_quality();

    hiprt::Geometry structure(const MeshUse& use) const { return structures_.at(use).handle(); }
    const kernels::Geometry& host(unsigned geometry) const { return host_[geometry]; }      ///< empty until required
    const kernels::Geometry& device(unsigned geometry) const { return device_[geometry]; }  ///< empty until required
    std::size_t count() const { return host_.size(); }
    StructureQuality quality() const { return quality_; }
    std::uint64_t built() const { return built_; }  ///< structures, by the last require()
    std::uint64_t kept() const { return structures_.size() - built_; }

private:
    void upload(unsigned geometry);
    void build(const std::vector<MeshUse>& uses, bool filtered);

    const Scene& scene_;
    StructureBuilder& builder_;
    UploadQueue& uploads_;
    std::vector<std::unique_ptr<PackedGeometry>> packed_;  ///< [geometry]; null until required
    std::vector<GpuMesh> meshes_;                          ///< [geometry]
    std::vector<kernels::Geometry> host_, device_;         ///< [geometry]
    std::map<MeshUse, HiprtGeometry> structures_;
    StructureQuality quality_ = StructureQuality::high;
    std::uint64_t built_ = 0;
};

/// @throws InputError  with the mesh's name, when HIPRT cannot address so many vertices or triangles
void check_mesh_size(const GeometryData& geometry);

}  // namespace kadr
