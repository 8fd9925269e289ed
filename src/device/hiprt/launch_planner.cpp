#include "device/hiprt/launch_planner.h"

#include <algorithm>

#include "kernels/gpu/launch_params.h"

namespace kadr {
namespace {

constexpr int kStrip = kernels::kBlockHeight;

}  // namespace

void LaunchBudget::measured(std::int64_t pixel_samples, double seconds) {
    const double wanted = seconds > 0 ? static_cast<double>(pixel_samples) * kTarget_s / seconds
                                      : 4.0 * static_cast<double>(pixel_samples_);
    const double most = 4.0 * static_cast<double>(pixel_samples_);
    pixel_samples_ = static_cast<std::int64_t>(std::clamp(std::min(wanted, most), 1.0, static_cast<double>(kMost)));
}

std::optional<LaunchPiece> LaunchPlanner::next(const LaunchBudget& budget) {
    if (y_ >= pass_.y1) {
        sample_ += samples_;
        x_ = pass_.x0;
        y_ = pass_.y0;
    }
    const int left = pass_.first_sample + pass_.sample_count - sample_;
    const int width = pass_.x1 - pass_.x0, height = pass_.y1 - pass_.y0;
    if (left <= 0 || width <= 0 || height <= 0) return std::nullopt;
    if (x_ == pass_.x0 && y_ == pass_.y0)
        samples_ = static_cast<int>(
            std::clamp<std::int64_t>(budget.pixel_samples() / (std::int64_t{width} * height), 1, left));
    const std::int64_t row = std::int64_t{width} * samples_;
    const std::int64_t rows_within = std::min<std::int64_t>(budget.pixel_samples() / row, pass_.y1 - y_);
    LaunchPiece piece;
    if (x_ == pass_.x0 && rows_within >= std::min(kStrip, pass_.y1 - y_)) {
        // Whole blocks, but at the lower edge.
        piece = rows(y_ + static_cast<int>(rows_within) == pass_.y1 ? static_cast<int>(rows_within)
                                                                    : static_cast<int>(rows_within / kStrip) * kStrip);
    } else {
        const int strip = std::min(kStrip, pass_.y1 - y_);
        const std::int64_t columns = budget.pixel_samples() / (std::int64_t{strip} * samples_) / kernels::kBlockWidth;
        piece =
            part_of_rows(strip, static_cast<int>(std::clamp<std::int64_t>(columns, 1, width)) * kernels::kBlockWidth);
    }
    handed_out_ += piece.pixel_samples();
    return piece;
}

LaunchPiece LaunchPlanner::rows(int count) {
    const LaunchPiece piece{pass_.x0, y_, pass_.x1, y_ + count, sample_, samples_};
    y_ += count;
    return piece;
}

LaunchPiece LaunchPlanner::part_of_rows(int count, int columns) {
    const LaunchPiece piece{x_, y_, std::min(x_ + columns, pass_.x1), y_ + count, sample_, samples_};
    x_ = piece.x1;
    if (x_ == pass_.x1) {
        x_ = pass_.x0;
        y_ += count;
    }
    return piece;
}

double LaunchPlanner::done() const {
    const std::int64_t all = pass_.pixel_samples();
    return all > 0 ? static_cast<double>(handed_out_) / static_cast<double>(all) : 1.0;
}

}  // namespace kadr
