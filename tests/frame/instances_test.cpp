// Copies of a scene: where they stand, how they move, what they cost.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "frame/bindings.h"
#include "frame/decompose.h"
#include "frame/placement.h"
#include "frame/stage.h"

namespace kadr {
namespace {

using test::kPi;
using test::message_of;
using test::Stage;
using test::track;
using test::turn;

InstancesSpec list_of(std::vector<PlacementSpec> places) {
    InstancesSpec spec;
    spec.where = {"stage.yaml", 5, 14};
    spec.list = std::move(places);
    return spec;
}

InstancesSpec grid_of(std::array<int, 3> counts, glm::dvec3 spacing, double jitter = 0) {
    InstancesSpec spec;
    spec.grid = GridSpec{counts, spacing, jitter};
    return spec;
}

/// world_from_geometry of an instance at a time in [0, 1] of the shutter.
glm::dmat4 place_at(const SceneSnapshot& snapshot, std::size_t instance, double u) {
    glm::dmat4 place = interpolate(snapshot.motion, instance, u);
    for (int i = 0; i < 3; ++i) place[3][i] += snapshot.render_origin[i];
    return place;
}

TEST(Instances, StandInsideTheScenesTransform) {
    Stage stage;
    stage.add_node("Body");
    stage.shot.scenes[0].transform.translate = track<glm::dvec3>({{0, {10, 0, 0}}});
    stage.shot.scenes[0].transform.rotate.orientation = Track<glm::dquat>(turn(90));  // +x to +y
    stage.shot.scenes[0].instances = list_of({{{1, 0, 0}}, {{0, 0, 3}, turn(90, {0, 1, 0}), glm::dvec3(2)}});
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.instances.size(), 2u);
    EXPECT_EQ(snapshot.instances[0].id, 0u);
    EXPECT_EQ(snapshot.instances[1].id, 1u);
    // 3e-6: frames are floats of coordinates up to 10.
    EXPECT_NEAR(glm::distance(glm::dvec3(place_at(snapshot, 0, 0)[3]), glm::dvec3(10, 1, 0)), 0, 3e-6);
    EXPECT_NEAR(glm::distance(glm::dvec3(place_at(snapshot, 1, 0)[3]), glm::dvec3(10, 0, 3)), 0, 3e-6);
    const glm::dvec3 side(place_at(snapshot, 1, 0) * glm::dvec4(1, 0, 0, 0));  // x, turned to -z, doubled; then z stays
    EXPECT_NEAR(glm::distance(side, glm::dvec3(0, 0, -2)), 0, 3e-6);
    EXPECT_EQ(snapshot.fixed_places.size(), 2u);
}

TEST(Instances, AGridIsCentredAndXRunsFastest) {
    const std::vector<Placement> places = place_copies(grid_of({3, 1, 2}, {2, 5, 4}));
    ASSERT_EQ(places.size(), 6u);
    EXPECT_EQ(places[0].translation, glm::dvec3(-2, 0, -2));
    EXPECT_EQ(places[1].translation, glm::dvec3(0, 0, -2));
    EXPECT_EQ(places[5].translation, glm::dvec3(2, 0, 2));
}

TEST(Instances, RandomVariationIsAFunctionOfSeedAndNumber) {
    InstancesSpec spec = grid_of({10, 1, 10}, {1, 1, 1}, 0.25);
    spec.random_scale = {0.5, 2};
    spec.random_offset_s = {1, 3};
    spec.random_yaw_rad = 1;
    const std::vector<Placement> places = place_copies(spec), again = place_copies(spec);
    EXPECT_EQ(places, again);
    const std::vector<Placement> plain = place_copies(grid_of({10, 1, 10}, {1, 1, 1}));
    double least = 9, most = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(places[i].translation[axis] - plain[i].translation[axis]), 0.25);
        EXPECT_LE(2 * std::acos(std::min(1.0f, std::abs(places[i].rotation.w))), 0.5 + 1e-3);  // a float's cosine near 1
        EXPECT_GE(places[i].clip_offset_s, 1);
        EXPECT_LE(places[i].clip_offset_s, 3);
        least = std::min<double>(least, places[i].scale.x), most = std::max<double>(most, places[i].scale.x);
    }
    EXPECT_LT(least, 0.6);  // of 100 even numbers in [0.5, 2], one is below 0.6 but with a chance of 0.1 %
    EXPECT_GT(most, 1.9);
    spec.seed = 1;
    EXPECT_NE(place_copies(spec), places);
}

TEST(Instances, JitterIsAPartOfTheSpacingOfEachAxis) {
    const glm::dvec3 spacing(1, 4, 0.25);
    InstancesSpec spec = grid_of({10, 10, 10}, spacing, 0.5);
    spec.random_scale = {1, 2};
    spec.random_offset_s = {0, 1};
    spec.random_yaw_rad = 1;
    const std::vector<Placement> plain = place_copies(grid_of({10, 10, 10}, spacing)), places = place_copies(spec);
    using Numbers = std::array<double, 6>;
    Numbers least, most;
    least.fill(1), most.fill(-1);
    std::array<Numbers, 6> products{};
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 share = (places[i].translation - plain[i].translation) / spacing;
        const Numbers all{share.x, share.y, share.z, places[i].scale.x - 1.5, places[i].clip_offset_s - 0.5, 2 * std::asin(places[i].rotation.y)};
        for (std::size_t a = 0; a < 6; ++a) {
            least[a] = std::min(least[a], all[a]), most[a] = std::max(most[a], all[a]);
            for (std::size_t b = 0; b < 6; ++b) products[a][b] += all[a] * all[b] / 1000;
        }
    }
    for (std::size_t a = 0; a < 6; ++a) {
        // Of 1000 even numbers in [-0.5, 0.5] none is in the last hundredth but with a chance of 4e-5; floats.
        EXPECT_GE(least[a], -0.5 - 1e-6);
        EXPECT_LT(least[a], -0.49);
        EXPECT_LE(most[a], 0.5 + 1e-6);
        EXPECT_GT(most[a], 0.49);
        // None follows another: the mean of 1000 products has a sigma of 1 / 12 / sqrt(1000) = 0.0026.
        for (std::size_t b = 0; b < a; ++b) EXPECT_LT(std::abs(products[a][b]), 4 * 0.0026) << a << ' ' << b;
    }
}

TEST(Instances, MeetTheKeysOfTheirClipsInTheirOwnTime) {
    Stage stage;
    const int body = stage.add_node("Body");
    stage.animate(body).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {0.5, {1, 0, 0}}, {9, {0, 0, 0}}});
    stage.shot.scenes[0].instances = list_of({{{0, 0, 0}}, {{0, 1, 0}, {1, 0, 0, 0}, glm::dvec3(1), 0.3}});
    const SceneSnapshot snapshot = stage.snapshot();
    EXPECT_EQ(snapshot.motion.headers[0].frame_count, 3u);  // the key lies at a half of the shutter
    EXPECT_EQ(snapshot.motion.headers[1].frame_count, 6u);  // and at a fifth
    EXPECT_LT(snapshot.motion.max_error_px, 1e-4);  // the offset is a float: 1e-8 s, at 2 m/s and 1000 px to the metre
}

TEST(Instances, PlayTheirClipsWithAnOffset) {
    Stage stage;
    const int body = stage.add_node("Body");
    stage.animate(body).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {10, {10, 0, 0}}});
    stage.shot.scenes[0].instances = list_of({{{0, 0, 0}}, {{0, 1, 0}, {1, 0, 0, 0}, glm::dvec3(1), 2.5}});
    const SceneSnapshot snapshot = stage.snapshot(1);  // the shutter is open from 1 s to 2 s
    EXPECT_NEAR(place_at(snapshot, 0, 0.5)[3].x, 1.5, 1e-6);
    EXPECT_NEAR(place_at(snapshot, 1, 0.5)[3].x, 4.0, 1e-6);
    EXPECT_NEAR(place_at(snapshot, 1, 0.5)[3].y, 1.0, 1e-6);
}

TEST(Instances, ClipsThatJumpSplitTheShutterForEveryOffset) {
    Stage stage;
    const int body = stage.add_node("Body");
    stage.animate(body).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {1.5, {1, 0, 0}}}, Interpolation::step);
    stage.shot.scenes[0].instances = list_of({{{0, 0, 0}}, {{0, 1, 0}, {1, 0, 0, 0}, glm::dvec3(1), 0.25}});
    const std::vector<SceneSnapshot> parts = stage.snapshots(1);
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_DOUBLE_EQ(parts[0].close_s, 1.25);
    EXPECT_DOUBLE_EQ(parts[1].close_s, 1.5);
    EXPECT_EQ(place_at(parts[1], 0, 0.5)[3].x, 0);
    EXPECT_EQ(place_at(parts[1], 1, 0.5)[3].x, 1);
}

TEST(Instances, KeepTheMotionToleranceSheared) {
    // Copies that lean under a scene that is squeezed while it turns: the true path has shear.
    Stage stage;
    const int body = stage.add_node("Body");
    stage.shot.scenes[0].transform.scale = Track<glm::dvec3>(glm::dvec3(1, 2, 1));
    stage.animate(body).rotation = track<glm::dquat>({{0, turn(0)}, {1, turn(60)}});
    stage.shot.scenes[0].instances = list_of({{{0.5, 0, 0}, turn(30)}, {{-0.5, 0, 0}, turn(-20), glm::dvec3(1, -1, 1)}});
    const BoundShot bound = stage.bind();
    const SceneSnapshot snapshot = stage.snapshot();
    for (const FrameType type : snapshot.motion.types) EXPECT_EQ(type, FrameType::matrix);
    const Bindings& bindings = bound.bindings();
    for (std::size_t i = 0; i < 2; ++i) {
        const auto path = [&](double time) { return bindings.node_transform(body, bindings.instances[i].copy, time); };
        EXPECT_LE(test::worst_error_px(stage, snapshot, i, path, 500), stage.shot.render.motion_tolerance_px) << i;
    }
}

TEST(Instances, AMirroredCopyStaysMirroredAndAZeroScaleIsHidden) {
    Stage stage;
    stage.add_node("Body");
    stage.shot.scenes[0].instances = list_of({{{0, 0, 0}, {1, 0, 0, 0}, glm::dvec3(-1, 1, 1)}, {{2, 0, 0}}});
    EXPECT_LT(glm::determinant(glm::dmat3(place_at(stage.snapshot(), 0, 0))), 0);
    stage.scene.placement_sets.push_back({Placement{{0, 0, 0}, {1, 0, 0, 0}, glm::vec3(0)}, Placement{{1, 0, 0}}});
    stage.node(0).placement_set = 0;
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.instances.size(), 2u);  // of four: those of size zero are left out
    EXPECT_EQ(snapshot.instances[0].id, 1u);
    EXPECT_EQ(snapshot.instances[1].id, 3u);
}

TEST(Instances, TheirOwnPlacesComeBelowTheNode) {
    Stage stage;
    const int body = stage.add_node("Body");
    stage.node(body).scale = glm::dvec3(2);
    stage.node(body).placement_set = 0;
    stage.scene.placement_sets.push_back({Placement{{1, 0, 0}}, Placement{{0, 3, 0}}});
    stage.shot.scenes[0].instances = list_of({{{10, 0, 0}}, {{20, 0, 0}}});
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.instances.size(), 4u);
    const glm::dvec3 wanted[] = {{12, 0, 0}, {10, 6, 0}, {22, 0, 0}, {20, 6, 0}};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(glm::distance(glm::dvec3(place_at(snapshot, i, 0)[3]), wanted[i]), 0, 1e-5) << i;
}

TEST(Instances, ReferencesMeanTheFirstCopy) {
    Stage stage;
    stage.add_node("Body");
    stage.shot.scenes[0].instances = list_of({{{0, 7, 0}}, {{0, 9, 0}}});
    stage.shot.camera.look_at = NodeReference{"stage/Body", {}};
    const BoundShot bound = stage.bind();
    EXPECT_EQ(bound.bindings().position_of({"stage/Body", {}}, 0), glm::dvec3(0, 7, 0));
}

TEST(Instances, LightsAreRepeatedUpToALimit) {
    Stage stage;
    const int lamp = stage.add_node("Lamp");
    stage.scene.lights.resize(1);
    stage.node(lamp).light = 0;
    stage.shot.scenes[0].instances = list_of({{{1, 0, 0}}, {{2, 0, 0}}});
    const SceneSnapshot snapshot = stage.snapshot();
    ASSERT_EQ(snapshot.lights.size(), 2u);
    EXPECT_EQ(snapshot.light_keys[1].position.x + snapshot.render_origin.x, 2);
    stage.shot.scenes[0].instances = grid_of({1025, 1, 1}, glm::dvec3(1));
    stage.shot.scenes[0].instances->where = {"stage.yaml", 5, 14};
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:5:14: error: 1025 copies repeat the light of node 'stage/Lamp'\n"
              "  expected at most 1024 copies of a light; leave it out with hide, or all with use_scene_lights: false");
}

TEST(Instances, ThatShineAreLimited) {
    Stage stage;
    stage.add_node("Lamp");
    stage.add_node("Stand");
    stage.node(1).primitives[0] = {1, 1};
    stage.scene.geometries[0].indices.resize(3 * 1000);
    stage.scene.geometries.push_back(stage.scene.geometries[0]);
    stage.scene.materials.resize(2);
    stage.scene.materials[0].emission = {1, 1, 1};
    stage.shot.scenes[0].instances = grid_of({160, 1, 100}, glm::dvec3(1));
    stage.shot.scenes[0].instances->where = {"stage.yaml", 5, 14};
    EXPECT_EQ(message_of([&] { stage.bind(); }), "no error");  // 16 million
    stage.shot.scenes[0].instances->grid->counts = {160, 10, 100};
    EXPECT_EQ(message_of([&] { stage.bind(); }),
              "stage.yaml:5:14: error: 160000 copies of the mesh of node 'stage/Lamp' shine with 1000 triangles each: as lights, all shining copies take about 20.5 GB\n"
              "  expected at most 16 million shining triangles in copies: fewer copies, a coarser mesh, or no emission (materials: emissive: [0, 0, 0])");
    stage.scene.materials[0].unlit = true;  // seen, but no light
    EXPECT_EQ(message_of([&] { stage.bind(); }), "no error");
    stage.scene.materials[0].unlit = false;
    stage.scene.material_names = {"Glow", "Wood"};
    stage.scene.material_sources.resize(2);
    stage.scene.files[0].material_count = 2;
    MaterialSpec glow;
    glow.name = "Glow";
    glow.emissive = Track<glm::dvec3>(glm::dvec3(0));
    stage.shot.scenes[0].materials = {glow};
    EXPECT_EQ(message_of([&] { stage.bind(); }), "no error");
    stage.shot.scenes[0].materials[0].emissive = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 0, 0}}});
    EXPECT_NE(message_of([&] { stage.bind(); }), "no error");
}

TEST(Instances, ThatShineCountTheirOwnPlaces) {
    Stage stage;
    stage.add_node("Lamp");
    stage.scene.geometries[0].indices.resize(3 * 1000);
    stage.scene.materials[0].emission = {0, 0, 1};
    stage.scene.placement_sets.push_back(std::vector<Placement>(16'001));
    stage.node(0).placement_set = 0;
    EXPECT_NE(message_of([&] { stage.bind(); }).find("stage.yaml:3:5: error: 16001 copies of the mesh of node 'stage/Lamp' shine"), std::string::npos);
    stage.node(0).placement_set = -1;
    EXPECT_EQ(message_of([&] { stage.bind(); }), "no error");
}

/// A second scene with a square of 2 m, in which the first is strewn.
Stage strewn_stage(int count, ScatterSpec::Align align = ScatterSpec::Align::up) {
    Stage stage;
    stage.add_node("Tree");
    SceneFile ground;
    ground.id = "ground";
    ground.first_node = 1;
    ground.node_count = 1;
    ground.roots = {1};
    stage.scene.files.push_back(ground);
    stage.shot.scenes.push_back(stage.shot.scenes[0]);
    stage.shot.scenes[1].id = "ground";
    GeometryData square;
    square.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
    square.indices = {0, 2, 1, 0, 3, 2};
    stage.scene.geometries.push_back(square);
    Node node;
    node.name = "Hill";
    node.primitives.push_back({1, 0});
    stage.scene.nodes.push_back(node);
    InstancesSpec spec;
    spec.scatter = ScatterSpec{"ground/Hill", {"stage.yaml", 6, 20}, count, align};
    stage.shot.scenes[0].instances = spec;
    return stage;
}

TEST(Scatter, CoversASurfaceEvenly) {
    Stage stage = strewn_stage(4000);
    stage.node(1).translation = {3, 1, 0};
    const BoundShot bound = stage.bind();
    const std::span<const Placement> copies = bound.bindings().instances.copies_of(0);
    ASSERT_EQ(copies.size(), 4000u);
    std::array<int, 16> cells{};
    for (const Placement& copy : copies) {
        EXPECT_DOUBLE_EQ(copy.translation.y, 1);
        const int x = static_cast<int>(std::floor((copy.translation.x - 2) * 2)), z = static_cast<int>(std::floor((copy.translation.z + 1) * 2));
        ASSERT_TRUE(x >= 0 && x < 4 && z >= 0 && z < 4);
        ++cells[static_cast<std::size_t>(4 * z + x)];
    }
    double chi_squared = 0;
    for (const int cell : cells) chi_squared += (cell - 250.0) * (cell - 250.0) / 250;
    EXPECT_LT(chi_squared, 30.58);  // 99 % of a chi-squared distribution with 15 degrees of freedom; the seed is fixed
}

double least_distance(std::span<const Placement> copies) {
    double least = INFINITY;
    for (std::size_t i = 0; i < copies.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) least = std::min(least, glm::distance(copies[i].translation, copies[k].translation));
    return least;
}

TEST(Scatter, KeepsTheDistance) {
    Stage stage = strewn_stage(200);
    const auto copies = [&](const BoundShot& bound) { return bound.bindings().instances.copies_of(0); };
    EXPECT_LT(least_distance(copies(stage.bind())), 0.02);  // or the test proved nothing: the mean is 0.5 / sqrt(200 / 4 m2)
    stage.shot.scenes[0].instances->scatter->distance_m = 0.08;
    const BoundShot bound = stage.bind();
    ASSERT_EQ(copies(bound).size(), 200u);
    EXPECT_GE(least_distance(copies(bound)), 0.08);
    EXPECT_TRUE(bound.warnings().empty() || bound.warnings()[0].text().find("scatter") == std::string::npos);
    // The same again; others with another seed.
    const BoundShot again = stage.bind();
    for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(copies(again)[i].translation, copies(bound)[i].translation);
    stage.shot.scenes[0].instances->seed = 1;
    EXPECT_NE(copies(stage.bind())[0].translation, copies(bound)[0].translation);
}

TEST(Scatter, KeepsTheDistanceInTheWorld) {
    Stage stage = strewn_stage(20);
    stage.shot.scenes[0].instances->scatter->distance_m = 0.3;
    stage.shot.scenes[0].transform.scale = Track<glm::dvec3>(glm::dvec3(2));  // undone by the placements
    const BoundShot bound = stage.bind();
    ASSERT_EQ(bound.bindings().instances.copies_of(0).size(), 20u);
    EXPECT_GE(least_distance(bound.bindings().instances.copies_of(0)), 0.15);
    EXPECT_LT(least_distance(bound.bindings().instances.copies_of(0)), 0.3);
}

TEST(Scatter, MakesAsManyAsFitAndSaysSo) {
    Stage stage = strewn_stage(100'000);
    stage.shot.scenes[0].instances->scatter->distance_m = 0.1;
    const BoundShot bound = stage.bind();
    const std::span<const Placement> copies = bound.bindings().instances.copies_of(0);
    EXPECT_GE(least_distance(copies), 0.1);
    // Random sequential addition of discs covers 0.547 of a plane (Feder 1980); discs may hang over the edge of 2 m.
    const double coverage = static_cast<double>(copies.size()) * kPi * 0.05 * 0.05 / (2.1 * 2.1);
    EXPECT_GT(coverage, 0.44);  // 80 % of it: a thousand misses in a row end the throwing
    EXPECT_LT(coverage, 0.547);
    std::string text;
    for (const Diagnostic& warning : bound.warnings()) text += warning.text() + "\n";
    EXPECT_NE(text.find(fmt::format("stage.yaml:6:20: warning: scatter: {} of 100000 copies fit on 'ground/Hill' at a distance of 0.1 m\n"
                                    "  give a smaller distance, or a smaller count", copies.size())), std::string::npos) << text;
}

TEST(Scatter, ThatKeepsNoDistanceIsAsItWas) {
    // Numbers of the copies go into their random variation: shots rendered before keep their pictures.
    const Stage stage = strewn_stage(3);
    const BoundShot bound = stage.bind();
    const std::span<const Placement> copies = bound.bindings().instances.copies_of(0);
    for (std::uint32_t i = 0; i < 3; ++i) {
        const double root = std::sqrt(random_unit(0, i, 17)), along = random_unit(0, i, 18);
        const bool first = random_unit(0, i, 16) < 0.5;
        const glm::dvec3 a(-1, 0, -1), b = first ? glm::dvec3(1, 0, 1) : glm::dvec3(-1, 0, 1), c = first ? glm::dvec3(1, 0, -1) : glm::dvec3(1, 0, 1);
        EXPECT_NEAR(glm::distance(copies[i].translation, (1 - root) * a + root * (1 - along) * b + root * along * c), 0, 1e-12) << i;
    }
}

TEST(RandomOffsets, InStepsAreShared) {
    InstancesSpec spec = grid_of({1000, 1, 1}, glm::dvec3(1));
    spec.random_offset_s = {1, 3};
    spec.offset_steps = 4;
    std::map<float, int> seen;
    for (const Placement& copy : place_copies(spec)) ++seen[copy.clip_offset_s];
    ASSERT_EQ(seen.size(), 4u);
    float wanted = 1;
    for (const auto& [offset, count] : seen) {
        EXPECT_EQ(offset, wanted);
        EXPECT_NEAR(count, 250, 60);  // 4 sigma of a binomial: sqrt(1000 / 4 * 3 / 4) = 13.7
        wanted += 0.5f;
    }
}

TEST(Scatter, StandsOnTheNormal) {
    Stage stage = strewn_stage(50, ScatterSpec::Align::normal);
    stage.node(1).rotation = turn(-90);  // the square's +y becomes +x
    const BoundShot bound = stage.bind();
    for (const Placement& copy : bound.bindings().instances.copies_of(0))
        EXPECT_NEAR(glm::distance(copy.rotation * glm::vec3(0, 1, 0), glm::vec3(1, 0, 0)), 0, 1e-5);
}

TEST(Scatter, RefusesWhatIsNoGround) {
    Stage moving = strewn_stage(10);
    moving.shot.scenes[1].transform.translate = track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 0, 0}}});
    EXPECT_EQ(message_of([&] { moving.bind(); }),
              "stage.yaml:6:20: error: scatter: 'ground/Hill' moves: node 'ground/Hill'\n  expected a surface that stands still");
    Stage itself = strewn_stage(10);
    itself.shot.scenes[0].instances->scatter->target = "stage";
    EXPECT_EQ(message_of([&] { itself.bind(); }),
              "stage.yaml:6:20: error: scatter: 'stage' is the scene that is strewn\n  expected another scene or a node of one");
    Stage flat = strewn_stage(10);
    flat.node(1).scale = glm::dvec3(0, 1, 0);
    EXPECT_EQ(message_of([&] { flat.bind(); }),
              "stage.yaml:6:20: error: scatter: 'ground/Hill' has no surface to strew on\n  expected a node whose meshes have an area");
}

/// What the sequencer keeps of the instances and their frames.
std::size_t kept_bytes(const BoundShot& bound, const SceneSnapshot& snapshot) {
    const auto bytes = [](const auto& values) {
        const std::size_t shared = values.shared() ? values.shared()->capacity() : 0;
        return (shared + values.own().capacity()) * sizeof(values[0]);
    };
    const MotionFrames& motion = snapshot.motion;
    return bound.bindings().instances.bytes() + bytes(snapshot.instances) + bytes(snapshot.fixed_places) + bytes(motion.headers) + bytes(motion.types) +
           bytes(motion.srt) + bytes(motion.matrices) + bytes(motion.linear);
}

/// "Under 200 bytes of our own memory each beside the device's."
TEST(Instances, AHundredThousandCostLessThanTwoHundredBytesEach) {
    Stage stage;
    const int body = stage.add_node("Body");
    stage.animate(body).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {10, {10, 0, 0}}});
    stage.shot.scenes[0].instances = grid_of({1000, 1, 100}, glm::dvec3(1));
    const BoundShot bound = stage.bind();
    const SceneSnapshot snapshot = make_snapshots(bound, bound.sequence().frame(0)).front();
    ASSERT_EQ(snapshot.instances.size(), 100'000u);
    EXPECT_EQ(snapshot.motion.srt.size(), 200'000u);  // two keys each: they drift
    EXPECT_LT(static_cast<double>(kept_bytes(bound, snapshot)) / 100'000, 200);
}

TEST(Instances, CostNoMoreWhereSomethingElseIsSheared) {
    Stage stage;
    const int body = stage.add_node("Body"), squeezed = stage.add_node("Squeezed", -1, false), leaning = stage.add_node("Leaning", squeezed);
    stage.animate(body).translation = track<glm::dvec3>({{0, {0, 0, 0}}, {10, {10, 0, 0}}});
    stage.node(squeezed).scale = {1, 2, 1};
    stage.node(leaning).rotation = turn(30);
    stage.scene.placement_sets.push_back(std::vector<Placement>(100'000));
    stage.node(body).placement_set = 0;
    const BoundShot bound = stage.bind();
    const SceneSnapshot snapshot = make_snapshots(bound, bound.sequence().frame(0)).front();
    ASSERT_EQ(snapshot.instances.size(), 100'001u);
    EXPECT_EQ(snapshot.motion.srt.size(), 200'000u);
    EXPECT_EQ(snapshot.motion.matrices.size(), 1u);  // the one that leans
    // The places are the scene's: a file of 100,000 of them would hold them as well.
    EXPECT_LT(static_cast<double>(kept_bytes(bound, snapshot)) / 100'000 + sizeof(Placement), 200);
}

}  // namespace
}  // namespace kadr
