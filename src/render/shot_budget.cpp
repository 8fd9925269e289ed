#include "render/shot_budget.h"

#include <algorithm>
#include <utility>

namespace kadr {

ShotBudget::ShotBudget(std::optional<double> seconds, std::function<double()> clock, std::size_t devices)
    : seconds_(seconds), clock_(std::move(clock)), devices_(static_cast<double>(devices)) {}

std::function<double(double)> ShotBudget::dealer(int frames_left, std::size_t device) {
    if (!seconds_) return {};
    const std::lock_guard lock(*mutex_);
    until_s_.erase(device);
    return [this, frames_left, device, begin_s = clock_()](double difficulty) {
        return deal(difficulty, frames_left, device, begin_s);
    };
}

double ShotBudget::deal(double difficulty, int frames_left, std::size_t device, double begin_s) {
    const std::lock_guard lock(*mutex_);
    difficulty_sum_ += difficulty;
    const double mean = difficulty_sum_ / ++frames_, total = difficulty + frames_left * mean;
    const double remaining = std::max(0.0, *seconds_ - begin_s);
    double free = devices_ * remaining;
    for (const auto& [other, until_s] : until_s_)
        if (other != device) free -= std::clamp(until_s - begin_s, 0.0, remaining);
    // Nothing is noisy (or nothing is known yet): equal shares. No frame can have more than there is on one device.
    const double share = std::min(remaining, free * (total > 0 ? difficulty / total : 1.0 / (frames_left + 1)));
    until_s_[device] = begin_s + share;
    return share;
}

}  // namespace kadr
