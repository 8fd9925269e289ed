#include "anim/track.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <type_traits>

#include <glm/gtc/matrix_transform.hpp>

namespace kadr {

namespace {

template <class T>
constexpr bool kIsRotation = std::is_same_v<T, glm::dquat>;

// ---- Easing (CSS Easing Functions Level 1) ----

double bezier(double p1, double p2, double u) {
    const double v = 1 - u;
    return ((3 * v * p1) * v + 3 * u * v * p2 + u * u) * u;
}

double bezier_slope(double p1, double p2, double u) {
    const double v = 1 - u;
    return 3 * v * v * p1 + 6 * u * v * (p2 - p1) + 3 * u * u * (1 - p2);
}

/// The curve's parameter where its x is given: Newton where the slope allows, inside a bracket that bisection shrinks.
double parameter_at(const Ease& ease, double x) {
    double low = 0, high = 1, u = x;
    for (int step = 0; step < 64; ++step) {
        const double error = bezier(ease[0], ease[2], u) - x;
        if (std::abs(error) < 1e-15) break;
        (error > 0 ? high : low) = u;
        const double slope = bezier_slope(ease[0], ease[2], u);
        const double newton = slope > 1e-9 ? u - error / slope : low - 1;
        u = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return u;
}

double eased(const std::optional<Ease>& ease, double u) {
    if (!ease || u <= 0 || u >= 1) return u;
    return bezier((*ease)[1], (*ease)[3], parameter_at(*ease, u));
}

// ---- Rotations ----

/// Slerp without a change of sign; the angle by atan2, which stays exact for tiny and for wide arcs.
glm::dquat arc(const glm::dquat& a, const glm::dquat& b, double u) {
    const glm::dquat difference = a - b, sum = a + b;
    const double angle = 2 * std::atan2(glm::length(difference), glm::length(sum));
    const double sine = std::sin(angle);
    if (angle < 1e-9 || sine < 1e-12) return glm::normalize(a * (1 - u) + b * u);
    return a * (std::sin((1 - u) * angle) / sine) + b * (std::sin(u * angle) / sine);
}

/// Of b and -b, which are one rotation, the one nearer to a.
glm::dquat nearer(const glm::dquat& a, const glm::dquat& b) { return glm::dot(a, b) < 0 ? -b : b; }

/// Half the rotation vector of a unit quaternion.
glm::dvec3 log_of(const glm::dquat& q) {
    const glm::dvec3 v(q.x, q.y, q.z);
    const double sine = glm::length(v);
    return sine < 1e-15 ? v : v * (std::atan2(sine, q.w) / sine);
}

glm::dquat exp_of(const glm::dvec3& half) {
    const double angle = glm::length(half);
    const glm::dvec3 v = half * (angle < 1e-15 ? 1.0 : std::sin(angle) / angle);
    return {std::cos(angle), v.x, v.y, v.z};
}

/// log(from^-1 * to) by the shorter arc.
glm::dvec3 step_between(const glm::dquat& from, const glm::dquat& to) {
    return log_of(glm::conjugate(from) * nearer(from, to));
}

glm::dquat unit(const glm::dquat& q) { return glm::normalize(q); }

// ---- Segments: value at u in [0, 1] between key i and key i + 1 ----

template <class T>
double seconds_between(const Track<T>& track, std::size_t from, std::size_t to) {
    return track.keys[to].time_s - track.keys[from].time_s;
}

template <class T>
T linear_at(const Track<T>& track, std::size_t i, double u) {
    const T &a = track.keys[i].value, &b = track.keys[i + 1].value;
    if constexpr (kIsRotation<T>) {
        const T from = unit(a);
        return arc(from, nearer(from, unit(b)), u);
    } else {
        return a * (1 - u) + b * u;
    }
}

template <class T>
T hermite(const T& a, const T& a_slope, const T& b, const T& b_slope, double u) {
    const double u2 = u * u, u3 = u2 * u;
    return a * (2 * u3 - 3 * u2 + 1) + a_slope * (u3 - 2 * u2 + u) + b * (3 * u2 - 2 * u3) + b_slope * (u3 - u2);
}

/// Neighbours of a key; the key itself at either end, which makes the difference one-sided.
template <class T>
std::pair<std::size_t, std::size_t> neighbours(const Track<T>& track, std::size_t i) {
    return {i == 0 ? 0 : i - 1, std::min(i + 1, track.keys.size() - 1)};
}

template <class T>
T slope_at(const Track<T>& track, std::size_t i) {
    const auto [before, after] = neighbours(track, i);
    return (track.keys[after].value - track.keys[before].value) / seconds_between(track, before, after);
}

/// Half the angular velocity at a key, per second, in the key's own frame.
glm::dvec3 turn_rate_at(const Track<glm::dquat>& track, std::size_t i) {
    const auto [before, after] = neighbours(track, i);
    const glm::dquat here = unit(track.keys[i].value);
    const glm::dvec3 forward = step_between(here, unit(track.keys[after].value));
    const glm::dvec3 backward = step_between(here, unit(track.keys[before].value));
    return (forward - backward) / seconds_between(track, before, after);
}

/// Squad.  Source: Shoemake 1987, with inner points chosen for the wanted velocity at unevenly spaced keys: the
/// curve's derivative at its start is q0 * (log(q0^-1 q1) + 2 log(q0^-1 s0)).
glm::dquat squad_at(const Track<glm::dquat>& track, std::size_t i, double u) {
    const double seconds = seconds_between(track, i, i + 1);
    const glm::dquat from = unit(track.keys[i].value);
    const glm::dquat to = nearer(from, unit(track.keys[i + 1].value));
    const glm::dvec3 step = log_of(glm::conjugate(from) * to);
    const glm::dquat from_inner = from * exp_of(0.5 * (turn_rate_at(track, i) * seconds - step));
    const glm::dquat to_inner = to * exp_of(0.5 * (step - turn_rate_at(track, i + 1) * seconds));
    return unit(arc(arc(from, to, u), arc(from_inner, to_inner, u), 2 * u * (1 - u)));
}

template <class T>
T smooth_at(const Track<T>& track, std::size_t i, double u) {
    if constexpr (kIsRotation<T>) {
        return squad_at(track, i, u);
    } else {
        const double seconds = seconds_between(track, i, i + 1);
        return hermite<T>(track.keys[i].value, slope_at(track, i) * seconds, track.keys[i + 1].value,
                          slope_at(track, i + 1) * seconds, u);
    }
}

/// glTF 2.0, appendix C.5: tangents are per second, components of quaternions are interpolated one by one.
template <class T>
T cubic_at(const Track<T>& track, std::size_t i, double u) {
    const double seconds = seconds_between(track, i, i + 1);
    const Key<T>&a = track.keys[i], &b = track.keys[i + 1];
    return hermite<T>(a.value, a.out_tangent * seconds, b.value, b.in_tangent * seconds, u);
}

template <class T>
T step_at(const Track<T>& track, std::size_t i, double) {
    return track.keys[i].value;
}

template <class T>
T finished(const T& value) {
    if constexpr (kIsRotation<T>) return unit(value);
    return value;
}

}  // namespace

template <class T>
T evaluate(const Track<T>& track, double time_s) {
    assert(!track.keys.empty());
    const auto& keys = track.keys;
    if (keys.size() == 1 || !(time_s > keys.front().time_s)) return finished(keys.front().value);
    if (time_s >= keys.back().time_s) return finished(keys.back().value);
    const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                        [](double time, const Key<T>& key) { return time < key.time_s; });
    const auto i = static_cast<std::size_t>(after - keys.begin()) - 1;
    const double u = eased(keys[i].ease, (time_s - keys[i].time_s) / seconds_between(track, i, i + 1));
    using Segment = T (*)(const Track<T>&, std::size_t, double);
    constexpr Segment kSegments[] = {step_at<T>, linear_at<T>, smooth_at<T>, cubic_at<T>};
    return finished(kSegments[static_cast<int>(track.interpolation)](track, i, u));
}

template <class T>
std::vector<double> discontinuities(const Track<T>& track, double begin_s, double end_s) {
    std::vector<double> times;
    if (track.interpolation != Interpolation::step) return times;
    for (std::size_t i = 1; i < track.keys.size(); ++i) {
        const double time = track.keys[i].time_s;
        if (time > begin_s && time < end_s && track.keys[i].value != track.keys[i - 1].value) times.push_back(time);
    }
    return times;
}

template <class T>
std::vector<double> key_times(const Track<T>& track, double begin_s, double end_s) {
    std::vector<double> times;
    if (track.is_constant()) return times;
    const auto first = std::upper_bound(track.keys.begin(), track.keys.end(), begin_s,
                                        [](double time, const Key<T>& key) { return time < key.time_s; });
    for (auto key = first; key != track.keys.end() && key->time_s < end_s; ++key) times.push_back(key->time_s);
    return times;
}

#define KADR_TRACK_OF(T)                                                     \
    template T evaluate(const Track<T>&, double);                           \
    template std::vector<double> discontinuities(const Track<T>&, double, double); \
    template std::vector<double> key_times(const Track<T>&, double, double);
KADR_TRACK_OF(double)
KADR_TRACK_OF(glm::dvec2)
KADR_TRACK_OF(glm::dvec3)
KADR_TRACK_OF(glm::dquat)
#undef KADR_TRACK_OF

glm::dquat evaluate(const RotationTrack& track, double time_s) {
    if (!track.axis_angle) return evaluate(track.orientation, time_s);
    return glm::angleAxis(evaluate(track.axis_angle->angle_rad, time_s), track.axis_angle->axis);
}

bool TransformTrack::is_constant() const {
    const bool rotation_is_constant = rotate.axis_angle ? rotate.axis_angle->angle_rad.is_constant() : rotate.orientation.is_constant();
    return translate.is_constant() && rotation_is_constant && scale.is_constant();
}

glm::dmat4 evaluate(const TransformTrack& track, double time_s) {
    const glm::dmat3 rotation = glm::mat3_cast(evaluate(track.rotate, time_s));
    const glm::dvec3 scale = evaluate(track.scale, time_s);
    return {glm::dvec4(rotation[0] * scale.x, 0), glm::dvec4(rotation[1] * scale.y, 0),
            glm::dvec4(rotation[2] * scale.z, 0), glm::dvec4(evaluate(track.translate, time_s), 1)};
}

glm::dquat rotation_from_degrees(glm::dvec3 degrees) {
    const glm::dvec3 radians = glm::radians(degrees);
    return glm::angleAxis(radians.z, glm::dvec3(0, 0, 1)) * glm::angleAxis(radians.y, glm::dvec3(0, 1, 0)) *
           glm::angleAxis(radians.x, glm::dvec3(1, 0, 0));
}

}  // namespace kadr
