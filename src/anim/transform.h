#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "anim/position.h"
#include "anim/track.h"

namespace kadr {

/// A rotation over time: quaternion keys, or a fixed axis with a keyed angle, which may turn any number of times.
struct RotationTrack {
    Track<glm::dquat> orientation{glm::dquat(1, 0, 0, 0)};
    struct AxisAngle {
        glm::dvec3 axis{0, 1, 0};   ///< unit length
        Track<double> angle_rad{0.0};
        bool operator==(const AxisAngle&) const = default;
    };
    std::optional<AxisAngle> axis_angle;  ///< wins over orientation where present
    bool operator==(const RotationTrack&) const = default;
    bool is_constant() const { return axis_angle ? axis_angle->angle_rad.is_constant() : orientation.is_constant(); }
};
glm::dquat evaluate(const RotationTrack& track, double time_s);
std::vector<double> discontinuities(const RotationTrack& track, double begin_s, double end_s);
std::vector<double> key_times(const RotationTrack& track, double begin_s, double end_s);
bool varies(const RotationTrack& track);
double turn_of(const RotationTrack& track, double begin_s, double end_s);

/// Translation, rotation, scale; parent_from_child = T * R * S. Where the translation turns along its path, R is that turn
/// after `rotate`.
struct TransformTrack {
    PositionTrack translate{glm::dvec3(0)};
    RotationTrack rotate;
    Track<glm::dvec3> scale{glm::dvec3(1)};
    bool operator==(const TransformTrack&) const = default;
    bool is_constant() const { return translate.is_constant() && rotate.is_constant() && scale.is_constant(); }
};
/// @throws InputError  where the path of the translation gives no direction to turn along
glm::dmat4 evaluate(const TransformTrack& track, double time_s);
std::vector<double> discontinuities(const TransformTrack& track, double begin_s, double end_s);
std::vector<double> key_times(const TransformTrack& track, double begin_s, double end_s);
bool varies(const TransformTrack& track);
double turn_of(const TransformTrack& track, double begin_s, double end_s);

/// R = Rz * Ry * Rx of degrees about fixed axes, x first.
glm::dquat rotation_from_degrees(glm::dvec3 degrees);

}  // namespace kadr
