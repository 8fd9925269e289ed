#pragma once

#include <cstdint>
#include <optional>

namespace kadr {

/// A part of the work of a pass: pixels [x0, x1) x [y0, y1), samples [first_sample, first_sample + sample_count).
struct LaunchPiece {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int first_sample = 0, sample_count = 0;
    std::int64_t pixel_samples() const { return std::int64_t{x1 - x0} * (y1 - y0) * sample_count; }
    bool operator==(const LaunchPiece&) const = default;
};

/// How many pixel samples a launch takes, learned from launches before: displays and watchdogs want them short.
class LaunchBudget {
public:
    static constexpr double kTarget_s = 0.05;        ///< half of what a launch may take at most
    static constexpr std::int64_t kFirst = 1 << 16;  ///< before anything is known
    static constexpr std::int64_t kMost = std::int64_t{1} << 32;

    std::int64_t pixel_samples() const { return pixel_samples_; }
    /// A launch took so long. Grows by four at most: the next part of the image may be slower.
    void measured(std::int64_t pixel_samples, double seconds);

private:
    std::int64_t pixel_samples_ = kFirst;
};

/// Cuts a pass into launches, each within the budget as it is then; samples of a pixel come in their order. Pieces are
/// whole rows, or parts of a few rows where those are too much.
class LaunchPlanner {
public:
    explicit LaunchPlanner(const LaunchPiece& pass)
        : pass_(pass), x_(pass.x0), y_(pass.y0), sample_(pass.first_sample) {}
    std::optional<LaunchPiece> next(const LaunchBudget& budget);
    double done() const;  ///< share of the pass that was handed out, 0..1

private:
    LaunchPiece rows(int count);
    LaunchPiece part_of_rows(int count, int columns);

    LaunchPiece pass_;
    int x_, y_, sample_;
    int samples_ = 0;  ///< of the pieces until the whole area has them
    std::int64_t handed_out_ = 0;
};

}  // namespace kadr
