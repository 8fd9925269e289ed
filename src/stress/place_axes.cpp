#include <cmath>

#include <glm/geometric.hpp>

#include "stress/axis_groups.h"
#include "stress/stage.h"

namespace kadr::stress {

namespace {

const glm::dvec3 kAway(0.6, 0.48, 0.64);  // unit length, along no axis
constexpr std::string_view kRounded = "mesh data is 32-bit: the file itself holds rounded vertices";

void set_distance(Stage& stage, double metres) { stage.world.offset = metres * kAway; }
void set_vertex_distance(Stage& stage, double metres) { stage.vertices.offset = metres * kAway; }
void set_scale(Stage& stage, double factor) { stage.world.scale = factor; }
void set_vertex_scale(Stage& stage, double factor) { stage.vertices.scale = factor; }

/// The floor becomes a terrain, `ratio` times as wide; the walls would stand in the subject.
void set_size_ratio(Stage& stage, double ratio) {
    stage.remove("Back");
    stage.remove("Side");
    Object& floor = stage.object("Floor");
    floor.mesh = terrain(32);
    floor.scale = glm::dvec3(4 * ratio);
}

/// The camera goes away from the ball and its lens follows, so that the ball, 2 m wide, fills the picture.
void set_telephoto(Stage& stage, double ratio) {
    constexpr double kBall = 2, kFilled = 1.3;
    Camera& camera = stage.camera;
    camera.look_at = {0, 1.05, 0};
    camera.position = camera.look_at + kBall * ratio * glm::normalize(camera.position - camera.look_at);
    camera.vertical_fov_deg = glm::degrees(2 * std::atan(0.5 * kFilled / ratio));
}

void set_authored_telephoto(Stage& stage, double ratio) {
    set_telephoto(stage, ratio);
    stage.camera.authored = true;
}

/// The floor becomes as wide as the widest pictures see.
void set_field_of_view(Stage& stage, double degrees) {
    stage.object("Floor").scale = {1e4, 1, 1e4};
    stage.camera.vertical_fov_deg = degrees;
}

}  // namespace

std::vector<Axis> place_axes() {
    return {
        {.name = "distance", .unit = "m", .meaning = "of the whole scene, its camera and its light from the origin; node transforms",
         .values = {0, 1, 1e2, 1e4, 1e6, 1e7, 1e8, 1e9}, .quick = {0, 1e4, 1e9}, .ordinary = 0, .same_picture = true, .apply = set_distance},
        {.name = "vertex_distance", .unit = "m", .meaning = "the same, but the vertices themselves lie there",
         .values = {0, 1, 1e2, 1e4, 1e6, 1e9}, .quick = {0, 1e2, 1e9}, .ordinary = 0, .limit = kRounded, .apply = set_vertex_distance},
        {.name = "scale", .unit = "", .meaning = "of the whole scene, its camera and its light; a node's scale",
         .values = {1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9}, .quick = {1e-9, 1, 1e9}, .ordinary = 1, .same_picture = true, .apply = set_scale},
        {.name = "vertex_scale", .unit = "", .meaning = "the same, but the vertices themselves have that size",
         .values = {1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9}, .quick = {1e-9, 1, 1e9}, .ordinary = 1, .same_picture = true, .apply = set_vertex_scale},
        {.name = "size_ratio", .unit = "", .meaning = "a terrain that is larger than what stands on it; 1e7 is a screw of 1 mm on 10 km",
         .values = {1, 10, 1e3, 1e5, 1e7}, .quick = {1, 1e3, 1e7}, .ordinary = 1, .apply = set_size_ratio},
        {.name = "telephoto", .unit = "", .meaning = "distance of the camera over the size of its subject, which fills the picture",
         .values = {2, 10, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7}, .quick = {2, 10, 1e6}, .ordinary = 2, .apply = set_telephoto},
        {.name = "authored_telephoto", .unit = "", .meaning = "the same by a camera of the glTF file, which does not say what it looks at",
         .values = {2, 10, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7}, .quick = {2, 10, 1e6}, .ordinary = 2, .refusals = {{1e7, "/perspective/yfov is"}}, .apply = set_authored_telephoto},
        {.name = "field_of_view", .unit = "deg", .meaning = "vertical angle of the picture; the camera stays, above a floor of 20 km",
         .values = {1e-3, 0.01, 1, 30, 120, 170, 179, 179.9}, .quick = {1e-3, 30, 179, 179.9}, .ordinary = 30, .apply = set_field_of_view},
    };
}

}  // namespace kadr::stress
