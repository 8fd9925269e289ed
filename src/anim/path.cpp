#include "anim/path.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace kadr {

double Path::Segment::length(double from, double to) const {
    constexpr double kAt[] = {0, 0.5384693101056831, 0.9061798459386640};
    constexpr double kWeight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    double sum = kWeight[0] * glm::length(slope(middle));
    for (int i = 1; i < 3; ++i) sum += kWeight[i] * (glm::length(slope(middle - half * kAt[i])) + glm::length(slope(middle + half * kAt[i])));
    return half * sum;
}

/// The cubic with the tangents of the centripetal spline; a missing neighbour is the reflected one, whose tangent is the secant.
Path::Segment Path::segment_between(std::size_t from) const {
    const std::size_t n = points_.size(), to = (from + 1) % n;
    const glm::dvec3 &a = points_[from], &b = points_[to];
    const auto knots = [](const glm::dvec3& p, const glm::dvec3& q) { return std::sqrt(glm::distance(p, q)); };
    const double d = knots(a, b);
    const glm::dvec3 secant = (b - a) / d;
    const auto tangent = [&](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
        const double left = knots(p, q), right = knots(q, r);
        return (q - p) / left - (r - p) / (left + right) + (r - q) / right;
    };
    const bool first = !closed_ && from == 0, last = !closed_ && to == n - 1;
    const glm::dvec3 start = d * (first ? secant : tangent(points_[(from + n - 1) % n], a, b));
    const glm::dvec3 end = d * (last ? secant : tangent(a, b, points_[(to + 1) % n]));
    return {a, start, 3.0 * (b - a) - 2.0 * start - end, 2.0 * (a - b) + start + end};
}

void Path::add_spans(std::size_t segment, double from, double to, double length, double tolerance, int depth) {
    const double middle = 0.5 * (from + to);
    const double left = segments_[segment].length(from, middle), right = segments_[segment].length(middle, to);
    constexpr int kDeepest = 24;
    // Not "<=": a length that is not finite would be halved without end.
    if (depth >= kDeepest || !(std::abs(left + right - length) > tolerance)) {
        spans_.push_back({segment, from, to, length_});
        length_ += length;
        return;
    }
    add_spans(segment, from, middle, left, tolerance, depth + 1);
    add_spans(segment, middle, to, right, tolerance, depth + 1);
}

Path::Path(std::vector<glm::dvec3> points, bool closed) : points_(std::move(points)), closed_(closed) {
    assert(points_.size() >= (closed ? 3u : 2u));
    const std::size_t count = closed_ ? points_.size() : points_.size() - 1;
    double chords = 0;
    for (std::size_t i = 0; i < count; ++i) {
        segments_.push_back(segment_between(i));
        chords += glm::distance(points_[i], points_[(i + 1) % points_.size()]);
    }
    // Of all spans together: an error of each that adds up to 1e-10 of the length.
    const double tolerance = 1e-10 * chords / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) add_spans(i, 0, 1, segments_[i].length(0, 1), tolerance, 0);
}

Path::Place Path::place(double fraction) const {
    const double wrapped = closed_ ? fraction - std::floor(fraction) : std::clamp(fraction, 0.0, 1.0);
    const double target = wrapped * length_;
    const auto after = std::upper_bound(spans_.begin() + 1, spans_.end(), target, [](double s, const Span& span) { return s < span.start_m; });
    const Span& span = *(after - 1);
    const Segment& segment = segments_[span.segment];
    const double wanted = target - span.start_m, all = (after == spans_.end() ? length_ : after->start_m) - span.start_m;
    double low = span.from, high = span.to, u = std::clamp(low + (high - low) * (wanted / all), low, high);
    // Newton inside a bracket: the length grows with u, but hardly where the curve turns back.
    for (int step = 0; step < 60; ++step) {
        const double error = segment.length(span.from, u) - wanted;
        if (std::abs(error) <= 1e-13 * length_) break;
        (error > 0 ? high : low) = u;
        const double newton = u - error / glm::length(segment.slope(u));
        u = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return {span.segment, u};
}

glm::dvec3 Path::position(double fraction) const {
    const Place at = place(fraction);
    return segments_[at.segment].at(at.u);
}

glm::dvec3 Path::tangent(double fraction) const {
    const Place at = place(fraction);
    const glm::dvec3 slope = segments_[at.segment].slope(at.u);
    const double speed = glm::length(slope);
    constexpr double kStops = 1e-9;  // of the segment's own size
    return speed > kStops * glm::length(segments_[at.segment].c1 + segments_[at.segment].c2 + segments_[at.segment].c3) ? slope / speed : glm::dvec3(0);
}

}  // namespace kadr
