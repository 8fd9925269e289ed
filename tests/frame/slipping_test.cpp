// Where rays would slip between triangles often enough to be seen.
#include "frame/slipping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frame/stage.h"

namespace kadr::test {
namespace {

/// The square from -1 to 1 in x and y, in strips of two triangles from its left to its right.
void make_strips(GeometryData& mesh, int count) {
    mesh.positions.clear();
    mesh.indices.clear();
    for (int i = 0; i <= count; ++i)
        for (const float x : {-1.0f, 1.0f}) mesh.positions.push_back({x, -1 + 2 * static_cast<float>(i) / static_cast<float>(count), 0});
    for (unsigned i = 0; i < static_cast<unsigned>(count); ++i)
        for (const unsigned corner : {0u, 1u, 2u, 1u, 3u, 2u}) mesh.indices.push_back(2 * i + corner);
}

std::optional<Slipping> slipping_of(int strips, double distance) {
    Stage stage;
    stage.add_node("Strips");
    make_strips(stage.scene.geometries[0], strips);
    stage.shot.camera.position = PositionTrack(glm::dvec3(0, 0, distance));
    stage.shot.camera.focal_length_mm = Track<double>(40 * distance);  // 0.9 m wide: the square fills the picture
    const BoundShot bound = stage.bind();
    return find_slipping(bound);
}

TEST(Slipping, IsRareBetweenOrdinaryTriangles) {
    for (const int strips : {1, 10, 1000}) EXPECT_FALSE(slipping_of(strips, 5)) << strips;
}

TEST(Slipping, IsCommonBetweenNeedles) {
    const std::optional<Slipping> found = slipping_of(200'000, 5);
    ASSERT_TRUE(found);
    // Two edges of length 2 and its diagonal a strip, on an area of 4: 2e5 a metre; 5 m at 2^-24 of them, 0.12 of which slip.
    EXPECT_NEAR(found->share, 0.12 * 0x1p-24 * 5 * 2e5, 0.05 * found->share);
    EXPECT_THAT(found->text(), testing::StartsWith("one ray in "));
    EXPECT_THAT(found->text(), testing::EndsWith("most of them of node 'stage/Strips'"));
}

TEST(Slipping, GrowsWithTheLengthOfRays) {
    EXPECT_FALSE(slipping_of(2'000, 5));
    const std::optional<Slipping> found = slipping_of(2'000, 500);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->share, 0.12 * 0x1p-24 * 500 * 2e3, 0.05 * found->share);
}

TEST(Slipping, CountsForWhatItFillsOfThePicture) {
    Stage stage;
    stage.node(stage.add_node("Speck")).scale = glm::dvec3(1e-4);
    make_strips(stage.scene.geometries[0], 200'000);
    const BoundShot bound = stage.bind();
    EXPECT_FALSE(find_slipping(bound));
}

}  // namespace
}  // namespace kadr::test
