#include "frame/layered_switch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kadr {

namespace {

constexpr double kSameWeight = 1e-12;  // 1 - 0.7 and 0.3 are equal weights
constexpr int kCurveSteps = 8;         // between two keys of weights, which may follow a curve or an ease
constexpr int kOwn = -1;               // the switch's own state leads

class Lead {
public:
    Lead(const LayeredTrack<double>& track, Layers layers) : track_(track), layers_(layers) {}

    /// The part with the greatest weight.
    int at(double time_s) const {
        double sum = 0, greatest = 0;
        int leader = kOwn;
        for (std::size_t i = 0; i < track_.parts.size(); ++i) {
            const double weight = weight_of(i).weight_at(time_s);
            sum += weight;
            if (!(weight > kSameWeight) || weight < greatest - kSameWeight) continue;
            greatest = weight;
            leader = static_cast<int>(i);
        }
        return 1 - sum > greatest + kSameWeight ? kOwn : leader;
    }

    /// Ends of the pieces between which the weights have no keys, divided further.
    std::vector<double> steps(double begin_s, double end_s) const {
        std::vector<double> corners{begin_s, end_s};
        for (std::size_t i = 0; i < track_.parts.size(); ++i) {
            const std::vector<double> keys = key_times(weight_of(i).weight, begin_s, end_s);
            corners.insert(corners.end(), keys.begin(), keys.end());
        }
        std::sort(corners.begin(), corners.end());
        std::vector<double> steps{begin_s};
        for (std::size_t i = 1; i < corners.size(); ++i)
            for (int step = 1; step <= kCurveSteps; ++step) steps.push_back(std::lerp(corners[i - 1], corners[i], step / static_cast<double>(kCurveSteps)));
        return steps;
    }

private:
    const PlayingLayer& weight_of(std::size_t part) const { return layers_[static_cast<std::size_t>(track_.parts[part].layer)]; }

    const LayeredTrack<double>& track_;
    Layers layers_;
};

bool state_of(const LayeredTrack<double>& track, int leader, bool own, Layers layers, double time_s, double clip_offset_s) {
    if (leader == kOwn) return own;
    const auto& part = track.parts[static_cast<std::size_t>(leader)];
    return evaluate(*part.track, layers[static_cast<std::size_t>(part.layer)].clip_time(time_s, clip_offset_s)) >= 0.5;
}

/// Calls visit(time, leader before, leader from then on) for the changes between two times, as far as halving finds them.
template <class Visit>
void bisect(const Lead& lead, double from_s, int before, double to_s, int after, Visit visit) {
    if (before == after) return;
    const double middle = std::midpoint(from_s, to_s);
    if (!(middle > from_s && middle < to_s)) return visit(to_s, before, after);
    const int between = lead.at(middle);
    bisect(lead, from_s, before, middle, between, visit);
    bisect(lead, middle, between, to_s, after, visit);
}

}  // namespace

bool is_on(const LayeredTrack<double>& track, bool own, Layers layers, double time_s, double clip_offset_s) {
    return state_of(track, Lead(track, layers).at(time_s), own, layers, time_s, clip_offset_s);
}

std::vector<double> handovers(const LayeredTrack<double>& track, bool own, Layers layers, double begin_s, double end_s, double clip_offset_s) {
    std::vector<double> times;
    const Lead lead(track, layers);
    const auto state = [&](int leader, double time_s) { return state_of(track, leader, own, layers, time_s, clip_offset_s); };
    const auto add = [&](double time_s, int before, int after) {
        if (state(before, time_s) != state(after, time_s) && time_s > begin_s && time_s < end_s) times.push_back(time_s);
    };
    double from_s = begin_s;
    int before = lead.at(begin_s);
    for (const double to_s : lead.steps(begin_s, end_s)) {
        const int after = lead.at(to_s);
        bisect(lead, from_s, before, to_s, after, add);
        from_s = to_s, before = after;
    }
    return times;
}

}  // namespace kadr
