#include "shot/track_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "anim/track_extremes.h"
#include "base/text.h"
#include "shot/section.h"

namespace kadr {

namespace {

struct Window {
    double begin_s, end_s;
};

Window window_of(const Sequence& sequence, double lead_s) {
    const std::vector<int>& frames = sequence.timing().frames;
    const FrameTime first = sequence.frame(frames.front()), last = sequence.frame(frames.back());
    // The exposure is that of the frame's own time, whatever is open of its shutter.
    return {std::min(first.open_s, first.time_s()) - lead_s, std::max(last.close_s, last.time_s())};
}

double in_natural_unit(const FieldSpec& spec, double value) { return value / from_natural(spec.quantity, 1); }

double largest_key(const Track<double>& track) {
    double largest = 0;
    for (const Key<double>& key : track.keys) largest = std::max(largest, std::abs(key.value));
    return largest;
}

/// How far a value is out of range, in the natural unit; 0 within it.
double excess(const FieldSpec& spec, double value, double rounding) {
    if (!std::isfinite(value)) return kInfinity;
    if (spec.low == kAboveZero && value <= 0) return std::max(-value, kAboveZero);
    return std::max({0.0, spec.low - value - rounding, value - spec.high - rounding});
}

struct Offence {
    std::size_t component;
    double value, time_s, excess;  ///< in the natural unit
};

std::optional<Offence> worst_offence(const LimitedTrack& limited, const Window& window) {
    constexpr double kRounding = 1e-12;  // of the keys: a few of the operations that blend them
    std::optional<Offence> worst;
    for (std::size_t c = 0; c < limited.components.size(); ++c) {
        const Track<double>& track = limited.components[c];
        const double rounding = kRounding * in_natural_unit(*limited.spec, largest_key(track));
        const Extremes extremes = extremes_of(track, window.begin_s, window.end_s);
        for (const Extreme& extreme : {extremes.least, extremes.greatest}) {
            const double value = in_natural_unit(*limited.spec, extreme.value), over = excess(*limited.spec, value, rounding);
            if (over > (worst ? worst->excess : 0)) worst = Offence{c, value, extreme.time_s, over};
        }
    }
    return worst;
}

const char* advice(Excursion excursion) {
    switch (excursion) {
        case Excursion::continued: return "the track goes on with its end's slope; use hold, or a key where it should stop";
        case Excursion::ease: return "the ease of the key before swings beyond its ends; keep its y1 and y2 from 0 to 1";
        case Excursion::smooth: return "smooth swings beyond its keys; add overshoot: false";
        case Excursion::cubic: break;
    }
    return "its tangents carry it beyond its keys; make them flatter";
}

/// Six digits, or all of them where six would look like a value that is allowed.
std::string shown(const FieldSpec& spec, double value) {
    const double rounded = std::stod(fmt::format("{:.6g}", value));
    const std::string number = format_number(excess(spec, rounded, 0) > 0 ? rounded : value);
    const std::string_view unit = natural_unit(spec.quantity);
    return unit.empty() ? number : fmt::format("{} {}", number, unit);
}

Diagnostic problem_of(const LimitedTrack& limited, const Offence& offence, const Timing& timing) {
    Diagnostic problem = limited.place;
    const std::string component = limited.components.size() > 1 ? fmt::format("[{}]", offence.component) : "";
    const double frame = timing.first + offence.time_s * timing.fps.value();
    problem.found = fmt::format("{}{} is {} at {} s (frame {})", limited.name, component, shown(*limited.spec, offence.value), format_number(std::round(offence.time_s * 1e4) / 1e4),
                                format_number(std::round(frame * 100) / 100));
    problem.expected = fmt::format("expected {}; {}", range_text(*limited.spec), advice(excursion_at(limited.components[offence.component], offence.time_s)));
    return problem;
}

bool has_limits(const FieldSpec& spec) { return spec.low > -kInfinity || spec.high < kInfinity; }

void note(const Field& field, std::vector<Track<double>> components, const FieldSpec& spec) {
    if (!has_limits(spec) || std::none_of(components.begin(), components.end(), may_leave_keys)) return;
    field.context->limited_tracks.push_back({field.name, diagnostic_at(field.node->place, {}, {}), &spec, std::move(components)});
}

template <class Vector>
std::vector<Track<double>> components_of(const Track<Vector>& track) {
    std::vector<Track<double>> components;
    for (int c = 0; c < Vector::length(); ++c) components.push_back(component_of(track, c));
    return components;
}

}  // namespace

void note_limits(const Field& field, const Track<double>& track) { note(field, {track}, *field.spec); }
void note_limits(const Field& field, const Track<glm::dvec2>& track) { note(field, components_of(track), *field.spec); }
void note_limits(const Field& field, const Track<glm::dvec3>& track) { note(field, components_of(track), *field.spec); }
void note_limits(const Field& field, const Track<double>& track, const FieldSpec& spec) { note(field, {track}, spec); }

std::vector<Diagnostic> values_out_of_range(std::span<const LimitedTrack> tracks, const Sequence& sequence, double lead_s) {
    std::vector<Diagnostic> problems;
    if (tracks.empty() || sequence.timing().frames.empty()) return problems;
    const Window window = window_of(sequence, lead_s);
    for (const LimitedTrack& limited : tracks)
        if (const auto offence = worst_offence(limited, window)) problems.push_back(problem_of(limited, *offence, sequence.timing()));
    return problems;
}

}  // namespace kadr
