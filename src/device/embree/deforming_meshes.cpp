#include "device/embree/deforming_meshes.h"

#include <algorithm>

#include "device/embree/alpha_filter.h"
#include "device/tables/deformed_geometry.h"
#include "device/tables/material_table.h"

namespace kadr {
namespace {

std::span<const kernels::Vertex> first_key(const DeformedMesh& mesh) { return std::span(mesh.vertices).first(mesh.vertices.size() / mesh.key_count); }

}  // namespace

StructureUpdate choose_update(const StructureState& state) {
    if (state.keys != 1 || state.keys_before != 1) return StructureUpdate::build;
    if (!(state.growth <= kMostGrowth)) return StructureUpdate::build_low;
    return state.low ? StructureUpdate::build : StructureUpdate::refit;
}

const DeformingMeshes::Entry& DeformingMeshes::find(const SnapshotInstance& instance) const {
    return entries_.at({number_of_[static_cast<std::size_t>(instance.deformed)], instance.material});
}

void DeformingMeshes::set_frame(const SceneSnapshot& snapshot, const kernels::SceneView& view, bool cull_backfaces, std::vector<kernels::Geometry>& geometries) {
    number_of_.clear();
    bends_ = false;
    built_ = built_low_ = refitted_ = 0;
    for (const auto& mesh : snapshot.deformed) number_of_.push_back(mesh->number);
    std::map<Key, int> shown;  // deformed mesh
    for (const SnapshotInstance& instance : snapshot.instances)
        if (instance.deformed >= 0 && instance.mask != 0) shown[{number_of_[static_cast<std::size_t>(instance.deformed)], instance.material}] = instance.deformed;
    std::erase_if(entries_, [&](const auto& entry) { return !shown.count(entry.first); });
    for (const auto& [key, index] : shown) {
        Entry& entry = entries_[key];
        const auto& mesh = snapshot.deformed[static_cast<std::size_t>(index)];
        if (!entry.user) entry.user = std::make_unique<GeometryUser>();
        *entry.user = {&view, static_cast<unsigned>(geometries.size()), key.second, cull_backfaces};
        update(entry, mesh, view.materials[key.second], cull_backfaces);
        geometries.push_back(geometry_of(*entry.mesh, scene_.geometries[entry.mesh->geometry]));
        bends_ = bends_ || mesh->key_count > 1;
    }
}

void DeformingMeshes::set_previous(const SceneSnapshot& snapshot, std::vector<kernels::Geometry>& geometries) {
    for (std::size_t i = 0; i < snapshot.deformed.size(); ++i) {
        const unsigned number = snapshot.deformed[i]->number;
        for (auto shown = entries_.lower_bound({number, 0}); shown != entries_.end() && shown->first.first == number; ++shown) {
            Entry& entry = shown->second;
            entry.previous = snapshot.previous ? snapshot.previous->deformed[i] : std::vector<kernels::Vec3f>{};
            geometries[entry.user->geometry].previous = snapshot.previous ? entry.previous.data() : nullptr;
        }
    }
}

void DeformingMeshes::create(Entry& entry, const kernels::Material& material, bool cull_backfaces, RTCBuildQuality quality) {
    const std::vector<std::uint32_t>& indices = scene_.geometries[entry.mesh->geometry].indices;
    entry.structure = new_structure(device_, build_);
    entry.triangles.reset(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE));
    // Embree has a tree of its own for a geometry, and refits it, only in dynamic scenes of low quality; the geometry's
    // quality then says how that tree is built (REFIT: at default quality first).
    if (entry.mesh->key_count == 1) {
        rtcSetSceneFlags(entry.structure.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_DYNAMIC | (build_.robust != BuildSettings::Robust::no ? RTC_SCENE_FLAG_ROBUST : 0)));
        rtcSetSceneBuildQuality(entry.structure.get(), RTC_BUILD_QUALITY_LOW);
        rtcSetGeometryBuildQuality(entry.triangles.get(), quality);
    }
    if (needs_filter(material, cull_backfaces)) {
        rtcSetGeometryIntersectFilterFunction(entry.triangles.get(), alpha_filter);
        rtcSetGeometryOccludedFilterFunction(entry.triangles.get(), alpha_filter);
    }
    rtcSetGeometryUserData(entry.triangles.get(), entry.user.get());
    rtcSetGeometryTimeStepCount(entry.triangles.get(), entry.mesh->key_count);
    rtcSetSharedGeometryBuffer(entry.triangles.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0, 12, indices.size() / 3);
    rtcAttachGeometry(entry.structure.get(), entry.triangles.get());
}

void DeformingMeshes::point_at(Entry& entry, const DeformedMesh& mesh) {
    const std::size_t count = mesh.vertices.size() / mesh.key_count;
    for (unsigned k = 0; k < mesh.key_count; ++k)
        rtcSetSharedGeometryBuffer(entry.triangles.get(), RTC_BUFFER_TYPE_VERTEX, k, RTC_FORMAT_FLOAT3, mesh.vertices.data() + k * count, 0, sizeof(kernels::Vertex), count);
}

void DeformingMeshes::update(Entry& entry, const std::shared_ptr<const DeformedMesh>& mesh, const kernels::Material& material, bool cull_backfaces) {
    if (entry.mesh && entry.mesh->version == mesh->version && entry.mesh->key_count == mesh->key_count) return;
    const std::vector<std::uint32_t>& indices = scene_.geometries[mesh->geometry].indices;
    StructureState state{entry.mesh ? entry.mesh->key_count : 0, entry.low, mesh->key_count, 1};
    const double cost = mesh->key_count == 1 && state.keys_before == 1 ? entry.bounds.cost(first_key(*mesh), indices) : 0;
    if (cost > 0) state.growth = cost / entry.cost_when_built;
    const StructureUpdate chosen = choose_update(state);
    entry.mesh = mesh;
    if (chosen != StructureUpdate::refit) {
        entry.low = chosen == StructureUpdate::build_low;
        create(entry, material, cull_backfaces, entry.low ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_REFIT);
        if (mesh->key_count == 1) {
            entry.bounds.order(first_key(*mesh), indices);
            entry.cost_when_built = entry.bounds.cost(first_key(*mesh), indices);
        }
    }
    ++(chosen == StructureUpdate::refit ? refitted_ : built_);
    built_low_ += entry.low ? 1 : 0;
    point_at(entry, *mesh);
    rtcCommitGeometry(entry.triangles.get());
    rtcCommitScene(entry.structure.get());
}

}  // namespace kadr
