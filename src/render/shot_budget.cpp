#include "render/shot_budget.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace kadr {
namespace {

constexpr double kLate = 0.045;  // of the budget: what the last frames may take more, so that they end like the others
constexpr double kLonger = 1.5;  // than its forecast: a frame that is not cut off yet
constexpr double kFollow = 0.5;  // of the way to what the forecasts say now, a frame: they waver
constexpr std::size_t kTrusted = 9;  // frames that say how true forecasts are

// Relative mean square errors, evenly spaced by logarithms: from below a display's last bit to beyond any picture.
constexpr double kLeastRelmse = 1e-9, kMostRelmse = 1e3;
constexpr std::size_t kErrors = 161;

double error_of(double index) { return kLeastRelmse * std::pow(kMostRelmse / kLeastRelmse, index / (kErrors - 1)); }
double index_of(double relmse) {
    return std::clamp(std::log(relmse / kLeastRelmse) / std::log(kMostRelmse / kLeastRelmse), 0.0, 1.0) * (kErrors - 1);
}

double squared(double x) { return x * x; }

/// Of the values and two that say what was thought before: one frame or two prove nothing.
double doubtful_median(std::vector<double> values, double before) {
    values.insert(values.end(), {before, before});
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The least error that the time is enough for. @param seconds_for  of an error, the longer the smaller that is
template <class Seconds>
double affordable_relmse(double seconds, const Seconds& seconds_for) {
    double low = 0, high = kErrors - 1;
    for (int i = 0; i < 24; ++i) {
        const double middle = (low + high) / 2;
        (seconds_for(error_of(middle)) <= seconds ? high : low) = middle;
    }
    return error_of(high);
}

}  // namespace

ShotBudget::ShotBudget(std::optional<double> seconds, std::function<double()> clock, std::size_t devices)
    : seconds_(seconds), clock_(std::move(clock)), devices_(static_cast<double>(devices)) {}

double ShotBudget::remaining_s() const {
    return seconds_ ? std::max(0.0, *seconds_ - clock_()) : std::numeric_limits<double>::infinity();
}

void ShotBudget::plan(std::vector<PlannedFrame> frames) {
    frames_ = std::move(frames);
    known_.clear();
    for (std::size_t i = 0; i < frames_.size(); ++i)
        if (frames_[i].forecast && !frames_[i].free) known_.push_back(i);
    if (known_.empty()) return;
    from_here_.assign(frames_.size() + 1, std::vector<double>(kErrors, 0.0));
    for (std::size_t i = frames_.size(); i-- > 0;)
        for (std::size_t e = 0; e < kErrors; ++e)
            from_here_[i][e] =
                from_here_[i + 1][e] + (frames_[i].free ? 0 : pilot_s(i, error_of(static_cast<double>(e))));
}

double ShotBudget::pilot_s(std::size_t frame, double relmse) const {
    const auto after = std::lower_bound(known_.begin(), known_.end(), frame);
    const std::size_t right = after == known_.end() ? known_.back() : *after;
    const std::size_t left = right <= frame || after == known_.begin() ? right : *(after - 1);
    const double at = right > left ? static_cast<double>(frame - left) / static_cast<double>(right - left) : 0;
    const auto seconds_of = [&](std::size_t known) {
        return std::max(frames_[known].forecast->seconds_for(relmse), 1e-6);
    };
    const double a = seconds_of(left), b = seconds_of(right);
    return a * std::pow(b / a, at);  // difficulties differ by factors
}

double ShotBudget::forecast_s(std::size_t first, double relmse) const {
    const double index = index_of(relmse);
    const auto below = std::min(static_cast<std::size_t>(index), kErrors - 2);
    const std::vector<double>& seconds = from_here_[first];
    return trust_ * (seconds[below] + (index - static_cast<double>(below)) * (seconds[below + 1] - seconds[below]));
}

double ShotBudget::drifting_s(std::size_t first, double relmse, double most) const {
    double sum = 0, drift = 1;
    for (; first < frames_.size() && drift < most; ++first, drift *= kDrift)
        sum += forecast_s(first, relmse * squared(drift)) - forecast_s(first + 1, relmse * squared(drift));
    return sum + forecast_s(first, relmse * squared(most));
}

double ShotBudget::device_s(double now_s) const {
    const double remaining = std::max(0.0, *seconds_ - now_s);
    double free = devices_ * remaining;
    for (const auto& [device, busy] : under_way_) free -= std::clamp(busy.until_s - now_s, 0.0, remaining);
    return free;
}

/// The error of the nearest frame that is there, before it if there is one.
std::optional<double> ShotBudget::reached_beside(std::size_t frame) const {
    const auto known = [](const PlannedFrame& each) { return each.reached > 0; };
    const auto here = frames_.begin() + static_cast<std::ptrdiff_t>(frame);
    if (const auto before = std::find_if(std::make_reverse_iterator(here), frames_.rend(), known); before != frames_.rend()) return before->reached;
    if (const auto after = std::find_if(here, frames_.end(), known); after != frames_.end()) return after->reached;
    return std::nullopt;
}

FrameTarget ShotBudget::equal_share(std::size_t first, double now_s) const {
    std::size_t left = 0;
    for (std::size_t i = first; i < frames_.size(); ++i) left += !frames_[i].free;
    const double remaining = std::max(0.0, *seconds_ - now_s);
    return {0, std::min(remaining, device_s(now_s) / static_cast<double>(std::max<std::size_t>(left, 1))), {}};
}

std::optional<FrameTarget> ShotBudget::begin(int number, std::size_t device) {
    if (!limited()) return std::nullopt;
    const std::lock_guard lock(*mutex_);
    const double now_s = clock_();
    under_way_.erase(device);
    const auto frame = static_cast<std::size_t>(
        std::find_if(frames_.begin(), frames_.end(), [&](const PlannedFrame& each) { return each.number == number; }) -
        frames_.begin());
    if (known_.empty() || frame >= frames_.size()) {
        const FrameTarget share = equal_share(frame, now_s);
        under_way_[device] = {frame, now_s, now_s + share.most_s};
        return share;
    }
    const double left = device_s(now_s), at_the_latest = left + devices_ * kLate * *seconds_;
    if (!target_) target_ = reached_beside(frame);
    const bool first = !target_;
    double relmse = affordable_relmse(left, [&](double each) { return forecast_s(frame, each); });
    if (target_) {
        relmse = *target_ * std::clamp(std::pow(relmse / *target_, kFollow), 1 / squared(kDrift), squared(kDrift));
        // The finest that the frames to come can still make up for.
        relmse = std::max(
            relmse, affordable_relmse(at_the_latest, [&](double each) { return drifting_s(frame, each, kMostDrift); }));
    }
    FrameTarget target = target_of(frame, device, relmse, left, now_s);
    if (first)
        target.revise = [this, device, left](double seconds, double reached) {
            return revised(device, left, seconds, reached);
        };
    return target;
}

/// @param left_s  of all devices, when the frame began
FrameTarget ShotBudget::target_of(std::size_t frame, std::size_t device, double relmse, double left_s, double now_s) {
    target_ = relmse;
    under_way_[device] = {frame, now_s, now_s + forecast_s(frame, relmse) - forecast_s(frame + 1, relmse)};
    const double late = kLate * *seconds_;
    // On one device no frame can have more than there is.
    return {relmse, std::min(longest_s(frame, relmse, left_s + devices_ * late), std::max(0.0, *seconds_ - now_s) + late), {}};
}

FrameTarget ShotBudget::revised(std::size_t device, double left_s, double seconds, double relmse) {
    const std::lock_guard lock(*mutex_);
    const UnderWay own = under_way_.at(device);
    doubt_ = trust_ = seconds / std::max(pilot_s(own.frame, std::clamp(relmse, kLeastRelmse, kMostRelmse)), 1e-6);
    const double target = affordable_relmse(left_s, [&](double each) { return forecast_s(own.frame, each); });
    return target_of(own.frame, device, target, left_s, own.begin_s);
}

/// What a frame may take: half as much again as its forecast says where the frames to come can make up for it at all, and
/// more where that is easy for them.
double ShotBudget::longest_s(std::size_t frame, double relmse, double at_the_latest) const {
    const double own = forecast_s(frame, relmse) - forecast_s(frame + 1, relmse), next = relmse * squared(kDrift);
    const double at_ease = at_the_latest - drifting_s(frame + 1, next, kMostForOne),
                 at_most = at_the_latest - drifting_s(frame + 1, next, kMostDrift);
    return std::max({at_ease, std::min(at_most, kLonger * own), 0.0});
}

void ShotBudget::end(double relmse, std::size_t device) {
    if (!limited()) return;
    const std::lock_guard lock(*mutex_);
    const auto found = under_way_.find(device);
    if (found == under_way_.end()) return;
    const UnderWay done = found->second;
    under_way_.erase(found);
    if (known_.empty() || done.frame >= frames_.size() || !frames_[done.frame].forecast) return;
    // With what it reached, not what it was to reach: where the two differ, it was not the forecast that erred.
    taken_.push_back((clock_() - done.begin_s) /
                     std::max(pilot_s(done.frame, std::clamp(relmse, kLeastRelmse, kMostRelmse)), 1e-6));
    if (taken_.size() > kTrusted) taken_.erase(taken_.begin());
    trust_ = doubtful_median(taken_, doubt_);
}

}  // namespace kadr
