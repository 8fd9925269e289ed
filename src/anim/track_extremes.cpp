#include "anim/track_extremes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>

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

KeyedSpan span_of(const Track<double>& track) { return {track.keys.front().time_s, track.keys.back().time_s, track.before, track.after}; }

/// Calls visit(pass) for the passes over the keyed span that meet an interval, as far as they differ.
template <class Visit>
void visit_passes(const KeyedSpan& span, double begin_s, double end_s, Visit visit) {
    const SpanPasses passes = passes_within(span, begin_s, end_s);
    constexpr double kEnough = 3;  // of them, one is whole: the others have nothing that it has not
    for (double k = 0; k < std::min(passes.count, kEnough); ++k) visit(pass_at(span, passes.first + k));
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

/// Where a function that rises or falls from one argument to another is zero; nothing where its sign stays, and where it is
/// zero at both. @param touch  what counts as zero at an end
template <class Function>
std::optional<double> zero_between(Function at, double from, double to, double touch) {
    double a = at(from), b = at(to);
    const bool at_from = std::abs(a) <= touch, at_to = std::abs(b) <= touch;
    if (at_from != at_to) return at_from ? from : to;
    if (at_from || (a < 0) == (b < 0)) return std::nullopt;
    for (double middle = std::midpoint(from, to); middle > std::min(from, to) && middle < std::max(from, to); middle = std::midpoint(from, to)) {
        const double value = at(middle);
        if ((value < 0) == (a < 0)) from = middle;
        else to = middle;
    }
    return to;
}

/// Zeros of the segments of one pass, where it lies in the interval.
void add_zeros(const Track<double>& track, const SpanPass& pass, double begin_s, double end_s, double touch, std::vector<double>& times) {
    const double low = std::min(pass.to_local(begin_s), pass.to_local(end_s)), high = std::max(pass.to_local(begin_s), pass.to_local(end_s));
    for (std::size_t i = 0; i + 1 < track.keys.size(); ++i) {
        const double key_s = track.keys[i].time_s, seconds = segments::seconds_between(track, i, i + 1);
        const double first = std::clamp((low - key_s) / seconds, 0.0, 1.0), last = std::clamp((high - key_s) / seconds, 0.0, 1.0);
        std::vector<double> parts = turns_of(track, i);
        std::erase_if(parts, [&](double part) { return !(part > first && part < last); });
        parts.insert(parts.end(), {first, last});
        std::sort(parts.begin(), parts.end());
        const auto at = [&](double part) { return segments::value_at(track, i, part); };
        for (std::size_t p = 1; p < parts.size(); ++p)
            if (const auto part = zero_between(at, parts[p - 1], parts[p], touch)) times.push_back(pass.to_shot(key_s + *part * seconds));
    }
}

/// Keys of both tracks, the interval's ends, and times between them where something curves.
std::vector<double> places_to_look(const Track<double>& a, const Track<double>& b, double begin_s, double end_s) {
    constexpr int kSteps = 16;
    std::vector<double> keys = key_times(a, begin_s, end_s);
    const std::vector<double> more = key_times(b, begin_s, end_s);
    keys.insert(keys.end(), more.begin(), more.end());
    keys.push_back(end_s);
    std::sort(keys.begin(), keys.end());
    std::vector<double> places{begin_s};
    for (const double key : keys) {
        const double from = places.back();
        for (int i = 1; i < kSteps; ++i) places.push_back(std::lerp(from, key, static_cast<double>(i) / kSteps));
        places.push_back(key);
    }
    return places;
}

/// The greatest value of a function that has one between two arguments. Source: Kiefer 1953, golden-section search.
template <class Function>
Extreme greatest_between(Function at, double from, double to) {
    constexpr double kGolden = 0.6180339887498949;
    double left = to - kGolden * (to - from), right = from + kGolden * (to - from), at_left = at(left), at_right = at(right);
    for (int step = 0; step < 60; ++step) {  // to 3e-13 of the stretch
        const bool lower = at_left >= at_right;
        (lower ? to : from) = lower ? right : left;
        if (lower) right = left, at_right = at_left, at_left = at(left = to - kGolden * (to - from));
        else left = right, at_left = at_right, at_right = at(right = from + kGolden * (to - from));
    }
    return at_left >= at_right ? Extreme{at_left, left} : Extreme{at_right, right};
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

double largest_key(const Track<double>& track) {
    double largest = 0;
    for (const Key<double>& key : track.keys) largest = std::max(largest, std::abs(key.value));
    return largest;
}

Extremes extremes_of(const Track<double>& track, double begin_s, double end_s) {
    const double first = evaluate(track, begin_s);
    Extremes extremes{{first, begin_s}, {first, begin_s}};
    widen(extremes, evaluate(track, end_s), end_s);
    if (track.is_constant()) return extremes;
    visit_passes(span_of(track), begin_s, end_s, [&](const SpanPass& pass) { widen_by_pass(track, pass, begin_s, end_s, extremes); });
    return extremes;
}

std::vector<double> zeros_of(const Track<double>& track, double begin_s, double end_s) {
    std::vector<double> times;
    if (track.is_constant() || track.interpolation == Interpolation::step) return times;
    constexpr double kRounding = 1e-14;  // of the keys: a few of the operations that blend them
    const double touch = kRounding * largest_key(track);
    const KeyedSpan span = span_of(track);
    visit_passes(span, begin_s, end_s, [&](const SpanPass& pass) { add_zeros(track, pass, begin_s, end_s, touch, times); });
    const auto add_beyond = [&](double from_s, double to_s) {
        if (!(to_s > from_s)) return;
        if (const auto zero = zero_between([&](double time_s) { return evaluate(track, time_s); }, from_s, to_s, touch)) times.push_back(*zero);
    };
    if (track.before == Extrapolation::continued) add_beyond(begin_s, std::min(end_s, span.first_s));
    if (track.after == Extrapolation::continued) add_beyond(std::max(begin_s, span.last_s), end_s);
    std::sort(times.begin(), times.end());
    return times;
}

Extreme greatest_difference(const Track<double>& a, const Track<double>& b, double begin_s, double end_s) {
    const auto at = [&](double time_s) { return evaluate(a, time_s) - evaluate(b, time_s); };
    const std::vector<double> places = places_to_look(a, b, begin_s, end_s);
    std::vector<double> values;
    for (const double time_s : places) values.push_back(at(time_s));
    Extreme greatest{values[0], places[0]};
    const auto look = [&greatest](const Extreme& found) {
        if (found.value > greatest.value) greatest = found;
    };
    for (std::size_t i = 0; i < places.size(); ++i) {
        look({values[i], places[i]});
        const double before = i > 0 ? values[i - 1] : values[i], after = i + 1 < places.size() ? values[i + 1] : values[i];
        if (values[i] >= before && values[i] >= after && (values[i] > before || values[i] > after))
            look(greatest_between(at, places[i > 0 ? i - 1 : i], places[std::min(i + 1, places.size() - 1)]));
    }
    return greatest;
}

Excursion excursion_at(const Track<double>& track, double time_s) {
    assert(track.keys.size() > 1);
    const FoldedTime at = fold(span_of(track), time_s);
    if (at.beyond_s != 0) return Excursion::continued;
    std::size_t i = 0;
    while (i + 2 < track.keys.size() && track.keys[i + 1].time_s <= at.time_s) ++i;
    if (overshooting_ease(track, i)) return Excursion::ease;
    return track.interpolation == Interpolation::cubic ? Excursion::cubic : Excursion::smooth;
}

}  // namespace kadr
