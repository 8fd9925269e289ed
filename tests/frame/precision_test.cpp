#include "frame/precision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frame/stage.h"

namespace kadr::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> warnings_of(const Stage& stage) {
    const BoundShot bound = stage.bind();
    std::vector<std::string> found;
    for (const Diagnostic& warning : precision_warnings(bound)) found.push_back(warning.found);
    return found;
}

TEST(PrecisionWarnings, NoneForAnOrdinaryShot) {
    Stage stage;
    stage.add_node("Box");
    EXPECT_THAT(warnings_of(stage), IsEmpty());
}

TEST(PrecisionWarnings, NamesTheCameraWhoseLensIsTooLong) {
    Stage stage;
    stage.shot.camera.focal_length_mm = Track<double>(10000);
    // 36 mm over 1280 pixels, 10 m: 2.8e-6 rad; 2^-24 of a radian is 0.021 of that.
    EXPECT_THAT(warnings_of(stage), ElementsAre(HasSubstr("a pixel of the camera is 2.8e-06 rad wide at 0 s, and rays, which start 5 m before what it looks at, are off by 0.021 of it")));
    stage.shot.camera.focal_length_mm = Track<double>(5000);
    EXPECT_THAT(warnings_of(stage), IsEmpty());
}

TEST(PrecisionWarnings, NamesACameraBeyondWhatDoublesHold) {
    Stage stage;
    const double far = 1e14;
    stage.shot.camera.position = PositionTrack(glm::dvec3(far, 0, 5));
    stage.shot.camera.look_at = PositionTrack(glm::dvec3(far, 0, 0));
    EXPECT_THAT(warnings_of(stage), ElementsAre(HasSubstr("the camera is 1e+14 m from the origin at 0 s, where numbers are precise to")));
}

TEST(PrecisionWarnings, NamesTheNodeThatMovesAndIsHuge) {
    Stage stage;
    const int node = stage.add_node("Ground");
    stage.node(node).scale = glm::dvec3(1e7);
    EXPECT_THAT(warnings_of(stage), IsEmpty());  // still: subdivided
    stage.animate(node).translation = track<glm::dvec3>({{0, {0, -1, 0}}, {1, {0, -2, 0}}});
    EXPECT_THAT(warnings_of(stage), ElementsAre(HasSubstr("node 'stage/Ground' moves and is")));
}

TEST(PrecisionWarnings, NamesTheMeshWhoseFileRoundedIt) {
    Stage stage;
    stage.add_node("Survey");
    stage.scene.geometries[0].centre = {4e6, 5e5, 0};
    stage.scene.geometries[0].scale = 10;
    EXPECT_THAT(warnings_of(stage), ElementsAre(HasSubstr("the vertices of node 'stage/Survey' lie 4.03e+06 from their origin, where the file's 32-bit numbers are precise to 0.24; the mesh is 20 large")));
}

TEST(PrecisionWarnings, NamesThePlateAndTheShellThatAreTooThin) {
    Stage stage;
    GeometryData& cube = stage.scene.geometries[0];
    for (int corner = 0; corner < 8; ++corner) cube.positions.push_back({corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f});
    cube.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6};  // the faces along z
    const int plate = stage.add_node("Plate");
    stage.node(plate).scale = {1, 1, 1e-7};
    EXPECT_THAT(warnings_of(stage), ElementsAre(HasSubstr("node 'stage/Plate' is 2e-07 m thick and 2 m large: rays that leave one side may start beyond the other")));
    stage.node(plate).scale = {1, 1, 1e-4};
    EXPECT_THAT(warnings_of(stage), IsEmpty());
    stage.node(plate).scale = {1, 1, 1};
    const int inner = stage.add_node("Inner");
    stage.node(inner).scale = glm::dvec3(1 - 1e-6);
    EXPECT_THAT(warnings_of(stage), ElementsAre(HasSubstr("nodes 'stage/Plate' and 'stage/Inner' are a shell 1e-06 m thick and 2 m large")));
    stage.node(inner).scale = glm::dvec3(1);  // the same place: whichever is met
    EXPECT_THAT(warnings_of(stage), IsEmpty());
    // Uneven, but with one side.
    stage.node(inner).translation = {0, 0, 7};
    stage.node(inner).scale = {1, 1, 1e-8};
    cube.indices = {0, 2, 1, 1, 2, 7};
    EXPECT_THAT(warnings_of(stage), IsEmpty());
}

TEST(PrecisionWarnings, NamesTheLightThatIsTooFaint) {
    Stage stage;
    LightSpec light;
    light.id = "glow-worm";
    light.kind = LightKind::point;
    light.strength = Track<double>(1e-25);
    stage.shot.lights.push_back(light);
    EXPECT_THAT(warnings_of(stage), ElementsAre(HasSubstr("light 'glow-worm' has the strength 1e-25 at 0 s")));
    stage.shot.lights[0].strength = Track<double>(0.0);  // switched off
    EXPECT_THAT(warnings_of(stage), IsEmpty());
}

}  // namespace
}  // namespace kadr::test
