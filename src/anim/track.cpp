#include "anim/track.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "anim/segments.h"
#include "anim/tick.h"
#include "base/error.h"
#include "base/text.h"

namespace kadr {

namespace {

template <class T>
KeyedSpan span_of(const Track<T>& track) {
    return {track.keys.front().time_s, track.keys.back().time_s, track.before, track.after};
}

/// The segment that a time of the keyed span falls in; at a key the one that follows in the direction of travel.
template <class T>
std::size_t segment_at(const Track<T>& track, double time_s, bool mirrored) {
    const auto& keys = track.keys;
    const auto after = mirrored ? std::lower_bound(keys.begin(), keys.end(), time_s, [](const Key<T>& key, double time) { return key.time_s < time; })
                                : std::upper_bound(keys.begin(), keys.end(), time_s, [](double time, const Key<T>& key) { return time < key.time_s; });
    const auto next = static_cast<std::size_t>(after - keys.begin());
    return std::clamp<std::size_t>(next, 1, keys.size() - 1) - 1;
}

template <class T>
double part_of_segment(const Track<T>& track, std::size_t i, double time_s) {
    return (time_s - track.keys[i].time_s) / segments::seconds_between(track, i, i + 1);
}

template <class T>
bool loops(const Track<T>& track) {
    const auto again = [](Extrapolation mode) { return mode == Extrapolation::repeat || mode == Extrapolation::pingpong; };
    return again(track.before) || again(track.after);
}

/// Where a track loops, times within a segment are told apart by ticks, so that one which was folded back from a later pass
/// gives the very value of the first, and a key is met where it is.
template <class T>
double part_by_ticks(const Track<T>& track, std::size_t i, double time_s) {
    constexpr double kShort = 0x1p-20;  // seconds: between nearer keys a tick might be seen
    const double seconds = segments::seconds_between(track, i, i + 1), into = time_s - track.keys[i].time_s;
    if (seconds < kShort) return into / seconds;
    return std::abs(into - seconds) < kTick ? 1 : std::nearbyint(into / kTick) * kTick / seconds;
}

template <class T>
T finished(const T& value) {
    if constexpr (kIsRotation<T>) return segments::unit(value);
    return value;
}

/// Whether two keys hold different values; q and -q are one rotation, and 360 degrees is 0 but for rounding.
template <class T>
bool differ(const Key<T>& a, const Key<T>& b) {
    if constexpr (kIsRotation<T>) {
        constexpr double kRounding = 1e-12;
        return std::min(glm::length(a.value - b.value), glm::length(a.value + b.value)) > kRounding;
    } else {
        return a.value != b.value;
    }
}

bool is_inside(double time, double begin_s, double end_s) { return time > begin_s && time < end_s; }

/// Calls visit(pass) for the passes that meet an interval, at most one more than can be listed.
template <class Visit>
void visit_passes(const KeyedSpan& span, double begin_s, double end_s, Visit visit) {
    const SpanPasses passes = passes_within(span, begin_s, end_s);
    const double count = std::min(passes.count, static_cast<double>(kMostListedTimes) + 2);
    for (double i = 0; i < count; ++i) visit(pass_at(span, passes.first + i));
}

/// Calls visit(j) for the keys of a pass inside an interval, in the order of the shot's time.
template <class T, class Visit>
void visit_keys(const Track<T>& track, const SpanPass& pass, double begin_s, double end_s, Visit visit) {
    const double a = pass.to_local(begin_s), b = pass.to_local(end_s);
    // A key more on either side: the interval's ends are rounded.
    const double margin = loops(track) ? kTick : 0;  // nor does one at an end come in by the rounding of its pass
    const std::size_t low = segment_at(track, std::min(a, b), true), high = segment_at(track, std::max(a, b), false) + 1;
    for (std::size_t n = 0; n <= high - low; ++n) {
        const std::size_t j = pass.mirrored ? high - n : low + n;
        if (is_inside(pass.to_shot(track.keys[j].time_s), begin_s + margin, end_s - margin)) visit(j);
    }
}

template <class T>
bool jumps_at(const Track<T>& track, std::size_t j) {
    return track.interpolation == Interpolation::step && j > 0 && differ(track.keys[j - 1], track.keys[j]);
}

/// Whether the value jumps from the end of the keyed span to its start.
template <class T>
bool jumps_at_seam(const Track<T>& track) {
    const std::size_t shown_last = track.keys.size() - (track.interpolation == Interpolation::step ? 2 : 1);
    return differ(track.keys[shown_last], track.keys.front());
}

/// Whether the value jumps where pass number - 1 ends and pass `number` begins.
template <class T>
bool jumps_between_passes(const Track<T>& track, double number) {
    const Extrapolation mode = number > 0 ? track.after : track.before;
    if (mode == Extrapolation::repeat) return jumps_at_seam(track);
    return number == 1 && mode != Extrapolation::pingpong && jumps_at(track, track.keys.size() - 1);
}

template <class T>
bool ever_jumps(const Track<T>& track) {
    if (track.is_constant()) return false;
    const bool repeats = track.before == Extrapolation::repeat || track.after == Extrapolation::repeat;
    return track.interpolation == Interpolation::step || (repeats && jumps_at_seam(track));
}

[[noreturn]] void refuse_jumps(double begin_s, double end_s) {
    throw InputError(fmt::format("a track jumps more than {} times from {} s to {} s", kMostListedTimes, format_number(begin_s), format_number(end_s)),
                     "expected fewer step keys and repeats in that time");
}

// ---- How far a value travels: there and back added up, jumps left out ----

double distance(const Track<double>& track, std::size_t i, double from_u, double to_u) {
    return std::abs(segments::value_at(track, i, to_u) - segments::value_at(track, i, from_u));
}

double angle_between(const glm::dquat& a, const glm::dquat& b) {
    const glm::dquat difference = glm::conjugate(segments::unit(a)) * segments::unit(b);
    return 2 * std::atan2(glm::length(glm::dvec3(difference.x, difference.y, difference.z)), std::abs(difference.w));
}

/// Radians. Squad and the spline swing out and back between two keys: their turn is that of many short steps.
double distance(const Track<glm::dquat>& track, std::size_t i, double from_u, double to_u) {
    const auto y = [&](double u) { return track.keys[i].ease ? eased(*track.keys[i].ease, u) : u; };
    if (track.interpolation == Interpolation::linear && track.keys[i].spin) {
        const segments::SegmentTurn turn = segments::turn_of_segment(track, i);
        return 2 * glm::length(turn.step + turn.extra) * std::abs(y(to_u) - y(from_u));
    }
    const int steps = track.interpolation == Interpolation::linear ? 1 : 16;
    const auto whole = [&](double u) { return segments::whole_turns_done(track, i, y(u)); };
    const auto rest = [&](double u) { return exp_of(-whole(u)) * segments::unit(segments::value_at(track, i, u)); };
    double turn = 0;
    for (int n = 0; n < steps; ++n) {
        const double a = std::lerp(from_u, to_u, static_cast<double>(n) / steps), b = std::lerp(from_u, to_u, (n + 1.0) / steps);
        if (track.keys[i].spin)
            turn += angle_between(rest(a), rest(b)) + 2 * glm::distance(whole(a), whole(b));
        else
            turn += angle_between(segments::value_at(track, i, a), segments::value_at(track, i, b));
    }
    return turn;
}

double end_speed(const Track<double>& track, bool after) { return std::abs(segments::end_slope_before_easing(track, after)); }
double end_speed(const Track<glm::dquat>& track, bool after) { return 2 * glm::length(segments::end_turn_rate_before_easing(track, after)); }

/// Within the keyed span.
template <class T>
double travel_of_keys(const Track<T>& track, double begin_s, double end_s) {
    double travel = 0;
    if (track.interpolation == Interpolation::step) return travel;
    const std::size_t last = segment_at(track, end_s, true);
    for (std::size_t i = segment_at(track, begin_s, false); i <= last; ++i)
        travel += distance(track, i, std::clamp(part_of_segment(track, i, begin_s), 0.0, 1.0), std::clamp(part_of_segment(track, i, end_s), 0.0, 1.0));
    return travel;
}

/// Beyond an end that continues.
template <class T>
double travel_beyond(const Track<T>& track, double begin_s, double end_s) {
    double travel = 0;
    const auto speed = [&](bool after) { return end_speed(track, after) * std::abs(segments::end_easing_slope(track, after)); };
    if (track.before == Extrapolation::continued) travel += speed(false) * std::max(0.0, std::min(end_s, track.keys.front().time_s) - begin_s);
    if (track.after == Extrapolation::continued) travel += speed(true) * std::max(0.0, end_s - std::max(begin_s, track.keys.back().time_s));
    return travel;
}

template <class T>
double travel_in(const Track<T>& track, double begin_s, double end_s) {
    if (track.is_constant()) return 0;
    const KeyedSpan span = span_of(track);
    const SpanPasses passes = passes_within(span, begin_s, end_s);
    double travel = travel_beyond(track, begin_s, end_s);
    if (passes.count > 3) return travel + passes.count * travel_of_keys(track, span.first_s, span.last_s);
    visit_passes(span, begin_s, end_s, [&](const SpanPass& pass) {
        const double a = pass.to_local(begin_s), b = pass.to_local(end_s);
        travel += travel_of_keys(track, std::min(a, b), std::max(a, b));
    });
    return travel;
}

}  // namespace

template <class T>
T evaluate(const Track<T>& track, double time_s) {
    assert(!track.keys.empty());
    if (track.keys.size() == 1) return finished(track.keys.front().value);
    const FoldedTime at = fold(span_of(track), time_s);
    if (at.beyond_s != 0) return finished(segments::continued(track, at.beyond_s));
    const std::size_t i = segment_at(track, at.time_s, at.mirrored);
    const double u = loops(track) ? part_by_ticks(track, i, at.time_s) : part_of_segment(track, i, at.time_s);
    if (track.interpolation == Interpolation::step) return finished(track.keys[u >= 1 && !at.mirrored ? i + 1 : i].value);
    return finished(segments::value_at(track, i, u));
}

template <class T>
std::vector<double> discontinuities(const Track<T>& track, double begin_s, double end_s) {
    std::vector<double> times;
    if (!ever_jumps(track)) return times;
    const KeyedSpan span = span_of(track);
    const std::size_t last = track.keys.size() - 1;
    const auto add = [&](double time) {
        if (!is_inside(time, begin_s, end_s)) return;
        times.push_back(time);
        if (times.size() > kMostListedTimes) refuse_jumps(begin_s, end_s);
    };
    visit_passes(span, begin_s, end_s, [&](const SpanPass& pass) {
        if (jumps_between_passes(track, pass.number)) add(pass.to_shot(pass.mirrored ? span.last_s : span.first_s));
        visit_keys(track, pass, begin_s, end_s, [&](std::size_t j) {
            if (j > 0 && j < last && jumps_at(track, j)) add(pass.to_shot(track.keys[j].time_s));
        });
        // The pass after the last one may not be visited: where it does not loop, or begins beyond the interval.
        if (pass.number == 0 && track.after != Extrapolation::repeat && jumps_between_passes(track, 1.0)) add(span.last_s);
    });
    return times;
}

template <class T>
std::vector<double> key_times(const Track<T>& track, double begin_s, double end_s) {
    std::vector<double> times;
    if (track.is_constant()) return times;
    const KeyedSpan span = span_of(track);
    const double first_pass = passes_within(span, begin_s, end_s).first;
    visit_passes(span, begin_s, end_s, [&](const SpanPass& pass) {
        const std::size_t start = pass.mirrored ? track.keys.size() - 1 : 0;
        visit_keys(track, pass, begin_s, end_s, [&](std::size_t j) {
            const bool is_end_of_pass_before = j == start && pass.number != first_pass;
            if (!is_end_of_pass_before && times.size() < kMostListedTimes) times.push_back(pass.to_shot(track.keys[j].time_s));
        });
    });
    return times;
}

template <class T>
bool varies(const Track<T>& track) {
    for (std::size_t i = 1; i < track.keys.size(); ++i) {
        const Key<T>&a = track.keys[i - 1], &b = track.keys[i];
        if (a.value != b.value) return true;
        if (track.interpolation == Interpolation::cubic && (a.out_tangent != T{} || b.in_tangent != T{})) return true;
        if constexpr (kIsRotation<T>)
            if (a.spin && segments::turn_of_segment(track, i - 1).extra != glm::dvec3(0)) return true;
    }
    return false;
}

#define KADR_TRACK_OF(T)                                                     \
    template T evaluate(const Track<T>&, double);                           \
    template std::vector<double> discontinuities(const Track<T>&, double, double); \
    template std::vector<double> key_times(const Track<T>&, double, double); \
    template bool varies(const Track<T>&);
KADR_TRACK_OF(double)
KADR_TRACK_OF(glm::dvec2)
KADR_TRACK_OF(glm::dvec3)
KADR_TRACK_OF(glm::dquat)
#undef KADR_TRACK_OF

double travel_of(const Track<double>& track, double begin_s, double end_s) { return travel_in(track, begin_s, end_s); }
double turn_of(const Track<glm::dquat>& track, double begin_s, double end_s) { return travel_in(track, begin_s, end_s); }

}  // namespace kadr
