#include "anim/track_extremes.h"

#include <algorithm>
#include <cassert>

#include "anim/roots.h"
#include "anim/segments.h"

namespace kadr {

namespace {

bool curved(const Track<double>& track) { return track.interpolation == Interpolation::smooth || track.interpolation == Interpolation::cubic; }

bool leaves_unit_range(const Ease& ease) {
    const auto outside = [](double y) { return y < 0 || y > 1; };
    return outside(ease[1]) || outside(ease[3]);  // the curve lies in the hull of its control points
}

bool overshooting_ease(const Track<double>& track, std::size_t i) { return track.keys[i].ease && leaves_unit_range(*track.keys[i].ease); }

bool continues(const Track<double>& track) {
    return track.interpolation != Interpolation::step && (track.before == Extrapolation::continued || track.after == Extrapolation::continued);
}

/// Where the curve of a segment turns, as parts of it before its ease; beyond [0, 1] too, where an ease may lead.
std::vector<double> hermite_turns(const Track<double>& track, std::size_t i) {
    if (!curved(track)) return {};
    const double seconds = segments::seconds_between(track, i, i + 1), a = track.keys[i].value, b = track.keys[i + 1].value;
    const bool smooth = track.interpolation == Interpolation::smooth;
    const double a_slope = seconds * (smooth ? segments::slope_at(track, i) : track.keys[i].out_tangent);
    const double b_slope = seconds * (smooth ? segments::slope_at(track, i + 1) : track.keys[i + 1].in_tangent);
    // The derivative of segments::hermite in powers of u.
    return quadratic_roots(3 * (2 * (a - b) + a_slope + b_slope), 2 * (3 * (b - a) - 2 * a_slope - b_slope), a_slope);
}

/// Parts of a segment at which its value can be least or greatest, beside its ends.
std::vector<double> turns_of(const Track<double>& track, std::size_t i) {
    const std::vector<double> turns = hermite_turns(track, i);
    if (!track.keys[i].ease) return turns;
    std::vector<double> parts = turning_points(*track.keys[i].ease);
    for (const double turn : turns) {
        const std::vector<double> more = crossings(*track.keys[i].ease, turn);
        parts.insert(parts.end(), more.begin(), more.end());
    }
    return parts;
}

void widen(Extremes& extremes, double value, double time_s) {
    if (value < extremes.least.value) extremes.least = {value, time_s};
    if (value > extremes.greatest.value) extremes.greatest = {value, time_s};
}

/// Key times and turns of one pass over the keyed span, where they lie in the interval.
void widen_by_pass(const Track<double>& track, const SpanPass& pass, double begin_s, double end_s, Extremes& extremes) {
    const double a = pass.to_local(begin_s), b = pass.to_local(end_s), low = std::min(a, b), high = std::max(a, b);
    for (std::size_t i = 0; i < track.keys.size(); ++i) {
        const double key_s = track.keys[i].time_s;
        if (key_s >= low && key_s <= high) widen(extremes, track.keys[i].value, pass.to_shot(key_s));
        if (i + 1 == track.keys.size() || track.interpolation == Interpolation::step) continue;
        const double seconds = segments::seconds_between(track, i, i + 1);
        if (key_s + seconds < low || key_s > high) continue;
        for (const double part : turns_of(track, i))
            if (const double time_s = key_s + part * seconds; part > 0 && part < 1 && time_s >= low && time_s <= high)
                widen(extremes, segments::value_at(track, i, part), pass.to_shot(time_s));
    }
}

}  // namespace

bool may_leave_keys(const Track<double>& track) {
    if (track.is_constant() || track.interpolation == Interpolation::step) return false;
    if (continues(track) || track.interpolation == Interpolation::cubic) return true;
    if (track.interpolation == Interpolation::smooth && track.overshoot) return true;
    for (std::size_t i = 0; i + 1 < track.keys.size(); ++i)
        if (overshooting_ease(track, i)) return true;
    return false;
}

Extremes extremes_of(const Track<double>& track, double begin_s, double end_s) {
    const double first = evaluate(track, begin_s);
    Extremes extremes{{first, begin_s}, {first, begin_s}};
    widen(extremes, evaluate(track, end_s), end_s);
    if (track.is_constant()) return extremes;
    const KeyedSpan span{track.keys.front().time_s, track.keys.back().time_s, track.before, track.after};
    const SpanPasses passes = passes_within(span, begin_s, end_s);
    constexpr double kEnough = 3;  // of them, one is whole: the others have nothing that it has not
    for (double k = 0; k < std::min(passes.count, kEnough); ++k) widen_by_pass(track, pass_at(span, passes.first + k), begin_s, end_s, extremes);
    return extremes;
}

Excursion excursion_at(const Track<double>& track, double time_s) {
    assert(track.keys.size() > 1);
    const FoldedTime at = fold({track.keys.front().time_s, track.keys.back().time_s, track.before, track.after}, time_s);
    if (at.beyond_s != 0) return Excursion::continued;
    std::size_t i = 0;
    while (i + 2 < track.keys.size() && track.keys[i + 1].time_s <= at.time_s) ++i;
    if (overshooting_ease(track, i)) return Excursion::ease;
    return track.interpolation == Interpolation::cubic ? Excursion::cubic : Excursion::smooth;
}

}  // namespace kadr
