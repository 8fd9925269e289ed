#include <glm/geometric.hpp>

#include "stress/axis_groups.h"
#include "stress/stage.h"

namespace kadr::stress {

namespace {

void set_aspect(Stage& stage, double aspect) {
    stage.object("Floor").mesh = sliver_square(aspect);
    stage.object("Ball").mesh = sliver_sphere(aspect);
}

void add_empty(Stage& stage, double count) {
    for (Object& object : stage.objects) add_empty_triangles(object.mesh, static_cast<int>(count));
}

void set_fan(Stage& stage, double triangles) {
    Object& floor = stage.object("Floor");
    floor.mesh = disc(static_cast<int>(triangles));
    floor.scale = glm::dvec3(5, 1, 5);
    Object& block = stage.object("Block");
    block.mesh = cone(static_cast<int>(triangles));
    block.translate.y = 0;
    block.scale = {0.5, 1, 0.5};
}

/// In front of the ball, a few pixels large: every ray that meets it meets all of them.
void add_coincident(Stage& stage, double count) {
    Object sheet;
    sheet.name = "Sheet";
    sheet.mesh = repeated_triangle(static_cast<int>(count));
    sheet.translate = {0.5, 1.3, 1.4};
    sheet.scale = glm::dvec3(0.15);
    stage.objects.push_back(std::move(sheet));
}

/// A second ball inside the first, of another colour, which shows wherever a ray slips through.
Object inner_ball(const Stage& stage, double scale) {
    Object inner;
    for (const Object& object : stage.objects)
        if (object.name == "Ball") inner = object;
    inner.name = "Inner";
    inner.scale *= scale;
    inner.material.base_color = {0.05, 0.1, 0.9};
    return inner;
}

void set_thickness(Stage& stage, double part) {
    stage.objects.push_back(inner_ball(stage, 1 - part));
    Object& plate = stage.object("Block");
    const double width = 0.8;
    plate.scale = {width, part * width, width};
    plate.translate.y = 0.5;
}

void set_gap(Stage& stage, double part) {
    Object& block = stage.object("Block");
    block.translate.y = block.scale.y * (1 + 2 * part);
    Object& ball = stage.object("Ball");
    ball.translate.y = 1 + 2 * part;
}

void set_nesting(Stage& stage, double count) {
    for (int i = 1; i <= static_cast<int>(count); ++i) {
        Object inner = inner_ball(stage, 1 - 1e-3 * i);
        inner.name += std::to_string(i);
        stage.objects.push_back(std::move(inner));
    }
}

/// Squares of the floor's own material on the floor.
void add_coplanar(Stage& stage, double count) {
    for (int i = 0; i < static_cast<int>(count); ++i) {
        Object layer = stage.object("Floor");
        layer.name = "Layer" + std::to_string(i);
        layer.scale *= glm::dvec3(1 - 0.03 * (i + 1), 1, 1 - 0.03 * (i + 1));
        stage.objects.push_back(std::move(layer));
    }
}

/// Reflections need something with a size to show.
Material& shiny_ball(Stage& stage) {
    stage.key.radius_m = 0.3;
    return stage.object("Ball").material;
}

void set_roughness(Stage& stage, double roughness) {
    Material& material = shiny_ball(stage);
    material.metallic = 1;
    material.roughness = roughness;
}

void set_metallic(Stage& stage, double metallic) {
    Material& material = shiny_ball(stage);
    material.metallic = metallic;
    material.roughness = 0.3;
}

void set_ior(Stage& stage, double ior) {
    Material& material = shiny_ball(stage);
    material.ior = ior;
    material.roughness = 0.3;
}

}  // namespace

std::vector<Axis> surface_axes() {
    return {
        {.name = "aspect", .unit = "", .meaning = "length over width of a bundle of triangles in the ball and in the floor",
         .values = {1e2, 1e3, 1e4, 1e5, 1e6, 1e7}, .quick = {1e2, 1e4, 1e7}, .ordinary = 1e2, .same_picture = true, .apply = set_aspect},
        {.name = "empty_triangles", .unit = "", .meaning = "triangles without area in every mesh: points, doubled edges, three points on a line",
         .values = {0, 1, 3, 1e2, 1e4}, .quick = {0, 3, 1e4}, .ordinary = 0, .same_picture = true, .apply = add_empty},
        {.name = "fan", .unit = "", .meaning = "needles that meet in one vertex, of a floor and of a cone",
         .values = {8, 32, 1e3, 1e4, 1e5, 1e6}, .quick = {32, 1e4}, .ordinary = 32, .apply = set_fan},
        {.name = "coincident", .unit = "", .meaning = "triangles in the same place",
         .values = {1, 10, 1e3, 1e5, 1e6, 1e7}, .quick = {1, 1e4}, .ordinary = 1, .same_picture = true, .apply = add_coincident},
        {.name = "thickness", .unit = "", .meaning = "of a shell around another colour, and of a plate, as a part of their size",
         .values = {1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}, .quick = {1e-9, 1e-5, 1e-1}, .ordinary = 1e-1, .safe_low = 1e-5, .apply = set_thickness},
        {.name = "gap", .unit = "", .meaning = "between the floor and what stands on it, as a part of its size; negative: sunk into it",
         .values = {-1e-1, -1e-3, -1e-6, -1e-9, 0, 1e-9, 1e-6, 1e-4, 1e-2, 1e-1}, .quick = {-1e-3, 0, 1e-9, 1e-4, 1e-1}, .ordinary = 1e-1, .apply = set_gap},
        {.name = "nested", .unit = "", .meaning = "balls inside the ball, each a thousandth smaller, of another colour",
         .values = {0, 1, 3, 30, 300}, .quick = {0, 3, 30}, .ordinary = 0, .same_picture = true, .apply = set_nesting},
        {.name = "coplanar", .unit = "", .meaning = "more squares of the floor's material in the floor's plane",
         .values = {0, 1, 2, 16}, .quick = {0, 2, 16}, .ordinary = 0, .same_picture = true, .apply = add_coplanar},
        {.name = "roughness", .unit = "", .meaning = "of a ball of metal, a lamp in its reflection; a mirror below 0.0032",
         .values = {0, 1e-6, 1e-4, 1e-3, 3.1e-3, 3.2e-3, 1e-2, 3e-2, 0.1, 0.3, 0.6, 1}, .quick = {0, 1e-6, 3.2e-3, 1e-2, 0.3, 1}, .ordinary = 0.3, .apply = set_roughness},
        {.name = "metallic", .unit = "", .meaning = "of a ball of roughness 0.3",
         .values = {0, 1e-6, 0.1, 0.5, 0.9, 1}, .quick = {0, 0.5, 1}, .ordinary = 0, .apply = set_metallic},
        {.name = "ior", .unit = "", .meaning = "index of refraction of a ball of roughness 0.3; 0 stands for an infinite one",
         .values = {0, 1, 1.0001, 1.5, 5, 1e6}, .quick = {0, 1, 1.0001, 1.5, 5}, .ordinary = 1.5, .apply = set_ior},
    };
}

}  // namespace kadr::stress
