#include "frame/layered_track.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "anim/tick.h"
#include "frame/decompose.h"

namespace kadr {

namespace {

constexpr double kNothing = 1e-12;        // a weight beside which the rest is everything
constexpr std::size_t kMostKeys = 512;    // of one property in a window: far more than a motion grid has segments
constexpr double kFloatRounding = 4e-7;   // of a value: a few units in the last place of a file's floats
constexpr double kSameAngle = 1e-6;       // radians, for the same reason
constexpr double kHalfTurn = 3.14159265358979324;
constexpr int kCurveSteps = 8;            // in which a curve between two keys is measured

template <class T>
const PlayingLayer& layer_of(const typename LayeredTrack<T>::Part& part, Layers layers) { return layers[static_cast<std::size_t>(part.layer)]; }

bool curved(Interpolation interpolation) { return interpolation == Interpolation::smooth || interpolation == Interpolation::cubic; }

/// Both ends of an interval, the keys between them, and steps between those where the value runs along a curve.
template <class T>
std::vector<double> corners_of(const Track<T>& track, double begin_s, double end_s) {
    std::vector<double> keys = key_times(track, begin_s, end_s);
    keys.push_back(end_s);
    std::vector<double> times{begin_s};
    for (const double key : keys) {
        const double from = times.back();
        for (int i = 1; curved(track.interpolation) && i < kCurveSteps; ++i) times.push_back(std::lerp(from, key, i / static_cast<double>(kCurveSteps)));
        times.push_back(key);
    }
    return times;
}

std::vector<WeightedRotation> rotations_at(const LayeredTrack<glm::dquat>& track, const glm::dquat& own, Layers layers, double time_s, double clip_offset_s) {
    std::vector<WeightedRotation> rotations;
    double sum = 0;
    for (const auto& part : track.parts) {
        const PlayingLayer& layer = layer_of<glm::dquat>(part, layers);
        const double weight = layer.weight_at(time_s);
        if (!(weight > kNothing)) continue;
        rotations.push_back({weight, evaluate(*part.track, layer.clip_time(time_s, clip_offset_s))});
        sum += weight;
    }
    if (sum < 1 - kNothing || rotations.empty()) rotations.push_back({1 - sum, own});
    return rotations;
}

/// Whether two values are the same but for the rounding of a file's floats.
template <class T>
bool same_value(const T& a, const T& b) {
    if constexpr (kIsRotation<T>) return angle_between(a, b) <= kSameAngle;
    else if constexpr (std::is_floating_point_v<T>) return std::abs(a - b) <= kFloatRounding * std::max(std::abs(a), std::abs(b)) + 1e-9;
    else return glm::length(a - b) <= kFloatRounding * std::max(glm::length(a), glm::length(b)) + 1e-9;
}

/// What the weights do in a window: half of what all of them change after normalisation, added up (1 for a whole
/// cross-fade), and how many values are mixed, the property's own among them.
struct Fading {
    double change = 0;
    std::size_t mixed = 0;
};

/// Weights of the parts and of the property's own value, adding up to 1.
std::vector<double> shares_at(const LayeredTrack<glm::dquat>& track, Layers layers, double time_s, double& sum) {
    std::vector<double> shares;
    sum = 0;
    for (const auto& part : track.parts) sum += shares.emplace_back(layer_of<glm::dquat>(part, layers).weight_at(time_s));
    shares.push_back(std::max(1 - sum, 0.0));
    for (double& share : shares) share /= std::max(sum, 1.0);
    return shares;
}

Fading fading(const LayeredTrack<glm::dquat>& track, Layers layers, LayerWindows windows) {
    std::vector<double> times;
    for (const auto& part : track.parts) {
        const std::vector<double> corners = corners_of(layer_of<glm::dquat>(part, layers).weight, windows[0].begin_s, windows[0].end_s);
        times.insert(times.end(), corners.begin(), corners.end());
    }
    std::sort(times.begin(), times.end());
    double sum_before = 0;
    std::vector<double> before = shares_at(track, layers, times.front(), sum_before);
    std::vector<bool> counts(before.size(), false);
    Fading fading;
    const auto advance = [&](double time) {
        const std::vector<double> now = shares_at(track, layers, time, sum_before);
        for (std::size_t i = 0; i < now.size(); ++i) {
            fading.change += 0.5 * std::abs(now[i] - before[i]);
            if (now[i] + before[i] > 0) counts[i] = true;
        }
        before = now;
    };
    for (std::size_t i = 0; i < times.size(); ++i) {
        double sum = 0;
        shares_at(track, layers, times[i], sum);
        // Where the sum passes 1 the shares bend.
        if (const double old = sum_before; i > 0 && (old - 1) * (sum - 1) < 0) advance(std::lerp(times[i - 1], times[i], (1 - old) / (sum - old)));
        advance(times[i]);
    }
    fading.mixed = static_cast<std::size_t>(std::count(counts.begin(), counts.end(), true));
    return fading;
}

/// Whether the end of a pass is one of the track's keys as well: where a loop turns, and where a held clip stands still
/// although its track would go on.
template <class T>
bool bends_at(const Track<T>& track, const PlayingLayer& layer, double clip_s) {
    return layer.loop != ClipLayer::Loop::hold || (clip_s >= track.keys.front().time_s && clip_s <= track.keys.back().time_s);
}

}  // namespace

template <class T>
T evaluate(const LayeredTrack<T>& track, Layers layers, double time_s, double clip_offset_s) {
    return evaluate(track, track.rest, layers, time_s, clip_offset_s);
}

template <class T>
T evaluate(const LayeredTrack<T>& track, const T& own, Layers layers, double time_s, double clip_offset_s) {
    if (track.parts.empty()) return own;
    if (track.parts.size() == 1)  // the usual case
        if (const PlayingLayer& layer = layer_of<T>(track.parts[0], layers); layer.weight_at(time_s) >= 1)
            return evaluate(*track.parts[0].track, layer.clip_time(time_s, clip_offset_s));
    if constexpr (kIsRotation<T>) {
        return mean_rotation(rotations_at(track, own, layers, time_s, clip_offset_s));
    } else {
        T value{};
        double sum = 0;
        for (const auto& part : track.parts) {
            const PlayingLayer& layer = layer_of<T>(part, layers);
            const double weight = layer.weight_at(time_s);
            if (!(weight > kNothing)) continue;
            value += evaluate(*part.track, layer.clip_time(time_s, clip_offset_s)) * weight;
            sum += weight;
        }
        return sum < 1 ? value + own * (1 - sum) : value / sum;
    }
}

template <class T>
void add_part(LayeredTrack<T>& track, int layer, const Track<T>& source) {
    if (source.keys.empty()) return;
    if (!track.parts.empty() && track.parts.back().layer == layer)
        track.parts.back().track = &source;
    else
        track.parts.push_back({layer, &source});
}

template <class T>
void simplify(LayeredTrack<T>& track, Layers layers) {
    std::erase_if(track.parts, [&](const auto& part) { return !layer_of<T>(part, layers).counts(); });
    const bool constant = std::all_of(track.parts.begin(), track.parts.end(), [&](const auto& part) {
        const PlayingLayer& layer = layer_of<T>(part, layers);
        return layer.weight.is_constant() && !(layer.runs() && varies(*part.track));
    });
    if (!constant) return;
    track.rest = evaluate(track, layers, 0, 0);
    track.parts.clear();
}

template <class T>
void add_key_times(const LayeredTrack<T>& track, LayerWindows windows, std::vector<double>& times) {
    const std::size_t most = times.size() + kMostKeys;
    for (const auto& part : track.parts) {
        const LayerWindow& window = windows[static_cast<std::size_t>(part.layer)];
        if (!window.counts) continue;
        // A key of a loop that lies at an end of the window must not come in by the rounding of its pass.
        const double margin = window.layer->loop == ClipLayer::Loop::hold ? 0 : kTick;
        const auto inside = [&](double time) { return time > window.begin_s + margin && time < window.end_s - margin && times.size() < most; };
        for (const double key : key_times(window.layer->weight, window.begin_s, window.end_s))
            if (inside(key)) times.push_back(key);
        for (const ClipPass& pass : window.passes) {
            for (const double key : key_times(*part.track, pass.low_s(), pass.high_s()))
                if (const double at = pass.shot_time(key); margin > 0 ? inside(at) : times.size() < most) times.push_back(at);
            if (inside(pass.end_s) && bends_at(*part.track, *window.layer, pass.to_s)) times.push_back(pass.end_s);
            if (&pass == &window.passes.front() && inside(pass.begin_s) && bends_at(*part.track, *window.layer, pass.from_s)) times.push_back(pass.begin_s);
        }
    }
}

double turn_of(const Track<glm::dquat>& track, const LayerWindow& window) {
    double turn = 0;
    for (const ClipPass& pass : window.passes) turn += turn_of(track, pass.low_s(), pass.high_s());
    if (window.passes_left_out > 0) turn += window.passes_left_out * turn_of(track, window.layer->in_s, window.layer->out_s);
    return turn;
}

double widest_angle(const LayeredTrack<glm::dquat>& track, Layers layers, double time_s, double clip_offset_s) {
    std::vector<glm::dquat> rotations{track.rest};
    for (const auto& part : track.parts) rotations.push_back(evaluate(*part.track, layer_of<glm::dquat>(part, layers).clip_time(time_s, clip_offset_s)));
    double widest = 0;
    for (std::size_t i = 0; i < rotations.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) widest = std::max(widest, angle_between(rotations[i], rotations[k]));
    return widest;
}

// The mean of two rotations moves by no more than the two move, and by what their weights carry it along the arc between
// them: of a sideways move at one end, a slerp over half an angle w <= pi/2 passes on sin((1-u)w) / sin(w) <= 1. The mean
// of more can be carried farther: twice as far where they lie within 120 degrees of it.
double turn_of(const LayeredTrack<glm::dquat>& track, Layers layers, LayerWindows windows, double clip_offset_s) {
    double turns = 0;
    bool mixed = track.parts.size() > 1;
    for (const auto& part : track.parts) {
        const LayerWindow& window = windows[static_cast<std::size_t>(part.layer)];
        if (window.counts) turns += turn_of(*part.track, window);
        mixed = mixed || !window.layer->weight.is_constant();
    }
    if (!mixed) return turns;
    const Fading fade = fading(track, layers, windows);
    const double share = fade.mixed > 2 ? 2 : 1;
    if (fade.change == 0) return share * turns;
    return share * (turns + fade.change * std::min(widest_angle(track, layers, windows[0].begin_s, clip_offset_s) + turns, kHalfTurn));
}

template <class T>
bool jumps_at_seam(const Track<T>& track, const PlayingLayer& layer) {
    if (layer.loop != ClipLayer::Loop::repeat || !layer.runs()) return false;
    return !same_value(evaluate(track, layer.in_s), evaluate(track, std::nextafter(layer.out_s, layer.in_s)));
}

template <class T>
void add_steps(const Track<T>& track, const LayerWindow& window, std::vector<double>& times) {
    for (const ClipPass& pass : window.passes) {
        // An end of a pass may be a step key itself.
        const double low = std::nextafter(pass.low_s(), -1e300), high = std::nextafter(pass.high_s(), 1e300);
        for (const double key : discontinuities(track, low, high)) times.push_back(pass.shot_time(key));
    }
}

#define KADR_LAYERED_TRACK_OF(T)                                                                        \
    template T evaluate(const LayeredTrack<T>&, Layers, double, double);                                \
    template T evaluate(const LayeredTrack<T>&, const T&, Layers, double, double);                      \
    template void add_part(LayeredTrack<T>&, int, const Track<T>&);                                     \
    template void simplify(LayeredTrack<T>&, Layers);                                                   \
    template void add_key_times(const LayeredTrack<T>&, LayerWindows, std::vector<double>&);            \
    template bool jumps_at_seam(const Track<T>&, const PlayingLayer&);                                  \
    template void add_steps(const Track<T>&, const LayerWindow&, std::vector<double>&);
KADR_LAYERED_TRACK_OF(double)
KADR_LAYERED_TRACK_OF(glm::dvec2)
KADR_LAYERED_TRACK_OF(glm::dvec3)
KADR_LAYERED_TRACK_OF(glm::dquat)
#undef KADR_LAYERED_TRACK_OF

}  // namespace kadr
