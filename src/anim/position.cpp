#include "anim/position.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/text.h"

namespace kadr {

namespace {

glm::dvec3 on_orbit(const OrbitMotion& orbit, double time_s) {
    const double angle = orbit.start_rad + 2 * std::numbers::pi * evaluate(orbit.turns, time_s), radius = evaluate(orbit.radius_m, time_s);
    return evaluate(orbit.around, time_s) + glm::dvec3(radius * std::sin(angle), evaluate(orbit.height_m, time_s), radius * std::cos(angle));
}

/// Applies `visit(track)` to every track that a position depends on.
template <class Visit>
void visit_tracks(const PositionTrack& track, Visit visit) {
    if (track.path) return visit(track.path->at);
    if (!track.orbit) return visit(track.keyed);
    visit(track.orbit->around);
    visit(track.orbit->radius_m);
    visit(track.orbit->height_m);
    visit(track.orbit->turns);
}

/// How many straight parts show what the motion is like.
double bends(const PositionTrack& track, double begin_s, double end_s) {
    constexpr double kPartsOfASegment = 2, kPartsOfATurn = 16;
    if (track.path) return kPartsOfASegment * static_cast<double>(track.path->path.segment_count()) * travel_of(track.path->at, begin_s, end_s);
    return track.orbit ? kPartsOfATurn * travel_of(track.orbit->turns, begin_s, end_s) : 1;
}

[[noreturn]] void refuse(const PathMotion& motion, std::string found, std::string expected) {
    throw InputError(Diagnostic{motion.where, std::move(found), {}, 1, std::move(expected)});
}

}  // namespace

glm::dvec3 evaluate(const PositionTrack& track, double time_s) {
    if (track.path) return track.path->path.position(evaluate(track.path->at, time_s));
    return track.orbit ? on_orbit(*track.orbit, time_s) : evaluate(track.keyed, time_s);
}

glm::dvec3 tangent(const PositionTrack& track, double time_s) { return track.path->path.tangent(evaluate(track.path->at, time_s)); }

std::vector<double> discontinuities(const PositionTrack& track, double begin_s, double end_s) {
    std::vector<double> times;
    visit_tracks(track, [&](const auto& part) { times = merged(std::move(times), discontinuities(part, begin_s, end_s)); });
    return times;
}

std::vector<double> key_times(const PositionTrack& track, double begin_s, double end_s) {
    std::vector<double> times;
    visit_tracks(track, [&](const auto& part) { times = merged(std::move(times), key_times(part, begin_s, end_s)); });
    return merged(std::move(times), even_times(begin_s, end_s, bends(track, begin_s, end_s)));
}

bool varies(const PositionTrack& track) {
    bool any = false;
    visit_tracks(track, [&any](const auto& part) { any = any || varies(part); });
    return any;
}

glm::dquat rotation_along(const PathMotion& motion, double time_s) {
    constexpr double kParallel = 1e-9;
    const glm::dvec3 front = motion.path.tangent(evaluate(motion.at, time_s));
    if (front == glm::dvec3(0))
        refuse(motion, fmt::format("the path turns back on itself at {} s and has no direction there", format_number(time_s)),
               "expected a point beside it that makes the turn a curve, or no orient: along");
    const glm::dvec3 right = glm::cross(motion.up, front);
    const double length = glm::length(right);
    if (!(length > kParallel * glm::length(motion.up)))
        refuse(motion, fmt::format("the path runs along its up direction at {} s", format_number(time_s)), "expected another up: [x, y, z] beside orient: along");
    const glm::dvec3 x = right / length;
    return glm::normalize(glm::quat_cast(glm::dmat3(x, glm::cross(front, x), front)));
}

std::vector<double> merged(std::vector<double> a, const std::vector<double>& b) {
    if (b.empty()) return a;
    const auto middle = a.insert(a.end(), b.begin(), b.end());
    std::inplace_merge(a.begin(), middle, a.end());
    return a;
}

std::vector<double> even_times(double begin_s, double end_s, double parts) {
    std::vector<double> times;
    const double count = std::min(std::ceil(parts - 1e-9), static_cast<double>(kMostListedTimes) + 1);
    for (double i = 1; i < count; ++i) times.push_back(begin_s + (end_s - begin_s) * (i / count));
    return times;
}

}  // namespace kadr
