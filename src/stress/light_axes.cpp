#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "stress/axis_groups.h"
#include "stress/stage.h"
#include "stress/sun_image.h"

namespace kadr::stress {

namespace {

void make_sun(Stage& stage) {
    stage.key.kind = LightKind::directional;
    stage.key.strength = 2;
}

/// From the open side of the box, so that it reaches the floor however low it stands.
void set_elevation(Stage& stage, double radians) {
    make_sun(stage);
    const double sideways = std::cos(radians) / std::numbers::sqrt2;
    stage.key.position = {sideways, std::sin(radians), sideways};
    stage.key.target = {0, 0, 0};
}

void set_sun_diameter(Stage& stage, double degrees) {
    make_sun(stage);
    stage.key.diameter_deg = degrees;
}

void set_range(Stage& stage, double metres) { stage.key.range_m = metres; }

void set_spot_edge(Stage& stage, double degrees) {
    constexpr double kOuter = 20;
    stage.key.kind = LightKind::spot;
    stage.key.outer_deg = kOuter;
    stage.key.inner_deg = kOuter - degrees;
}

/// A small one sends as much light as one of 1 m; one that covers the sky has a radiance of its own.
void set_area_side(Stage& stage, double metres) {
    stage.key.kind = LightKind::area;
    stage.key.side_m = metres;
    stage.key.strength = 60 / (metres * metres) + 0.6;
    stage.key.position.y = 5;
    stage.key.target = stage.key.position - glm::dvec3(0, 1, 0);
}

/// Everything that shines, and the exposure against it.
void set_intensity(Stage& stage, double factor) {
    stage.key.strength *= factor;
    stage.sky *= factor;
    stage.exposure_stops = -std::log2(factor);
}

/// The same illuminance for every contrast.
void set_contrast(Stage& stage, double ratio) {
    constexpr double kIlluminance = 1.5;
    stage.key.strength = 0;
    stage.sky = kIlluminance / (std::numbers::pi + ratio * sun_solid_angle());
    stage.sky_sun = ratio * stage.sky;
}

constexpr double kCeiling = 5;  // of lamps that hang over the floor

/// A sheet at a height that hides a lamp from what is below, or from what is above.
void add_sheet(Stage& stage, double height) {
    Object sheet;
    sheet.name = "Sheet";
    sheet.mesh = square();
    sheet.scale = {1.5, 1, 1.5};
    sheet.translate.y = height;
    stage.objects.push_back(std::move(sheet));
}

void hang(Lamp& lamp) {
    lamp.position = {0, kCeiling, 0};
    lamp.target = {0, 0, 0};
}

void hang_panel(Stage& stage) {
    hang(stage.key);
    stage.key.kind = LightKind::area;
}

/// Two triangles that emit take the lamp's place.
void hang_mesh(Stage& stage) {
    Object lamp;
    lamp.name = "Lamp";
    lamp.mesh = square();
    lamp.translate.y = kCeiling;
    lamp.scale = glm::dvec3(0.5);
    lamp.material.emission = stage.key.strength;
    stage.key.strength = 0;
    stage.objects.push_back(std::move(lamp));
}

void set_cover_of_point(Stage& stage, double part) {
    hang(stage.key);
    add_sheet(stage, kCeiling - part * kCeiling);
}

void set_cover_of_ball(Stage& stage, double part) {
    hang(stage.key);
    stage.key.radius_m = 0.25;
    add_sheet(stage, kCeiling - stage.key.radius_m - part * kCeiling);
}

void set_cover_of_panel(Stage& stage, double part) {
    hang_panel(stage);
    add_sheet(stage, kCeiling - part * kCeiling);
}

void set_cover_of_mesh(Stage& stage, double part) {
    hang_mesh(stage);
    add_sheet(stage, kCeiling - part * kCeiling);
}

void set_back_of_panel(Stage& stage, double part) {
    hang_panel(stage);
    add_sheet(stage, kCeiling + part * kCeiling);
}

void set_back_of_mesh(Stage& stage, double part) {
    hang_mesh(stage);
    add_sheet(stage, kCeiling + part * kCeiling);
}

std::vector<double> sheets() { return {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}; }

}  // namespace

std::vector<Axis> light_axes() {
    return {
        {.name = "elevation", .unit = "rad", .meaning = "of a sharp sun above the floor",
         .values = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.785, 1.5707963267948966}, .quick = {1e-6, 1e-3, 0.1, 0.785, 1.5707963267948966}, .ordinary = 0.785, .apply = set_elevation},
        {.name = "sun_diameter", .unit = "deg", .meaning = "apparent size of a sun",
         .values = {0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.53, 10, 90, 180}, .quick = {0, 1e-6, 1e-3, 0.53, 180}, .ordinary = 0.53, .apply = set_sun_diameter},
        {.name = "sun_contrast", .unit = "", .meaning = "radiance of one pixel of an environment image over that of all others",
         .values = {1, 1e2, 1e4, 1e6}, .quick = {1, 1e2, 1e6}, .ordinary = 1e2, .apply = set_contrast},
        {.name = "range", .unit = "m", .meaning = "at which a lamp ends",
         .values = {1e-6, 1e-3, 1, 5, 10, 1e3, 1e6, 1e9}, .quick = {1e-6, 5, 1e3, 1e9}, .ordinary = 1e3, .apply = set_range},
        {.name = "spot_edge", .unit = "deg", .meaning = "from the inner to the outer half-angle of a spot",
         .values = {0, 1e-9, 1e-6, 1e-3, 1, 20}, .quick = {0, 1e-6, 1, 20}, .ordinary = 1, .apply = set_spot_edge},
        {.name = "area_side", .unit = "m", .meaning = "of a square lamp that hangs over the scene",
         .values = {1e-9, 1e-6, 1e-3, 1, 10, 1e3, 1e6}, .quick = {1e-9, 1, 1e6}, .ordinary = 1, .apply = set_area_side},
        {.name = "cover_point", .unit = "", .meaning = "from a lamp without size to a sheet before it, as a part of its height over the floor",
         .values = sheets(), .quick = {1e-6, 1e-1}, .ordinary = 1e-1, .safe_low = 1e-6, .apply = set_cover_of_point},
        {.name = "cover_ball", .unit = "", .meaning = "the same of a lamp with a radius",
         .values = sheets(), .quick = {1e-6, 1e-1}, .ordinary = 1e-1, .safe_low = 1e-6, .apply = set_cover_of_ball},
        {.name = "cover_panel", .unit = "", .meaning = "the same of a square lamp",
         .values = sheets(), .quick = {1e-6, 1e-1}, .ordinary = 1e-1, .safe_low = 1e-6, .apply = set_cover_of_panel},
        {.name = "cover_mesh", .unit = "", .meaning = "the same of two triangles that emit",
         .values = sheets(), .quick = {1e-5, 1e-1}, .ordinary = 1e-1, .safe_low = 1e-5, .apply = set_cover_of_mesh},
        {.name = "back_panel", .unit = "", .meaning = "from a square lamp to a sheet behind it, as a part of its height over the floor",
         .values = sheets(), .quick = {1e-7, 1e-1}, .ordinary = 1e-1, .apply = set_back_of_panel},
        {.name = "back_mesh", .unit = "", .meaning = "the same of two triangles that emit",
         .values = sheets(), .quick = {1e-7, 1e-1}, .ordinary = 1e-1, .apply = set_back_of_mesh},
        {.name = "intensity", .unit = "", .meaning = "factor on everything that shines; the exposure takes it back",
         .values = {1e-30, 1e-20, 1e-10, 1e-5, 1, 1e5, 1e10, 1e20, 1e30}, .quick = {1e-30, 1e-5, 1, 1e5, 1e30}, .ordinary = 1, .same_picture = true, .safe_low = 1e-20, .apply = set_intensity},
    };
}

}  // namespace kadr::stress
