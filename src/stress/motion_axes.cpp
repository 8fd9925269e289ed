#include <cmath>

#include <glm/trigonometric.hpp>

#include "stress/axis_groups.h"
#include "stress/stage.h"

namespace kadr::stress {

namespace {

constexpr double kShutter_s = 1 / 48.0;
constexpr double kTurn_deg = 20;  // in a shutter, of what moves in an ordinary way

/// The block becomes a bar in front of the ball, whose turns about +z show.
Object& bar(Stage& stage) {
    Object& block = stage.object("Block");
    block.translate = {0.8, 1.2, 1.5};
    block.scale = {1, 0.12, 0.12};
    return block;
}

/// The bar turns by some degrees from one time to another. @pre the shutter is open then
void turn_bar(Stage& stage, double from_s, double to_s, double degrees) { bar(stage).motion.angle = {{from_s, {0}}, {to_s, {degrees}}}; }

void set_spin(Stage& stage, double degrees_per_s) {
    stage.shutter_s = kShutter_s;
    turn_bar(stage, 0, 1, degrees_per_s);
}

void set_travel(Stage& stage, double metres) {
    stage.shutter_s = kShutter_s;
    Object& ball = stage.object("Ball");
    const double y = ball.translate.y, half = 0.5 * metres;
    ball.motion.translate = {{0, {-half, y, 0}}, {kShutter_s, {half, y, 0}}};
}

std::vector<double> turned_about_z(double degrees) {
    const double half = 0.5 * glm::radians(degrees);
    return {0, 0, std::sin(half), std::cos(half)};
}

void set_turn(Stage& stage, double degrees) {
    stage.shutter_s = kShutter_s;
    bar(stage).motion.rotate = {{0, turned_about_z(0)}, {kShutter_s, turned_about_z(degrees)}};
}

void set_clip_turn(Stage& stage, double degrees) {
    set_turn(stage, degrees);
    bar(stage).motion.in_clip = true;
}

/// The ball while the shutter is open: from its own size to a part of it.
Motion& shrink(Stage& stage, const glm::dvec3& to) {
    stage.shutter_s = kShutter_s;
    Motion& motion = stage.object("Ball").motion;
    motion.scale = {{0, {1, 1, 1}}, {kShutter_s, {to.x, to.y, to.z}}};
    return motion;
}

void set_shrink(Stage& stage, double part) { shrink(stage, glm::dvec3(part)); }
void set_clip_shrink(Stage& stage, double part) { shrink(stage, glm::dvec3(part)).in_clip = true; }
void set_clip_mirror(Stage& stage, double part) { shrink(stage, {part, 1, 1}).in_clip = true; }

/// One frame a second, so that its number stays one that the format takes.
void set_time(Stage& stage, double seconds) {
    stage.fps = "1";
    stage.frame = static_cast<int>(seconds);
    stage.shutter_s = kShutter_s;
    turn_bar(stage, seconds, seconds + kShutter_s, kTurn_deg);
}

void set_fps(Stage& stage, double fps) {
    stage.fps = fps >= 1 ? std::to_string(std::lround(fps)) : "1/" + std::to_string(std::lround(1 / fps));
    stage.shutter_s = 0.5 / fps;
    turn_bar(stage, 0, stage.shutter_s, kTurn_deg);
}

void set_shutter(Stage& stage, double seconds) {
    stage.shutter_s = seconds;
    turn_bar(stage, 0, seconds, kTurn_deg);
}

/// Studs on the floor, in rows that fill it.
void set_copies(Stage& stage, double count) {
    Object stud;
    stud.name = "Stud";
    stud.mesh = cone(6);
    stud.material.base_color = {0.6, 0.35, 0.2};
    const int rows = std::max(1, static_cast<int>(std::ceil(std::sqrt(count))));
    const double spacing = 6.0 / rows;
    stud.scale = glm::dvec3(0.3 * spacing);
    stud.copies.emplace();
    for (int i = 0; i < static_cast<int>(count); ++i) {
        const glm::dvec3 place((i % rows + 0.5) * spacing - 3, 0, (i / rows + 0.5) * spacing - 3);
        stud.copies->push_back(place / stud.scale);
    }
    stage.remove("Block");
    stage.objects.push_back(std::move(stud));
}

void set_pixels(Stage& stage, double side) {
    stage.width = stage.height = static_cast<int>(side);
    if (side > 4096) stage.samples = 1;  // no reference to compare with, and the film of one sample takes half
}

constexpr std::string_view kHalfTurn = "180 deg apart", kTurnsOver = "passes through zero", kZero = "scale is zero", kInsideOut = "turns inside out", kFps = "timing.fps is";

}  // namespace

std::vector<Axis> motion_axes() {
    return {
        {.name = "spin", .unit = "deg/s", .meaning = "of a bar, with a shutter of 1/48 s",
         .values = {0, 10, 360, 1e3, 1e4, 1e5, 1e6}, .quick = {0, 1e3, 1e6}, .ordinary = 0, .apply = set_spin},
        {.name = "travel", .unit = "m", .meaning = "of the ball while the shutter is open",
         .values = {0, 1e-9, 1e-3, 1, 10, 1e3, 1e6}, .quick = {0, 1, 1e6}, .ordinary = 0, .apply = set_travel},
        {.name = "turn", .unit = "deg", .meaning = "between two quaternion keys of the shot; 360: antipodal ones, the same rotation",
         .values = {0, 1e-6, 90, 179, 179.999999, 180, 360}, .quick = {0, 90, 179, 180, 360}, .ordinary = 0, .refusals = {{180, kHalfTurn}}, .apply = set_turn},
        {.name = "clip_turn", .unit = "deg", .meaning = "the same between two keys of a clip of the glTF file",
         .values = {0, 1e-6, 90, 179, 179.999999, 180, 360}, .quick = {0, 90, 179, 180, 360}, .ordinary = 0, .apply = set_clip_turn},
        {.name = "shrink", .unit = "", .meaning = "size of the ball when the shutter closes, of 1 when it opens; keys of the shot",
         .values = {-1, 0, 1e-9, 1e-3, 0.5, 1}, .quick = {-1, 0, 1e-3, 1}, .ordinary = 1, .refusals = {{-1, kTurnsOver}, {0, kZero}}, .apply = set_shrink},
        {.name = "clip_shrink", .unit = "", .meaning = "the same by a clip of the glTF file, which may pass through nothing",
         .values = {-1, 0, 1e-9, 1e-3, 0.5, 1}, .quick = {-1, 0, 1e-3, 1}, .ordinary = 1, .refusals = {{-1, kInsideOut}}, .apply = set_clip_shrink},
        {.name = "clip_mirror", .unit = "", .meaning = "width of the ball when the shutter closes, by a clip; negative: mirrored",
         .values = {-1, -1e-6, 0, 1e-6, 1e-3, 0.5, 1}, .quick = {-1, 0, 0.5, 1}, .ordinary = 1, .refusals = {{-1, kInsideOut}, {-1e-6, kInsideOut}}, .apply = set_clip_mirror},
        {.name = "time", .unit = "s", .meaning = "of the frame; what moves does so while its shutter is open",
         .values = {0, 1e3, 1e5, 1e6, 1e7}, .quick = {0, 1e3, 1e7}, .ordinary = 0, .same_picture = true, .apply = set_time},
        {.name = "fps", .unit = "1/s", .meaning = "frame rate, with the shutter open for half a frame",
         .values = {1e-3, 1, 24, 1e3, 1e4, 1e5}, .quick = {1e-3, 24, 1e4, 1e5}, .ordinary = 24, .same_picture = true, .refusals = {{1e5, kFps}}, .apply = set_fps},
        {.name = "shutter", .unit = "s", .meaning = "open time, in which a bar turns by 20 degrees",
         .values = {1e-9, 1e-6, 1e-3, 0.02, 1}, .quick = {1e-9, 0.02, 1}, .ordinary = 0.02, .same_picture = true, .apply = set_shutter},
        {.name = "copies", .unit = "", .meaning = "of a stud on the floor, by instancing",
         .values = {0, 1, 1e2, 1e4, 1e5}, .quick = {0, 1, 1e2, 1e4}, .ordinary = 1e2, .apply = set_copies},
        {.name = "pixels", .unit = "px", .meaning = "width and height of the picture",
         .values = {1, 2, 16, 64, 512, 4096, 16384}, .quick = {1, 2, 64}, .ordinary = 64, .apply = set_pixels},
    };
}

}  // namespace kadr::stress
