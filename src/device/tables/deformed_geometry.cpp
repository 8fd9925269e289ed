#include "device/tables/deformed_geometry.h"

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

}  // namespace kadr
