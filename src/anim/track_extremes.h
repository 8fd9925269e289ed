#pragma once

#include <vector>

#include "anim/track.h"

namespace kadr {

/// Whether the values may leave the range of the keys: smooth and cubic tangents, eases that overshoot, a track that
/// continues beyond its ends.
bool may_leave_keys(const Track<double>& track);

/// The greatest magnitude of a key.
double largest_key(const Track<double>& track);

struct Extreme {
    double value, time_s;  ///< where several times have the value, one of them
};
struct Extremes {
    Extreme least, greatest;
};
/// The least and the greatest value in [begin, end], which are found by where the track turns, not by sampling.
Extremes extremes_of(const Track<double>& track, double begin_s, double end_s);

/// Times in [begin, end] at which the value passes through zero or, but for rounding, turns at it. Jumps over zero do not
/// count, nor stretches where it stays zero; of a track that loops, those of its first passes in the interval.
std::vector<double> zeros_of(const Track<double>& track, double begin_s, double end_s);

/// Where a - b is greatest in [begin, end]: exact where both are linear from key to key, else looked for at 16 times
/// between keys and from there.
Extreme greatest_difference(const Track<double>& a, const Track<double>& b, double begin_s, double end_s);

/// What carries the value beyond those of the keys at a time at which it is.
enum class Excursion { continued, ease, smooth, cubic };
Excursion excursion_at(const Track<double>& track, double time_s);

/// One component of a vector over time.
template <class Vector>
Track<double> component_of(const Track<Vector>& track, int component) {
    Track<double> one;
    one.interpolation = track.interpolation;
    one.before = track.before, one.after = track.after, one.overshoot = track.overshoot;
    for (const Key<Vector>& key : track.keys)
        one.keys.push_back({key.time_s, key.value[component], key.ease, key.in_tangent[component], key.out_tangent[component]});
    return one;
}

}  // namespace kadr
