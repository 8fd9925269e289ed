// scenes.instances: its forms, and what is said about those that make no sense.
#include <gtest/gtest.h>

#include <cmath>

#include "shot/shot_fixture.h"

namespace kadr {
namespace {

class InstanceForms : public ShotTest {
protected:
    static InstancesSpec instances(const std::string& text) {
        return parse_scene("{ gltf: a.glb, instances: " + text + " }").scenes[0].instances.value();
    }
    static std::string error(const std::string& text) {
        return errors_of("kadr: 1\nscenes:\n  - gltf: a.glb\n    instances: " + text + "\ncamera: {}\n");
    }
};

TEST_F(InstanceForms, AListOfPlaces) {
    const InstancesSpec spec = instances("[ { translate: [1, 2, 3] }, { rotate: [0, 90 deg, 0], scale: 2, offset: 12 f } ]");
    ASSERT_EQ(spec.list.size(), 2u);
    EXPECT_EQ(spec.list[0].translate_m, glm::dvec3(1, 2, 3));
    EXPECT_EQ(spec.list[1].scale, glm::dvec3(2));
    EXPECT_EQ(spec.list[1].offset_s, 0.5);
    EXPECT_NEAR(spec.list[1].rotate.y, std::sqrt(0.5), 1e-15);
}

TEST_F(InstanceForms, GridsAndScatters) {
    const InstancesSpec grid = instances("{ grid: [10, 1, 5], spacing: [2 m, 1, 50 cm], jitter: 0.3, seed: 7, random_scale: [0.5, 2] }");
    EXPECT_EQ(grid.grid, (GridSpec{{10, 1, 5}, {2, 1, 0.5}, 0.3}));
    EXPECT_EQ(grid.seed, 7u);
    EXPECT_EQ(grid.random_scale, glm::dvec2(0.5, 2));
    const InstancesSpec scatter = instances("{ scatter: ground/Hill, count: 200, align: normal, random_yaw: 180 deg, random_offset: [0 s, 24 f] }");
    EXPECT_EQ(scatter.scatter->target, "ground/Hill");
    EXPECT_EQ(scatter.scatter->count, 200);
    EXPECT_EQ(scatter.scatter->align, ScatterSpec::Align::normal);
    EXPECT_EQ(scatter.random_offset_s, glm::dvec2(0, 1));
    EXPECT_EQ(scatter.scatter->distance_m, 0);
    EXPECT_EQ(scatter.offset_steps, 0);
    const InstancesSpec apart = instances("{ scatter: ground, count: 9, distance: 50 cm, random_offset: [0 s, 2 s], offset_steps: 4 }");
    EXPECT_EQ(apart.scatter->distance_m, 0.5);
    EXPECT_EQ(apart.offset_steps, 4);
    EXPECT_NE(apart, instances("{ scatter: ground, count: 9, distance: 40 cm, random_offset: [0 s, 2 s], offset_steps: 4 }"));
    EXPECT_NE(apart, instances("{ scatter: ground, count: 9, distance: 50 cm, random_offset: [0 s, 2 s], offset_steps: 5 }"));
    EXPECT_FALSE(parse_scene("a.glb").scenes[0].instances.has_value());
}

TEST_F(InstanceForms, Messages) {
    EXPECT_EQ(error("[]"), R"(shot.yaml:4:16: error: scenes.0.instances is an empty list
        instances: []
                   ^~
  expected a list of maps or a map of translate, rotate, scale, offset, grid, spacing, jitter, scatter, count, distance, align, seed, random_yaw, random_scale, random_offset, offset_steps; for example instances: { grid: [10, 1, 10], spacing: [2 m, 2 m, 2 m] })");
    EXPECT_EQ(error("{ spacing: [1, 1, 1] }"), R"(shot.yaml:4:16: error: scenes.0.instances says neither grid nor scatter
        instances: { spacing: [1, 1, 1] }
                   ^~~~~~~~~~~~~~~~~~~~~~
  expected one of them, or a list of places)");
    EXPECT_EQ(error("{ grid: [2, 0, 2] }"), R"(shot.yaml:4:28: error: scenes.0.instances.grid[1] is 0
        instances: { grid: [2, 0, 2] }
                               ^
  expected [x, y, z], each 1 to 16777215)");
    EXPECT_EQ(error("{ grid: [2, 1.5, 2] }"), R"(shot.yaml:4:24: error: scenes.0.instances.grid is a list of 3
        instances: { grid: [2, 1.5, 2] }
                           ^~~~~~~~~~~
  expected whole numbers: copies along x, y and z)");
    EXPECT_EQ(error("{ grid: [5000, 1, 5000] }"), R"(shot.yaml:4:24: error: scenes.0.instances.grid makes 25000000 copies
        instances: { grid: [5000, 1, 5000] }
                           ^~~~~~~~~~~~~~~
  expected at most 16777215)");
    EXPECT_EQ(error("{ scatter: ground }"), R"(shot.yaml:4:27: error: scenes.0.instances has no count
        instances: { scatter: ground }
                              ^~~~~~
  expected count: the number of copies)");
    EXPECT_EQ(error("{ scatter: ground, count: 5, random_scale: [2, 1] }"), R"(shot.yaml:4:59: error: scenes.0.instances.random_scale is a list of 2, from more to less
        instances: { scatter: ground, count: 5, random_scale: [2, 1] }
                                                              ^~~~~~
  expected [least, largest])");
    EXPECT_EQ(error("{ scatter: ground, count: 5, offset_steps: 4 }"), R"(shot.yaml:4:59: error: scenes.0.instances has offset_steps and no random_offset
        instances: { scatter: ground, count: 5, offset_steps: 4 }
                                                              ^
  expected random_offset: the range that the steps divide)");
    EXPECT_EQ(error("{ scatter: ground, count: 5, distance: -1 m }"), R"(shot.yaml:4:55: error: scenes.0.instances.distance is -1 m
        instances: { scatter: ground, count: 5, distance: -1 m }
                                                          ^~~~
  expected at least 0 m)");
    EXPECT_EQ(error("[ { scale: 0 } ]"), R"(shot.yaml:4:27: error: scenes.0.instances.0.scale is zero
        instances: [ { scale: 0 } ]
                              ^
  expected a scale that is not zero; a tiny one such as 1e-6 makes things vanish)");
    EXPECT_EQ(error("[ { translate: [.nan, 0, 0] } ]"), R"(shot.yaml:4:32: error: scenes.0.instances.0.translate[0] is .nan
        instances: [ { translate: [.nan, 0, 0] } ]
                                   ^~~~
  expected [x, y, z]; infinite numbers and NaN are not allowed)");
    EXPECT_EQ(error("[ { rotate: { keys: { 0 s: [0, 0, 0], 1 s: [0, 9, 0] } } } ]"), R"(shot.yaml:4:28: error: scenes.0.instances.0.rotate is keyed
        instances: [ { rotate: { keys: { 0 s: [0, 0, 0], 1 s: [0, 9, 0] } } } ]
                               ^~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~
  expected a constant: animate the scene's transform, or its clips with `offset`)");
    EXPECT_EQ(error("[ { count: 3 } ]"), R"(shot.yaml:4:20: error: scenes.0.instances.0.count does not apply here
        instances: [ { count: 3 } ]
                       ^~~~~
  a list holds places: translate, rotate, scale, offset; for a grid or a scatter write a map)");
}

}  // namespace
}  // namespace kadr
