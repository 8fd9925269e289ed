#pragma once

// What a track does between two keys: value and slope of each interpolation. Used by track.cpp and track_extremes.cpp alone.

#include <algorithm>
#include <numbers>
#include <utility>

#include "anim/rotation_math.h"
#include "anim/track.h"

namespace kadr::segments {

template <class T>
double seconds_between(const Track<T>& track, std::size_t from, std::size_t to) {
    return track.keys[to].time_s - track.keys[from].time_s;
}

/// Neighbours of a key; the key itself at either end, which makes a difference between them one-sided.
template <class T>
std::pair<std::size_t, std::size_t> neighbours(const Track<T>& track, std::size_t i) {
    return {i == 0 ? 0 : i - 1, std::min(i + 1, track.keys.size() - 1)};
}

template <class T>
T hermite(const T& a, const T& a_slope, const T& b, const T& b_slope, double u) {
    const double u2 = u * u, u3 = u2 * u;
    return a * (2 * u3 - 3 * u2 + 1) + a_slope * (u3 - 2 * u2 + u) + b * (3 * u2 - 2 * u3) + b_slope * (u3 - u2);
}

// ---- Numbers and vectors ----

inline double& component(double& value, int) { return value; }
template <class Vector>
double& component(Vector& value, int i) {
    return value[i];
}
template <class T>
constexpr int component_count() {
    if constexpr (std::is_same_v<T, double>)
        return 1;
    else
        return static_cast<int>(T::length());
}

/// Slope that a monotone cubic may have at a key between the secants on either side: none where they turn, else at most
/// three times the flatter one.  Source: Fritsch & Carlson 1980, "Monotone piecewise cubic interpolation", section 3: the
/// square [0, 3] x [0, 3] of the region of monotonicity, which needs no order of passes over the keys.
inline double limited(double slope, double secant_before, double secant_after) {
    if (!(secant_before * secant_after > 0)) return 0;
    const double most = 3 * std::min(std::abs(secant_before), std::abs(secant_after));
    return std::clamp(slope, -most, most);
}

template <class T>
T secant(const Track<T>& track, std::size_t i) {
    return (track.keys[i + 1].value - track.keys[i].value) / seconds_between(track, i, i + 1);
}

/// Tangent of `smooth` at a key, per second: non-uniform Catmull-Rom, one-sided at the ends.
template <class T>
T slope_at(const Track<T>& track, std::size_t i) {
    const auto [before, after] = neighbours(track, i);
    T slope = (track.keys[after].value - track.keys[before].value) / seconds_between(track, before, after);
    if (track.overshoot || before == i || after == i) return slope;
    T left = secant(track, before), right = secant(track, i);
    for (int c = 0; c < component_count<T>(); ++c)
        component(slope, c) = limited(component(slope, c), component(left, c), component(right, c));
    return slope;
}

// ---- Rotations ----

inline glm::dquat unit(const glm::dquat& q) { return glm::normalize(q); }

/// Half the rotation vector of the shorter arc of a segment, in its first key's own frame, and of its whole turns.
struct SegmentTurn {
    glm::dvec3 step{0}, extra{0};
};
inline SegmentTurn turn_of_segment(const Track<glm::dquat>& track, std::size_t i) {
    const glm::dquat from = unit(track.keys[i].value);
    SegmentTurn turn{step_between(from, unit(track.keys[i + 1].value)), glm::dvec3(0)};
    const std::optional<Spin>& spin = track.keys[i].spin;
    if (!spin) return turn;
    constexpr double kNoTurn = 1e-9;  // the arc is too short to have an axis of its own
    const glm::dvec3 stated = glm::conjugate(from) * spin->axis;
    const double length = glm::length(turn.step);
    const glm::dvec3 axis = length > kNoTurn ? turn.step / length : stated;
    // Against the stated axis the shorter arc runs the wrong way round: one turn less, and the others backwards.
    const bool against = glm::dot(axis, stated) < 0;
    turn.extra = axis * (std::numbers::pi * (against ? -1.0 - spin->turns : spin->turns));
    return turn;
}

/// Half the angular velocity of squad at a key, per second, in the key's own frame.
inline glm::dvec3 turn_rate_at(const Track<glm::dquat>& track, std::size_t i) {
    const auto [before, after] = neighbours(track, i);
    const glm::dquat here = unit(track.keys[i].value);
    const glm::dvec3 forward = step_between(here, unit(track.keys[after].value));
    const glm::dvec3 backward = step_between(here, unit(track.keys[before].value));
    return (forward - backward) / seconds_between(track, before, after);
}

/// Squad.  Source: Shoemake 1987, with inner points chosen for the wanted velocity at unevenly spaced keys: the
/// curve's derivative at its start is q0 * (log(q0^-1 q1) + 2 log(q0^-1 s0)).
inline glm::dquat squad_at(const Track<glm::dquat>& track, std::size_t i, double u) {
    const double seconds = seconds_between(track, i, i + 1);
    const glm::dquat from = unit(track.keys[i].value);
    const glm::dquat to = nearer(from, unit(track.keys[i + 1].value));
    const glm::dvec3 step = log_of(glm::conjugate(from) * to);
    const glm::dquat from_inner = from * exp_of(0.5 * (turn_rate_at(track, i) * seconds - step));
    const glm::dquat to_inner = to * exp_of(0.5 * (step - turn_rate_at(track, i + 1) * seconds));
    return unit(arc(arc(from, to, u), arc(from_inner, to_inner, u), 2 * u * (1 - u)));
}

/// Half the rotation vector of a segment's whole turns, in the frame that the rotation maps to.
inline glm::dvec3 whole_turns(const Track<glm::dquat>& track, std::size_t i) {
    if (!track.keys[i].spin) return glm::dvec3(0);
    return unit(track.keys[i].value) * turn_of_segment(track, i).extra;
}

/// Per second, how fast the whole turns of `smooth` run through a key: as Catmull-Rom where both sides spin, at the
/// segment's own speed at the track's ends, and not at all beside a segment without them.
inline glm::dvec3 whole_turn_rate_at(const Track<glm::dquat>& track, std::size_t i) {
    const auto [before, after] = neighbours(track, i);
    const glm::dvec3 left = before == i ? glm::dvec3(0) : whole_turns(track, before);
    const glm::dvec3 right = after == i ? glm::dvec3(0) : whole_turns(track, i);
    const bool stops = (before != i && left == glm::dvec3(0)) || (after != i && right == glm::dvec3(0));
    return stops ? glm::dvec3(0) : (left + right) / seconds_between(track, before, after);
}

/// Half the angle of the whole turns of a `smooth` segment that are done at u.
inline glm::dvec3 whole_turns_done(const Track<glm::dquat>& track, std::size_t i, double u) {
    const glm::dvec3 all = whole_turns(track, i);
    if (all == glm::dvec3(0)) return all;
    const glm::dvec3 axis = glm::normalize(all);
    const double seconds = seconds_between(track, i, i + 1);
    const auto rate = [&](std::size_t key) { return glm::dot(axis, whole_turn_rate_at(track, key)) * seconds; };
    return axis * hermite(0.0, rate(i), glm::length(all), rate(i + 1), u);
}

// ---- Values at u in (0, 1) between key i and key i + 1 ----

template <class T>
T linear_at(const Track<T>& track, std::size_t i, double u) {
    const T &a = track.keys[i].value, &b = track.keys[i + 1].value;
    if constexpr (kIsRotation<T>) {
        const T from = unit(a);
        if (!track.keys[i].spin) return arc(from, nearer(from, unit(b)), u);
        const SegmentTurn turn = turn_of_segment(track, i);
        return from * exp_of(u * (turn.step + turn.extra));
    } else {
        return a * (1 - u) + b * u;
    }
}

template <class T>
T smooth_at(const Track<T>& track, std::size_t i, double u) {
    if constexpr (kIsRotation<T>) {
        const T squad = squad_at(track, i, u);
        return track.keys[i].spin ? exp_of(whole_turns_done(track, i, u)) * squad : squad;
    } else {
        const double seconds = seconds_between(track, i, i + 1);
        return hermite<T>(track.keys[i].value, slope_at(track, i) * seconds, track.keys[i + 1].value,
                          slope_at(track, i + 1) * seconds, u);
    }
}

/// glTF 2.0, appendix C.5: tangents are per second, components of quaternions are interpolated one by one. A quaternion
/// key whose sign makes the way long is taken with the other sign, which is the same rotation: the shorter arc again.
template <class T>
T cubic_at(const Track<T>& track, std::size_t i, double u) {
    const double seconds = seconds_between(track, i, i + 1);
    const Key<T>&a = track.keys[i], &b = track.keys[i + 1];
    double sign = 1;
    if constexpr (kIsRotation<T>) sign = glm::dot(a.value, b.value) < 0 ? -1 : 1;
    return hermite<T>(a.value, a.out_tangent * seconds, b.value * sign, b.in_tangent * (sign * seconds), u);
}

/// Value of a segment that is not `step`; exactly the keys' values at 0 and 1.
template <class T>
T value_at(const Track<T>& track, std::size_t i, double u) {
    if (u <= 0) return track.keys[i].value;
    if (u >= 1) return track.keys[i + 1].value;
    const double y = track.keys[i].ease ? eased(*track.keys[i].ease, u) : u;
    if (track.interpolation == Interpolation::linear) return linear_at(track, i, y);
    return track.interpolation == Interpolation::smooth ? smooth_at(track, i, y) : cubic_at(track, i, y);
}

// ---- Slopes per second at the track's two ends; of rotations half the angular velocity in the key's own frame ----

template <class T>
T end_slope_before_easing(const Track<T>& track, bool after) {
    const std::size_t last = track.keys.size() - 1;
    if (track.interpolation == Interpolation::linear) return secant(track, after ? last - 1 : 0);
    if (track.interpolation == Interpolation::smooth) return slope_at(track, after ? last : 0);
    if (track.interpolation == Interpolation::cubic) return after ? track.keys[last].in_tangent : track.keys[0].out_tangent;
    return T{};
}

inline glm::dvec3 end_turn_rate_before_easing(const Track<glm::dquat>& track, bool after) {
    const std::size_t end = after ? track.keys.size() - 1 : 0, segment = after ? end - 1 : 0;
    const glm::dquat& value = track.keys[end].value;
    if (track.interpolation == Interpolation::linear) {
        const SegmentTurn turn = turn_of_segment(track, segment);  // its axis is the same in both keys' frames
        return (turn.step + turn.extra) / seconds_between(track, segment, segment + 1);
    }
    if (track.interpolation == Interpolation::smooth)
        return turn_rate_at(track, end) + glm::conjugate(unit(value)) * whole_turn_rate_at(track, end);
    if (track.interpolation != Interpolation::cubic) return glm::dvec3(0);
    // Of the normalised curve: what the tangent does beside changing the length.
    const glm::dquat rate = glm::conjugate(value) * (after ? track.keys[end].in_tangent : track.keys[end].out_tangent);
    return glm::dvec3(rate.x, rate.y, rate.z) / glm::dot(value, value);
}

template <class T>
double end_easing_slope(const Track<T>& track, bool after) {
    const std::optional<Ease>& ease = track.keys[after ? track.keys.size() - 2 : 0].ease;
    return ease ? slope_at_end(*ease, after) : 1;
}

template <class T>
T continued(const Track<T>& track, double beyond_s) {
    const bool after = beyond_s > 0;
    const T& end = after ? track.keys.back().value : track.keys.front().value;
    const double by = beyond_s * end_easing_slope(track, after);
    if constexpr (kIsRotation<T>)
        return unit(end) * exp_of(end_turn_rate_before_easing(track, after) * by);
    else
        return end + end_slope_before_easing(track, after) * by;
}

}  // namespace kadr::segments
