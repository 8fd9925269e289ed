#include "device/hiprt/rigid_meshes.h"

#include <fmt/format.h>

#include "base/error.h"

namespace kadr {

void check_mesh_size(const GeometryData& geometry) {
    constexpr std::size_t kMost = hiprt::kMostVertexBytes / sizeof(kernels::Vertex);
    const std::size_t triangles = geometry.indices.size() / 3;
    if (geometry.positions.size() <= kMost && triangles <= kMost) return;
    throw InputError(fmt::format("--device hiprt: the mesh {} has {} vertices and {} triangles", geometry.name,
                                 geometry.positions.size(), triangles),
                     fmt::format("HIPRT takes at most {} of each; use --device cpu", kMost));
}

RigidMeshes::RigidMeshes(const Scene& scene, StructureBuilder& builder, UploadQueue& uploads)
    : scene_(scene),
      builder_(builder),
      uploads_(uploads),
      packed_(scene.geometries.size()),
      meshes_(scene.geometries.size()),
      host_(scene.geometries.size()),
      device_(scene.geometries.size()) {}

void RigidMeshes::require(const std::set<MeshUse>& uses) {
    built_ = 0;
    for (const bool filtered : {false, true}) {
        std::vector<MeshUse> missing;
        for (const MeshUse& use : uses)
            if (use.second == filtered && !structures_.count(use)) missing.push_back(use);
        for (const MeshUse& use : missing) upload(use.first);
        build(missing, filtered);
    }
}

void RigidMeshes::upload(unsigned geometry) {
    const GeometryData& source = scene_.geometries[geometry];
    if (packed_[geometry]) return;
    check_mesh_size(source);
    auto packed = std::make_unique<PackedGeometry>(source);
    const kernels::Geometry host = packed->view(source);
    meshes_[geometry] = GpuMesh(builder_.memory(), uploads_, host);
    host_[geometry] = host;
    device_[geometry] = meshes_[geometry].view(host);
    packed_[geometry] = std::move(packed);
}

void RigidMeshes::build(const std::vector<MeshUse>& uses, bool filtered) {
    if (uses.empty()) return;
    std::vector<HiprtGeometry> made(uses.size());
    std::vector<StructureJob> jobs;
    std::vector<HiprtGeometry*> structures;
    for (std::size_t i = 0; i < uses.size(); ++i) {
        jobs.push_back({meshes_[uses[i].first].build_input(host_[uses[i].first], filtered), &made[i]});
        structures.push_back(&made[i]);
    }
    builder_.build(jobs, build_options(quality_, filtered));
    builder_.compact(structures);
    for (std::size_t i = 0; i < uses.size(); ++i) structures_[uses[i]] = std::move(made[i]);
    built_ += uses.size();
}

bool RigidMeshes::lower_quality() {
    if (quality_ == StructureQuality::fast) return false;
    quality_ = static_cast<StructureQuality>(static_cast<int>(quality_) - 1);
    structures_.clear();
    builder_.give_scratch_back();
    return true;
}

}  // namespace kadr
