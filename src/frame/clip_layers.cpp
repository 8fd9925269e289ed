#include "frame/clip_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anim/tick.h"

namespace kadr {

namespace {

/// Of the numbers that a layer's time at a time of the shot is computed from.
double magnitude_of(const PlayingLayer& layer, double time_s, double offset_s) {
    return std::abs(layer.start_s) + std::abs(layer.speed) * (std::abs(time_s) + std::abs(offset_s) + std::abs(layer.at_s)) + std::abs(layer.in_s) + std::abs(layer.out_s);
}

/// One stretch of clip time, counted from the one that starts at `in`: clip time runs up in it, or down (pingpong).
double time_in_cell(const PlayingLayer& layer, double cell, double unbounded_s) {
    const double length = layer.out_s - layer.in_s;
    const double inside = std::clamp(unbounded_s - layer.in_s - cell * length, 0.0, length);
    const bool down = layer.loop == ClipLayer::Loop::pingpong && std::fmod(cell, 2) != 0;
    return down ? layer.out_s - inside : layer.in_s + inside;
}

/// Whether the weight is above zero at an end of the window or at a key in it; a curve may be so between them.
bool counts_in(const Track<double>& weight, double begin_s, double end_s) {
    if (weight.is_constant()) return evaluate(weight, begin_s) > 0;
    if (evaluate(weight, begin_s) > 0 || evaluate(weight, end_s) > 0) return true;
    const std::vector<double> keys = key_times(weight, begin_s, end_s);
    const bool curved = weight.interpolation == Interpolation::smooth || weight.interpolation == Interpolation::cubic;
    return curved || std::any_of(keys.begin(), keys.end(), [&](double time) { return evaluate(weight, time) > 0; });
}

}  // namespace

double PlayingLayer::weight_at(double time_s) const { return std::max(evaluate(weight, time_s), 0.0); }

double PlayingLayer::clip_time(double time_s, double offset_s) const {
    const double time = unbounded(time_s, offset_s), length = out_s - in_s;
    if (loop == ClipLayer::Loop::hold || !(length > 0)) return std::clamp(time, in_s, out_s);
    const double magnitude = magnitude_of(*this, time_s, offset_s);
    // By ticks, so that the same time of a later pass is the same to the last bit; glTF's keys are single floats and lie on them.
    const auto into_pass = [&](double seconds, double period) { return std::nearbyint(wrapped(seconds, period, magnitude) / kTick) * kTick; };
    if (loop == ClipLayer::Loop::repeat) return speed < 0 ? out_s - into_pass(out_s - time, length) : in_s + into_pass(time - in_s, length);
    const double phase = into_pass(time - in_s, 2 * length);
    return phase <= length ? in_s + phase : std::max(out_s - (phase - length), in_s);
}

double PlayingLayer::end_s() const {
    if (!runs() || !counts()) return 0;
    const double pass_s = (out_s - in_s) / std::abs(speed);
    if (loop == ClipLayer::Loop::repeat) return at_s + pass_s;
    if (loop == ClipLayer::Loop::pingpong) return at_s + 2 * pass_s;
    return at_s + (speed > 0 ? (out_s - start_s) / speed : (start_s - in_s) / -speed);
}

PlayingLayer make_layer(const ClipLayer& layer, std::vector<int> clips, const Scene& scene) {
    double begin = 0, end = 0;
    for (const int clip : clips) {
        begin = std::min(begin, scene.clips[static_cast<std::size_t>(clip)].begin_s);
        end = std::max(end, scene.clips[static_cast<std::size_t>(clip)].end_s);
    }
    PlayingLayer playing{std::move(clips), layer.at_s, 0, layer.speed, layer.in_s.value_or(begin), layer.out_s.value_or(end), layer.loop, layer.weight};
    playing.out_s = std::max(playing.out_s, playing.in_s);
    playing.start_s = layer.start_s.value_or(layer.speed < 0 ? playing.out_s : layer.in_s.value_or(0));
    return playing;
}

LayerWindow window_of(const PlayingLayer& layer, double begin_s, double end_s, double offset_s) {
    LayerWindow window{&layer, begin_s, end_s, counts_in(layer.weight, begin_s, end_s), {}, 0};
    if (!window.counts || !layer.runs() || !(end_s > begin_s)) return window;
    const double length = layer.out_s - layer.in_s;
    const double from = layer.unbounded(begin_s, offset_s), to = layer.unbounded(end_s, offset_s);
    const double step = to > from ? 1 : -1;
    // What a seam at an end of the window leaves beyond it by rounding is no pass.
    const double sliver = 1024 * std::numeric_limits<double>::epsilon() * std::max(magnitude_of(layer, begin_s, offset_s), magnitude_of(layer, end_s, offset_s));
    double first = std::floor((std::min(from, to) - layer.in_s) / length), last = std::floor((std::max(from, to) - layer.in_s) / length);
    if (layer.loop == ClipLayer::Loop::hold) {
        if (last < 0 || first > 0) return window;
        first = last = 0;
    }
    window.passes_left_out = std::max(last - first + 1 - kMostPasses, 0.0);
    double cell = step > 0 ? first : last;
    for (int i = 0; cell >= first && cell <= last && i < kMostPasses; ++i, cell += step) {
        const double bottom = layer.in_s + cell * length, top = layer.in_s + (cell + 1) * length;
        const double enter = std::clamp(from, bottom, top), leave = std::clamp(to, bottom, top);
        if (!(std::abs(leave - enter) > sliver)) continue;
        const auto shot_time = [&](double clip_s) { return begin_s + (clip_s - from) / (to - from) * (end_s - begin_s); };
        window.passes.push_back({shot_time(enter), shot_time(leave), time_in_cell(layer, cell, enter), time_in_cell(layer, cell, leave)});
    }
    return window;
}

std::vector<LayerWindow> windows_of(std::span<const PlayingLayer> layers, double begin_s, double end_s, double offset_s) {
    std::vector<LayerWindow> windows;
    windows.reserve(layers.size());
    for (const PlayingLayer& layer : layers) windows.push_back(window_of(layer, begin_s, end_s, offset_s));
    return windows;
}

std::vector<double> seams_of(const LayerWindow& window) {
    std::vector<double> times;
    if (window.layer->loop == ClipLayer::Loop::hold) return times;
    for (std::size_t i = 1; i < window.passes.size(); ++i) times.push_back(window.passes[i].begin_s);
    return times;
}

}  // namespace kadr
