#include "anim/extrapolation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kadr {

namespace {

/// Of what a few operations on numbers leave undecided.
double rounding_of(double magnitude) { return 4 * std::numeric_limits<double>::epsilon() * magnitude; }

bool loops(Extrapolation mode) { return mode == Extrapolation::repeat || mode == Extrapolation::pingpong; }

}  // namespace

double wrapped(double x, double period, double magnitude) {
    double rest = std::fmod(x, period);
    if (rest < 0) rest += period;
    return rest < period - rounding_of(magnitude) ? rest : 0;
}

FoldedTime fold(const KeyedSpan& span, double time_s) {
    const double magnitude = std::abs(time_s) + std::abs(span.first_s) + std::abs(span.last_s);
    const bool at_seam = span.after == Extrapolation::repeat && span.last_s - time_s <= rounding_of(magnitude);
    if (time_s >= span.first_s && time_s < span.last_s && !at_seam) return {time_s};
    const bool after = time_s >= span.last_s || at_seam;
    const double end = after ? span.last_s : span.first_s;
    const double past = time_s - span.first_s;
    switch (after ? span.after : span.before) {
        case Extrapolation::hold: return {end};
        case Extrapolation::continued: return {end, false, time_s - end};
        case Extrapolation::repeat: return {span.first_s + wrapped(past, span.seconds(), magnitude)};
        case Extrapolation::pingpong: break;
    }
    const double there_and_back = wrapped(past, 2 * span.seconds(), magnitude);
    if (there_and_back < span.seconds()) return {span.first_s + there_and_back};
    return {std::min(span.last_s, span.first_s + (2 * span.seconds() - there_and_back)), true};
}

SpanPasses passes_within(const KeyedSpan& span, double begin_s, double end_s) {
    double from = std::floor((begin_s - span.first_s) / span.seconds());
    double to = std::floor((end_s - span.first_s) / span.seconds());
    if (!loops(span.before)) from = std::max(from, 0.0);
    if (!loops(span.after)) to = std::min(to, 0.0);
    return to >= from ? SpanPasses{from, to - from + 1} : SpanPasses{};
}

SpanPass pass_at(const KeyedSpan& span, double number) {
    const Extrapolation mode = number < 0 ? span.before : span.after;
    const bool odd = std::fmod(number, 2) != 0;
    return {&span, number, odd && mode == Extrapolation::pingpong};
}

double SpanPass::to_shot(double local_s) const {
    if (number == 0) return local_s;
    const double into = mirrored ? span->last_s - local_s : local_s - span->first_s;
    return span->first_s + (number * span->seconds() + into);
}

double SpanPass::to_local(double shot_s) const {
    const double into = shot_s - span->first_s - number * span->seconds();
    // The ends are the keys' own times: first_s + seconds() may be the double before last_s, and the last key would lie beyond.
    if (into <= 0) return mirrored ? span->last_s : span->first_s;
    if (into >= span->seconds()) return mirrored ? span->first_s : span->last_s;
    return mirrored ? span->last_s - into : span->first_s + into;
}

}  // namespace kadr
