#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "anim/path.h"
#include "anim/track.h"
#include "base/error.h"

namespace kadr {

/// A journey along a path.
struct PathMotion {
    Path path;
    Track<double> at{0.0};       ///< fraction of the path's length
    bool along = false;          ///< what travels is turned along the path ...
    glm::dvec3 up{0, 1, 0};      ///< ... with this direction upwards (scenes; a camera has its own)
    SourceLocation where;
    bool operator==(const PathMotion&) const = default;
};

/// A circle about a point's vertical: around + radius * (sin a, 0, cos a) + (0, height, 0); it begins towards +z and
/// turns counterclockwise seen from above.
struct OrbitMotion {
    Track<glm::dvec3> around{glm::dvec3(0)};
    Track<double> radius_m{1.0}, height_m{0.0}, turns{0.0};
    double start_rad = 0;
    bool operator==(const OrbitMotion&) const = default;
};

/// A position over time: keys, or a journey along a path, or an orbit.
struct PositionTrack {
    Track<glm::dvec3> keyed{glm::dvec3(0)};
    std::optional<PathMotion> path;    ///< wins over keyed where present
    std::optional<OrbitMotion> orbit;  ///< wins over keyed where present

    PositionTrack() = default;
    /*implicit*/ PositionTrack(glm::dvec3 constant) : keyed(constant) {}
    /*implicit*/ PositionTrack(Track<glm::dvec3> track) : keyed(std::move(track)) {}
    bool operator==(const PositionTrack&) const = default;
    bool is_constant() const { return !path && !orbit && keyed.is_constant(); }
    bool turns_along() const { return path && path->along; }
};
glm::dvec3 evaluate(const PositionTrack& track, double time_s);
/// Direction of the path at a time (unit; zero where it has none). @pre track.path
glm::dvec3 tangent(const PositionTrack& track, double time_s);
std::vector<double> discontinuities(const PositionTrack& track, double begin_s, double end_s);
/// Keys, and evenly spaced times as dense as the motion bends: what a grid of samples must not pass over.
std::vector<double> key_times(const PositionTrack& track, double begin_s, double end_s);
bool varies(const PositionTrack& track);

/// Of what travels a path with orient: along: its +z (a glTF asset's front) along the path, +y upwards.
/// @throws InputError  where the path has no direction or runs along `up`
glm::dquat rotation_along(const PathMotion& motion, double time_s);

/// Both lists in ascending order.
std::vector<double> merged(std::vector<double> a, const std::vector<double>& b);
/// The inner ends of `parts` (rounded up) equal parts of an interval, at most kMostListedTimes.
std::vector<double> even_times(double begin_s, double end_s, double parts);

}  // namespace kadr
