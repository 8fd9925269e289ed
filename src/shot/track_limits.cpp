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

Window window_of(const FrameTime& first, const FrameTime& last, double lead_s) {
    // The exposure is that of the frame's own time, whatever is open of its shutter.
    return {std::min(first.open_s, first.time_s()) - lead_s, std::max(last.close_s, last.time_s())};
}

double in_natural_unit(const FieldSpec& spec, double value) { return value / from_natural(spec.quantity, 1); }

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

double six_digits(double value) { return std::stod(fmt::format("{:.6g}", value)); }

std::string with_unit(const FieldSpec& spec, double value) {
    const std::string_view unit = natural_unit(spec.quantity);
    return unit.empty() ? format_number(value) : fmt::format("{} {}", format_number(value), unit);
}

/// Six digits, or all of them where six would look like a value that is allowed.
std::string shown(const FieldSpec& spec, double value) {
    const double rounded = six_digits(value);
    return with_unit(spec, excess(spec, rounded, 0) > 0 ? rounded : value);
}

/// "at 0.5 s (frame 12)"
std::string time_text(double time_s, const Timing& timing) {
    const double frame = timing.first + time_s * timing.fps.value();
    return fmt::format("at {} s (frame {})", format_number(std::round(time_s * 1e4) / 1e4), format_number(std::round(frame * 100) / 100));
}

std::string component_name(const LimitedTrack& limited, std::size_t component) {
    return limited.components.size() > 1 ? fmt::format("{}[{}]", limited.name, component) : limited.name;
}

Diagnostic in_words(const LimitedTrack& limited, std::string found, std::string expected) {
    Diagnostic problem = limited.place;
    problem.found = std::move(found);
    problem.expected = std::move(expected);
    return problem;
}

std::optional<Diagnostic> problem_of_range(const LimitedTrack& limited, const Window& window, const Timing& timing) {
    const auto offence = worst_offence(limited, window);
    if (!offence) return std::nullopt;
    return in_words(limited, fmt::format("{} is {} {}", component_name(limited, offence->component), shown(*limited.spec, offence->value), time_text(offence->time_s, timing)),
                      fmt::format("expected {}; {}", range_text(*limited.spec), advice(excursion_at(limited.components[offence->component], offence->time_s))));
}

std::optional<Diagnostic> problem_of_sign(const LimitedTrack& limited, const Window& window, const Timing& timing) {
    std::optional<std::pair<double, std::size_t>> first;  // the time and the component
    for (std::size_t c = 0; c < limited.components.size(); ++c)
        if (const auto zeros = zeros_of(limited.components[c], window.begin_s, window.end_s); !zeros.empty() && (!first || zeros[0] < first->first)) first.emplace(zeros[0], c);
    if (!first) return std::nullopt;
    return in_words(limited, fmt::format("{} passes through zero {}", component_name(limited, first->second), time_text(first->first, timing)),
                      "expected a scale that keeps its sign; interpolate: step mirrors a thing at once, a tiny scale such as 1e-6 makes it vanish");
}

std::optional<Diagnostic> problem_of_direction(const LimitedTrack& limited, const Window& window, const Timing& timing) {
    constexpr double kRounding = 1e-9;  // of the longest key: zeros are found to a few ulps of their times
    const auto length_at = [&](double time_s) {
        double squares = 0;
        for (const Track<double>& component : limited.components) squares += std::pow(evaluate(component, time_s), 2);
        return std::sqrt(squares);
    };
    double longest = 0;
    for (const Track<double>& component : limited.components) longest = std::max(longest, largest_key(component));
    std::vector<double> times;
    for (const Track<double>& component : limited.components)
        for (const double time_s : zeros_of(component, window.begin_s, window.end_s))
            if (length_at(time_s) <= kRounding * longest) times.push_back(time_s);
    if (times.empty()) return std::nullopt;
    return in_words(limited, fmt::format("{} passes through zero {}", limited.name, time_text(*std::min_element(times.begin(), times.end()), timing)),
                      "expected a direction at every time; a key to one side of the others leads it round");
}

std::optional<Diagnostic> problem_of_cone(const LimitedTrack& limited, const Window& window, const Timing& timing) {
    constexpr double kRounding = 1e-12;  // of the keys, as above
    const Track<double>&inner = limited.components[0], &outer = limited.components[1];
    const Extreme worst = greatest_difference(inner, outer, window.begin_s, window.end_s);
    if (worst.value <= kRounding * std::max(largest_key(inner), largest_key(outer))) return std::nullopt;
    const auto at = [&](const Track<double>& track) { return in_natural_unit(*limited.spec, evaluate(track, worst.time_s)); };
    const bool differ = six_digits(at(inner)) > six_digits(at(outer));
    const auto text = [&](double value) { return with_unit(*limited.spec, differ ? six_digits(value) : value); };
    return in_words(limited, fmt::format("{} is {} {}, wider than outer at {}", limited.name, text(at(inner)), time_text(worst.time_s, timing), text(at(outer))),
                      "expected inner to be at most outer at every time; both are half-angles");
}

std::optional<Diagnostic> problem_of(const LimitedTrack& limited, const Window& window, const Timing& timing) {
    switch (limited.keep) {
        case Keep::range: return problem_of_range(limited, window, timing);
        case Keep::sign: return problem_of_sign(limited, window, timing);
        case Keep::direction: return problem_of_direction(limited, window, timing);
        case Keep::cone: break;
    }
    return problem_of_cone(limited, window, timing);
}

std::vector<Diagnostic> problems_in(std::span<const LimitedTrack> tracks, const Window& window, const Timing& timing) {
    std::vector<Diagnostic> problems;
    for (const LimitedTrack& limited : tracks)
        if (auto problem = problem_of(limited, window, timing)) problems.push_back(std::move(*problem));
    return problems;
}

bool has_limits(const FieldSpec& spec) { return spec.low > -kInfinity || spec.high < kInfinity; }

void keep(const Field& field, std::vector<Track<double>> components, const FieldSpec& spec, Keep what) {
    field.context->limited_tracks.push_back({field.name, diagnostic_at(field.node->place, {}, {}), &spec, std::move(components), what});
}

void note(const Field& field, std::vector<Track<double>> components, const FieldSpec& spec) {
    if (has_limits(spec) && std::any_of(components.begin(), components.end(), may_leave_keys)) keep(field, std::move(components), spec, Keep::range);
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

void note_scale(const Field& field, const Track<glm::dvec3>& track) {
    if (!track.is_constant() && track.interpolation != Interpolation::step) keep(field, components_of(track), *field.spec, Keep::sign);
}

void note_direction(const Field& field, const Track<glm::dvec3>& track) {
    if (!track.is_constant() && track.interpolation != Interpolation::step) keep(field, components_of(track), *field.spec, Keep::direction);
}

void note_cone(const Field& field, const Track<double>& inner, const Track<double>& outer) { keep(field, {inner, outer}, *field.spec, Keep::cone); }

std::vector<Diagnostic> values_out_of_range(std::span<const LimitedTrack> tracks, const Sequence& sequence, double lead_s) {
    const std::vector<int>& frames = sequence.timing().frames;
    if (tracks.empty() || frames.empty()) return {};
    return problems_in(tracks, window_of(sequence.frame(frames.front()), sequence.frame(frames.back()), lead_s), sequence.timing());
}

std::vector<Diagnostic> values_out_of_range(std::span<const LimitedTrack> tracks, const Timing& timing, const FrameTime& frame, double lead_s) {
    return problems_in(tracks, window_of(frame, frame, lead_s), timing);
}

}  // namespace kadr
