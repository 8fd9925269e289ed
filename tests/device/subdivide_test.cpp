#include "device/tables/subdivide.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "device/tables/packed_geometry.h"

namespace kadr {
namespace {

using Positions = std::vector<glm::dvec3>;
using Indices = std::vector<std::uint32_t>;

double area(const Positions& p, const Indices& t) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < t.size(); i += 3) sum += 0.5 * glm::length(glm::cross(p[t[i + 1]] - p[t[i]], p[t[i + 2]] - p[t[i]]));
    return sum;
}

/// A square 2e7 wide, whose two triangles share an edge by place but no vertex, near the origin but not in its plane.
Positions terrain() { return {{-1e7, -1, -1e7}, {1e7, -1, -1e7}, {1e7, -1, 1e7}, {-1e7, -1, -1e7}, {1e7, -1, 1e7}, {-1e7, -1, 1e7}}; }
const Indices kTerrain{0, 1, 2, 3, 4, 5};

TEST(Subdivide, LeavesWhatIsNotFarLargerThanItsDistance) {
    Positions p{{-2000, -1, -1000}, {2000, -1, -1000}, {0, -1, 1000}, {1e6, 0, 0}, {1.2e6, 0, 0}, {1e6, 2e5, 0}};
    EXPECT_TRUE(subdivide_near_origin(p, {0, 1, 2, 3, 4, 5}).indices.empty());
    EXPECT_EQ(p.size(), 6u);
}

TEST(Subdivide, NoEdgeStaysLongNearTheOrigin) {
    Positions p = terrain();
    const double before = area(p, kTerrain);
    const Subdivision finer = subdivide_near_origin(p, kTerrain);
    ASSERT_FALSE(finer.indices.empty());
    // The square lies in y = -1: what of a triangle is nearest to the origin is nearest in x and z.
    for (std::size_t i = 0; i < finer.indices.size(); i += 3) {
        const glm::dvec3 a = p[finer.indices[i]], b = p[finer.indices[i + 1]], c = p[finer.indices[i + 2]];
        const double farthest = std::max({glm::length(a), glm::length(b), glm::length(c)}), longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
        EXPECT_LE(longest, 256 * std::max(16.0, farthest)) << i;
        if (farthest < 4096) {
            EXPECT_LE(longest, 4096) << i;
        }
    }
    // Halves of coordinates such as these are exact; sums of thousands of areas are not.
    EXPECT_NEAR(area(p, finer.indices) / before, 1, 1e-12);
    EXPECT_LT(finer.indices.size() / 3, 5000u);  // grows with the logarithm of the size: a few thousand at any
    EXPECT_EQ(p.size(), terrain().size() + finer.added.size());
}

TEST(Subdivide, NeighboursAgreeWithoutSharingVertices) {
    Positions p = terrain();
    const Subdivision finer = subdivide_near_origin(p, kTerrain);
    // Every edge inside the square has a triangle on both sides, by place: no corner lies in the middle of another's edge.
    using Place = std::pair<double, double>;
    std::map<std::pair<Place, Place>, int> sides;
    const auto place = [&](std::uint32_t i) { return Place{p[i].x, p[i].z}; };
    for (std::size_t i = 0; i < finer.indices.size(); ++i) {
        const Place a = place(finer.indices[i]), b = place(finer.indices[i % 3 == 2 ? i - 2 : i + 1]);
        ++sides[std::minmax(a, b)];
    }
    for (const auto& [edge, count] : sides) {
        const bool on_rim = (edge.first.first == edge.second.first && std::abs(edge.first.first) == 1e7) || (edge.first.second == edge.second.second && std::abs(edge.first.second) == 1e7);
        EXPECT_EQ(count, on_rim ? 1 : 2) << edge.first.first << ' ' << edge.first.second << " to " << edge.second.first << ' ' << edge.second.second;
    }
}

TEST(Subdivide, AttributesOfAFlattenedMeshStayThoseOfTheWholeTriangle) {
    GeometryData g;
    g.positions = {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}};
    g.normals = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
    g.indices = {0, 1, 2};
    for (const kernels::Vec3f& q : g.positions) {
        g.uv[0].push_back({q.x, q.z});
        g.uv[1].push_back({2 * q.x, 3 * q.z});
        g.colors.push_back({q.x, q.z, 0.5f, 1});
        g.tangents.push_back({1, 0, 0, -1});
    }
    const double size = 1e6;
    const glm::dmat4 place{{size, 0, 0, 0}, {0, size, 0, 0}, {0, 0, size, 0}, {0, -2, 0, 1}};
    const PackedGeometry packed(g, place, RenderSpace{});
    const kernels::Geometry view = packed.view(g);
    ASSERT_GT(view.triangle_count, 100u);
    for (unsigned i = 0; i < view.vertex_count; ++i) {
        const kernels::Vertex& v = view.vertices[i];
        EXPECT_NEAR(v.uv.x, v.position.x / size, 1e-6);  // a rounding of floats in every halving
        EXPECT_NEAR(view.uv1[i].y, 3 * v.position.z / size, 3e-6);
        EXPECT_NEAR(view.colors[i].y, v.position.z / size, 1e-6);
        EXPECT_EQ(view.tangents[i].w, -1);
        EXPECT_EQ(v.normal.y, 1);
        EXPECT_EQ(v.position.y, -2);
    }
    GeometryData small = g;
    const PackedGeometry whole(small, glm::dmat4(1), RenderSpace{});
    EXPECT_EQ(whole.view(small).triangle_count, 1u);
    EXPECT_EQ(whole.view(small).colors, small.colors.data());
}

TEST(Subdivide, AMirrorTurnsTheWindingOfTheFinerTriangles) {
    GeometryData g;
    g.positions = {{-1, 0, -1}, {0, 0, 1}, {1, 0, -1}};  // faces +y
    g.normals = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
    g.indices = {0, 1, 2};
    const glm::dmat4 place{{-1e6, 0, 0, 0}, {0, 1e6, 0, 0}, {0, 0, 1e6, 0}, {0, -2, 0, 1}};
    const PackedGeometry packed(g, place, RenderSpace{});
    const kernels::Geometry view = packed.view(g);
    for (unsigned t = 0; t < view.triangle_count; ++t) {
        kernels::Vec3f p[3];
        for (int c = 0; c < 3; ++c) p[c] = view.vertices[view.indices[3 * t + static_cast<unsigned>(c)]].position;
        EXPECT_GT(cross(p[1] - p[0], p[2] - p[0]).y, 0) << t;
    }
}

}  // namespace
}  // namespace kadr
