#include "device/tables/deformed_geometry.h"

#include <algorithm>

namespace kadr {

kernels::Geometry geometry_of(const DeformedMesh& mesh, const GeometryData& source) {
    kernels::Geometry g{};
    g.vertices = mesh.vertices.data();
    g.vertex_count = static_cast<unsigned>(source.positions.size());
    g.key_count = mesh.key_count;
    g.indices = source.indices.data();
    g.triangle_count = static_cast<unsigned>(source.indices.size() / 3);
    if (!mesh.tangents.empty()) g.tangents = mesh.tangents.data();
    if (!source.uv[1].empty()) g.uv1 = source.uv[1].data();
    if (!source.colors.empty()) g.colors = source.colors.data();
    return g;
}

BendingCounts count_bending(const SceneSnapshot& snapshot) {
    std::vector<bool> shown(snapshot.deformed.size(), false);
    for (const SnapshotInstance& instance : snapshot.instances)
        if (instance.deformed >= 0 && instance.mask != 0) shown[static_cast<std::size_t>(instance.deformed)] = true;
    BendingCounts counts;
    for (std::size_t i = 0; i < shown.size(); ++i) {
        if (!shown[i]) continue;
        const std::uint64_t keys = snapshot.deformed[i]->key_count;
        ++counts.meshes;
        counts.blurred += keys > 1 ? 1 : 0;
        counts.keys = std::max(counts.keys, keys);
    }
    return counts;
}

}  // namespace kadr
