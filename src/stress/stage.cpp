#include "stress/stage.h"

#include <algorithm>
#include <cassert>

namespace kadr::stress {

namespace {

/// A quarter turn about an axis.
glm::dquat quarter_turn(const glm::dvec3& axis, double sign) { return glm::angleAxis(sign * glm::radians(90.0), axis); }

Object make(const char* name, Mesh mesh, const glm::dvec3& color, const glm::dvec3& translate, const glm::dvec3& scale) {
    Object object;
    object.name = name;
    object.mesh = std::move(mesh);
    object.material.base_color = color;
    object.translate = translate;
    object.scale = scale;
    return object;
}

constexpr double kHalfWidth = 4;

}  // namespace

Object& Stage::object(const std::string& object_name) {
    const auto found = std::find_if(objects.begin(), objects.end(), [&](const Object& object) { return object.name == object_name; });
    assert(found != objects.end());
    return *found;
}

void Stage::remove(const std::string& object_name) {
    std::erase_if(objects, [&](const Object& object) { return object.name == object_name; });
}

Stage base_stage() {
    Stage stage;
    const glm::dvec3 wide(kHalfWidth, 1, kHalfWidth);
    stage.objects = {make("Floor", square(), {0.5, 0.5, 0.5}, {0, 0, 0}, wide),
                     make("Back", square(), {0.5, 0.5, 0.6}, {0, kHalfWidth, -3}, wide),
                     make("Side", square(), {0.35, 0.55, 0.4}, {-3, kHalfWidth, 0}, wide),
                     make("Ball", sphere(), {0.6, 0.5, 0.4}, {0, 1.05, 0}, {1, 1, 1}),
                     make("Block", cube(), {0.5, 0.4, 0.6}, {1.7, 0.35, 0.7}, {0.35, 0.35, 0.35})};
    stage.object("Back").rotate = quarter_turn({1, 0, 0}, 1);   // faces +z
    stage.object("Side").rotate = quarter_turn({0, 0, 1}, -1);  // faces +x
    stage.camera = {{3, 2.6, 6.6}, {0.3, 0.9, 0}, 30, false};
    stage.key.strength = 40;
    stage.key.position = {2.5, 4, 3};
    stage.key.target = {0, 0.5, 0};
    return stage;
}

}  // namespace kadr::stress
