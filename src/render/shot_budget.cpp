#include "render/shot_budget.h"

#include <algorithm>
#include <utility>

namespace kadr {

ShotBudget::ShotBudget(std::optional<double> seconds, std::function<double()> clock)
    : seconds_(seconds), clock_(std::move(clock)) {}

std::function<double(double)> ShotBudget::dealer(int frames_left) {
    if (!seconds_) return {};
    return [this, frames_left, begin_s = clock_()](double difficulty) {
        difficulty_sum_ += difficulty;
        const double mean = difficulty_sum_ / ++frames_, total = difficulty + frames_left * mean;
        const double remaining = std::max(0.0, *seconds_ - begin_s);
        // Nothing is noisy (or nothing is known yet): equal shares.
        return remaining * (total > 0 ? difficulty / total : 1.0 / (frames_left + 1));
    };
}

}  // namespace kadr
