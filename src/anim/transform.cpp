#include "anim/transform.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace kadr {

namespace {

/// Radians that what travels a path turns with it: chords of the turn, so short that they are as long as it is.
double turn_along(const PathMotion& motion, double begin_s, double end_s) {
    constexpr double kPartsOfASegment = 8;
    const double parts = kPartsOfASegment * static_cast<double>(motion.path.segment_count()) * travel_of(motion.at, begin_s, end_s);
    double turn = 0;
    glm::dquat before = rotation_along(motion, begin_s);
    const auto add = [&](double time) {
        const glm::dquat here = rotation_along(motion, time), difference = glm::conjugate(before) * here;
        turn += 2 * std::atan2(glm::length(glm::dvec3(difference.x, difference.y, difference.z)), std::abs(difference.w));
        before = here;
    };
    for (const double time : even_times(begin_s, end_s, std::max(parts, 4.0))) add(time);
    add(end_s);
    return turn;
}

}  // namespace

glm::dquat evaluate(const RotationTrack& track, double time_s) {
    if (!track.axis_angle) return evaluate(track.orientation, time_s);
    return glm::angleAxis(evaluate(track.axis_angle->angle_rad, time_s), track.axis_angle->axis);
}

std::vector<double> discontinuities(const RotationTrack& track, double begin_s, double end_s) {
    return track.axis_angle ? discontinuities(track.axis_angle->angle_rad, begin_s, end_s) : discontinuities(track.orientation, begin_s, end_s);
}

std::vector<double> key_times(const RotationTrack& track, double begin_s, double end_s) {
    return track.axis_angle ? key_times(track.axis_angle->angle_rad, begin_s, end_s) : key_times(track.orientation, begin_s, end_s);
}

bool varies(const RotationTrack& track) { return track.axis_angle ? varies(track.axis_angle->angle_rad) : varies(track.orientation); }

double turn_of(const RotationTrack& track, double begin_s, double end_s) {
    return track.axis_angle ? travel_of(track.axis_angle->angle_rad, begin_s, end_s) : turn_of(track.orientation, begin_s, end_s);
}

glm::dmat4 evaluate(const TransformTrack& track, double time_s) {
    glm::dquat turn = evaluate(track.rotate, time_s);
    if (track.translate.turns_along()) turn = rotation_along(*track.translate.path, time_s) * turn;
    const glm::dmat3 rotation = glm::mat3_cast(turn);
    const glm::dvec3 scale = evaluate(track.scale, time_s);
    return {glm::dvec4(rotation[0] * scale.x, 0), glm::dvec4(rotation[1] * scale.y, 0),
            glm::dvec4(rotation[2] * scale.z, 0), glm::dvec4(evaluate(track.translate, time_s), 1)};
}

std::vector<double> discontinuities(const TransformTrack& track, double begin_s, double end_s) {
    return merged(merged(discontinuities(track.translate, begin_s, end_s), discontinuities(track.rotate, begin_s, end_s)),
                  discontinuities(track.scale, begin_s, end_s));
}

std::vector<double> key_times(const TransformTrack& track, double begin_s, double end_s) {
    return merged(merged(key_times(track.translate, begin_s, end_s), key_times(track.rotate, begin_s, end_s)),
                  key_times(track.scale, begin_s, end_s));
}

bool varies(const TransformTrack& track) { return varies(track.translate) || varies(track.rotate) || varies(track.scale); }

double turn_of(const TransformTrack& track, double begin_s, double end_s) {
    const double own = turn_of(track.rotate, begin_s, end_s);
    return track.translate.turns_along() ? own + turn_along(*track.translate.path, begin_s, end_s) : own;
}

glm::dquat rotation_from_degrees(glm::dvec3 degrees) {
    const glm::dvec3 radians = glm::radians(degrees);
    return glm::angleAxis(radians.z, glm::dvec3(0, 0, 1)) * glm::angleAxis(radians.y, glm::dvec3(0, 1, 0)) *
           glm::angleAxis(radians.x, glm::dvec3(1, 0, 0));
}

}  // namespace kadr
