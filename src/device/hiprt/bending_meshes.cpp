#include "device/hiprt/bending_meshes.h"

#include <set>

#include "device/hiprt/rigid_meshes.h"
#include "device/tables/deformed_geometry.h"

namespace kadr {
namespace {

/// Growth of the tree's cost beyond which a structure is built anew: as on the CPU, where it was measured; what rays of
/// a GPU pay no GPU has shown yet.
constexpr double kMostGrowth = 1.05;

}  // namespace

const BendingMeshes::Entry& BendingMeshes::find(const SceneSnapshot& snapshot, int deformed) const {
    return entries_.at(snapshot.deformed[static_cast<std::size_t>(deformed)]->number);
}

void BendingMeshes::set_frame(const SceneSnapshot& snapshot, const std::vector<bool>& filtered) {
    built_ = updated_ = kept_ = 0;
    counts_ = count_bending(snapshot);
    blurs_ = false;
    std::vector<bool> shown(snapshot.deformed.size(), false);
    for (const SnapshotInstance& instance : snapshot.instances)
        if (instance.deformed >= 0 && instance.mask != 0) shown[static_cast<std::size_t>(instance.deformed)] = true;
    for (std::size_t i = 0; i < snapshot.deformed.size(); ++i) {
        const std::shared_ptr<const DeformedMesh>& mesh = snapshot.deformed[i];
        const GeometryData& source = scene_.geometries[mesh->geometry];
        if (source.indices.empty()) continue;
        blurs_ = blurs_ || (shown[i] && mesh->key_count > 1);
        counts_.by_kernels += shown[i] && mesh->poses ? 1 : 0;
        check_mesh_size(source);
        update(entries_[mesh->number], mesh, filtered[i]);
    }
}

void BendingMeshes::forget(const SceneSnapshot& snapshot) {
    std::set<std::uint32_t> numbers;
    for (const auto& mesh : snapshot.deformed) numbers.insert(mesh->number);
    std::erase_if(entries_, [&](const auto& entry) { return !numbers.count(entry.first); });
}

void BendingMeshes::update(Entry& entry, const std::shared_ptr<const DeformedMesh>& mesh, bool filtered) {
    const std::vector<std::uint32_t>& indices = scene_.geometries[mesh->geometry].indices;
    const bool same_kind = entry.mesh && entry.filtered == filtered && entry.mesh->key_count == mesh->key_count;
    if (same_kind && entry.mesh->version == mesh->version) {
        ++kept_;
        return;
    }
    entry.mesh.reset();  // if anything fails below, the entry is made anew
    const bool still = mesh->key_count == 1;
    const bool refit =
        same_kind && still && entry.bounds.cost(mesh->vertices, indices) <= kMostGrowth * entry.cost_when_built;
    place_vertices(entry, *mesh);
    const StructureJob job{entry.data.build_input(host_of(*mesh), filtered), &entry.structure};
    const hiprt::BuildOptions options = build_options(StructureQuality::fast, filtered || !still);
    if (refit)
        builder_.update(job, options);
    else
        builder_.build({&job, 1}, options);
    if (!refit && still) {
        entry.bounds.order(mesh->vertices, indices);
        entry.cost_when_built = entry.bounds.cost(mesh->vertices, indices);
    }
    ++(refit ? updated_ : built_);
    entry.filtered = filtered;
    entry.mesh = mesh;
}

/// The triangles and what else keeps its shape stay where they are.
void BendingMeshes::place_vertices(Entry& entry, const DeformedMesh& mesh) {
    const kernels::Geometry host = host_of(mesh);
    if (entry.data.vertices.count() != mesh.vertices.size())  // none yet, or another number of keys
        entry.data = GpuMesh(builder_.memory(), uploads_, host, false);
    if (mesh.poses)
        bender_.bend(mesh, host, entry.data);
    else
        entry.data.upload_bent(uploads_, host);
}

void BendingMeshes::set_previous(const SceneSnapshot& snapshot) {
    for (std::size_t i = 0; i < snapshot.deformed.size(); ++i) {
        const auto entry = entries_.find(snapshot.deformed[i]->number);
        if (entry == entries_.end()) continue;
        DeviceBuffer<kernels::Vec3f>& previous = entry->second.data.previous;
        if (!snapshot.previous) {
            previous = {};
            continue;
        }
        const std::vector<kernels::Vec3f>& positions = snapshot.previous->deformed[i];
        previous.reserve(builder_.memory(), positions.size(), MemoryUse::vertices);
        uploads_.add(previous, positions);
    }
}

kernels::Geometry BendingMeshes::host_of(const DeformedMesh& mesh) const {
    return geometry_of(mesh, scene_.geometries[mesh.geometry]);
}

kernels::Geometry BendingMeshes::host(const SceneSnapshot& snapshot, int deformed) const {
    return host_of(*snapshot.deformed[static_cast<std::size_t>(deformed)]);
}

kernels::Geometry BendingMeshes::device(const SceneSnapshot& snapshot, int deformed) const {
    return find(snapshot, deformed).data.view(host(snapshot, deformed));
}

}  // namespace kadr
