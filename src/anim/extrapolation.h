#pragma once

#include <cstddef>

namespace kadr {

/// What a track does outside its keys. hold: the end's value; repeat: the keyed span again and again, with a jump at
/// the seam where the ends differ; pingpong: there and back; continued: straight on with the end's slope.
enum class Extrapolation { hold, repeat, pingpong, continued };

/// x modulo a period, in [0, period). What lies before a multiple by no more than rounding is that multiple: frame 51 is three
/// times 17 frames, whatever 51/24 and 17/24 seconds are rounded to.
/// @param magnitude  of the numbers that x was computed from
double wrapped(double x, double period, double magnitude);

/// The keyed span of a track, and what it does beyond it. @pre first_s < last_s
struct KeyedSpan {
    double first_s, last_s;
    Extrapolation before, after;
    double seconds() const { return last_s - first_s; }
};

/// The time of the keyed span that stands for a time of the shot.
struct FoldedTime {
    double time_s;          ///< in [first, last]
    bool mirrored = false;  ///< the span is passed backwards
    double beyond_s = 0;    ///< continued: seconds after the last key, negative before the first
};
FoldedTime fold(const KeyedSpan& span, double time_s);

/// The passes over the keyed span that meet (begin, end): pass k covers first + k * span to first + (k + 1) * span,
/// pass 0 is the one that is keyed. Numbers are whole doubles, for an interval may hold more passes than integers count.
struct SpanPasses {
    double first = 0, count = 0;
};
SpanPasses passes_within(const KeyedSpan& span, double begin_s, double end_s);

/// One pass: which way it runs, and its times.
struct SpanPass {
    const KeyedSpan* span;
    double number;
    bool mirrored;
    /// Of the keyed span to the shot and back.
    double to_shot(double local_s) const;
    double to_local(double shot_s) const;
};
SpanPass pass_at(const KeyedSpan& span, double number);

}  // namespace kadr
