#pragma once

#include "anim/track.h"

namespace kadr {

/// Whether the values may leave the range of the keys: smooth and cubic tangents, eases that overshoot, a track that
/// continues beyond its ends.
bool may_leave_keys(const Track<double>& track);

struct Extreme {
    double value, time_s;  ///< where several times have the value, one of them
};
struct Extremes {
    Extreme least, greatest;
};
/// The least and the greatest value in [begin, end], which are found by where the track turns, not by sampling.
Extremes extremes_of(const Track<double>& track, double begin_s, double end_s);

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
