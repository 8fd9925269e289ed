#include "frame/mean_flips.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "frame/decompose.h"

namespace kadr {

namespace {

constexpr double kNothing = 1e-12;   // a weight beside which the rest is everything
constexpr double kSameAngle = 1e-6;  // radians: a jump below it is not seen
constexpr double kTogether = 1e-9;   // of the window: jumps that near are one
constexpr int kLeastSteps = 8, kMostSteps = 128;
constexpr double kStepTurn = std::numbers::pi / 4;
constexpr int kDeepestLook = 6;      // of halving a step that comes near to a flip
constexpr int kMostFlips = 64;       // in a window: more than a shutter can be split for

/// The rotations that are mixed and their sides, at one time.
struct Moment {
    double time_s = 0;
    std::vector<WeightedRotation> mix;  ///< [part], then the property's own; weights may be zero
    MeanSides sides;
};

class FlipSearch {
public:
    FlipSearch(const LayeredTrack<glm::dquat>& track, Layers layers, const LayerWindow& window, double clip_offset_s, std::vector<double>& times)
        : track_(track), layers_(layers), begin_s_(window.begin_s), end_s_(window.end_s), offset_s_(clip_offset_s), times_(times) {}

    void run(int steps) {
        Moment from = at(begin_s_);
        for (int i = 1; i <= steps; ++i) {
            Moment to = at(std::lerp(begin_s_, end_s_, static_cast<double>(i) / steps));
            look(from, to, 0);
            from = std::move(to);
        }
    }

private:
    Moment at(double time_s) const {
        Moment moment{time_s, {}, {}};
        double sum = 0;
        for (const auto& part : track_.parts) {
            const PlayingLayer& layer = layers_[static_cast<std::size_t>(part.layer)];
            moment.mix.push_back({layer.weight_at(time_s), evaluate(*part.track, layer.clip_time(time_s, offset_s_))});
            sum += moment.mix.back().weight;
        }
        moment.mix.push_back({std::max(1 - sum, 0.0), track_.rest});
        moment.sides = mean_sides(moment.mix);
        return moment;
    }

    /// Whether some rotations keep their side and others change it; q and -q, followed from one time to the other, are one.
    static bool flips(const Moment& a, const Moment& b) {
        int kept = 0, changed = 0;
        for (std::size_t i = 0; i < a.mix.size(); ++i) {
            if (a.mix[i].weight <= kNothing || b.mix[i].weight <= kNothing) continue;
            const bool followed = glm::dot(a.mix[i].rotation, b.mix[i].rotation) < 0;
            ++((a.sides.flipped[i] != b.sides.flipped[i]) != followed ? changed : kept);
        }
        return kept > 0 && changed > 0;
    }

    /// Whether a rotation could have been across between the two and come back.
    static bool come_near(const Moment& a, const Moment& b) {
        double moved = angle_between(a.sides.middle, b.sides.middle);
        for (std::size_t i = 0; i < a.mix.size(); ++i)
            if (a.mix[i].weight > kNothing || b.mix[i].weight > kNothing) moved = std::max(moved, angle_between(a.mix[i].rotation, b.mix[i].rotation));
        return std::min(a.sides.margin, b.sides.margin) < 2 * moved;
    }

    void look(const Moment& a, const Moment& b, int depth) {
        const bool across = flips(a, b);
        if (found_ >= kMostFlips || (!across && (depth >= kDeepestLook || !come_near(a, b)))) return;
        const double middle_s = std::midpoint(a.time_s, b.time_s);
        if (!(middle_s > a.time_s && middle_s < b.time_s)) return across ? note(a, b) : void();
        const Moment middle = at(middle_s);
        look(a, middle, depth + 1);
        look(middle, b, depth + 1);
    }

    void note(const Moment& a, const Moment& b) {
        ++found_;
        // Rounding may turn the mean a few places earlier or later than the sides.
        const double around_s = kTogether * (end_s_ - begin_s_);
        const auto mean = [&](double time_s) { return evaluate(track_, layers_, std::clamp(time_s, begin_s_, end_s_), offset_s_); };
        if (angle_between(mean(a.time_s - around_s), mean(b.time_s + around_s)) > kSameAngle) times_.push_back(b.time_s);
    }

    const LayeredTrack<glm::dquat>& track_;
    Layers layers_;
    double begin_s_, end_s_, offset_s_;
    std::vector<double>& times_;
    int found_ = 0;
};

/// Whether the rotations stay within 120 degrees of one another. Then their quaternions can be chosen on one side of each
/// other, the coefficients of the middle are all positive (Perron and Frobenius), and all are on its side too.
bool stay_close(const LayeredTrack<glm::dquat>& track, Layers layers, LayerWindows windows, double clip_offset_s, double turns) {
    const auto jumps = [&](const auto& part) {
        return part.track->interpolation == Interpolation::step || jumps_at_seam(*part.track, layers[static_cast<std::size_t>(part.layer)]);
    };
    return std::none_of(track.parts.begin(), track.parts.end(), jumps) &&
           widest_angle(track, layers, windows[0].begin_s, clip_offset_s) + turns < 2 * std::numbers::pi / 3;
}

}  // namespace

void add_flips(const LayeredTrack<glm::dquat>& track, Layers layers, LayerWindows windows, double clip_offset_s, std::vector<double>& times) {
    double turns = 0;
    for (const auto& part : track.parts) turns += turn_of(*part.track, windows[static_cast<std::size_t>(part.layer)]);
    if (stay_close(track, layers, windows, clip_offset_s, turns)) return;
    const int steps = static_cast<int>(std::clamp<double>(std::ceil(turns / kStepTurn), kLeastSteps, kMostSteps));
    FlipSearch(track, layers, windows[0], clip_offset_s, times).run(steps);
}

}  // namespace kadr
