#include "device/embree/memory_forecast.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "device/embree/flatten.h"
#include "kernels/scene/scene_view.h"

namespace kadr {
namespace {

// Embree 3.13.5 with AVX2, scenes of medium quality over wavy grids, by its memory monitor
// (rtcSetDeviceMemoryMonitorFunction) and the process's resident size: 60.7 to 66.5 bytes a triangle of 10,000 to
// 4,000,000, 94 to 116 while they are built; with two keys of motion 49 and 129, with five 61 and 141. A structure of its
// own takes 4.6 kB more. An instance takes 298 bytes, 64 for every further frame, and in the level above 115 (157 while
// that is built), where instances move 205 (285).
struct TriangleBytes {
    double kept, building;
};
constexpr TriangleBytes kRigid{63, 37}, kBending{58, 80};
constexpr double kStructureBytes = 4600;
constexpr double kInstanceBytes = 298, kFrameBytes = 64;
constexpr TriangleBytes kStillLevel{115, 42}, kMovingLevel{205, 80};

/// Of what an instance has in our own tables: its slot in the upper level, two entries of the kernels' and the frame of
/// the one before (InstanceLevel, SceneView).
constexpr double kSlotBytes = 16;
constexpr double kTableBytes = kSlotBytes + sizeof(kernels::Instance) + sizeof(kernels::InstanceMotion);

/// Adds up the structures of a frame.
class Structures {
public:
    void add(double triangles, const TriangleBytes& each) {
        memory.structures += kStructureBytes + triangles * each.kept;
        memory.building = std::max(memory.building, triangles * each.building);
    }
    DeviceMemory memory;
};

double vertex_bytes(const GeometryData& geometry) { return static_cast<double>(geometry.positions.size() * sizeof(kernels::Vertex)); }

double triangles_of(const GeometryData& geometry) { return static_cast<double>(geometry.indices.size()) / 3; }

/// What is flattened: vertices and tangents anew, triangles too where a mirror turns them round.
double baked_bytes(const GeometryData& geometry, const glm::dmat4& place) {
    const bool mirrored = glm::determinant(glm::dmat3(place)) < 0;
    return vertex_bytes(geometry) + static_cast<double>(geometry.tangents.size() * sizeof(kernels::Vec4f) + (mirrored ? geometry.indices.size() * sizeof(std::uint32_t) : 0));
}

double frame_bytes(const SceneSnapshot& snapshot, std::size_t instance) {
    const unsigned frames = snapshot.motion.headers[instance].frame_count;
    return kFrameBytes * (frames - 1) + frames * static_cast<double>(frames > 1 ? sizeof(kernels::TransformKey) : sizeof(kernels::Affine));
}

}  // namespace

DeviceMemory forecast_device_memory(const Scene& scene, const SceneSnapshot& snapshot) {
    const std::vector<bool> flattened = choose_flattened(scene, snapshot);
    Structures structures;
    DeviceMemory& memory = structures.memory;
    std::set<std::pair<unsigned, unsigned>> rigid, bending;  // (geometry or number of the bent mesh, material)
    std::set<unsigned> packed;
    double flat_triangles = 0, shown = 0;
    bool moves = false;
    for (std::size_t i = 0; i < flattened.size(); ++i) {
        const SnapshotInstance& instance = snapshot.instances[i];
        const GeometryData& geometry = scene.geometries[instance.geometry];
        memory.instances += kTableBytes;
        if (instance.mask == 0) continue;
        if (flattened[i]) {
            flat_triangles += triangles_of(geometry);
            memory.vertices += baked_bytes(geometry, snapshot.fixed_places[static_cast<std::size_t>(instance.fixed_place)]);
            continue;
        }
        ++shown;
        moves = moves || snapshot.motion.headers[i].frame_count > 1;
        memory.instances += kInstanceBytes + frame_bytes(snapshot, i);
        if (instance.deformed >= 0) {
            const DeformedMesh& mesh = *snapshot.deformed[static_cast<std::size_t>(instance.deformed)];
            if (bending.emplace(mesh.number, instance.material).second) structures.add(triangles_of(geometry), mesh.key_count > 1 ? kBending : kRigid);
        } else if (rigid.emplace(instance.geometry, instance.material).second) {
            structures.add(triangles_of(geometry), kRigid);
            if (packed.insert(instance.geometry).second) memory.vertices += vertex_bytes(geometry);
        }
    }
    if (flat_triangles > 0) structures.add(flat_triangles, kRigid);
    const TriangleBytes& level = moves ? kMovingLevel : kStillLevel;
    memory.instances += shown * level.kept;
    memory.instances_building = shown * level.building;
    return memory;
}

}  // namespace kadr
