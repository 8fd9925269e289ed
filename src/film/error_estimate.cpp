#include "film/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace kadr {
namespace {

/// The halves of one pixel.
struct Pair {
    Film::Color a, b;
    double n, m;
    double noise(double x, double y) const { return (x - y) * (x - y) * n * m / ((n + m) * (n + m)); }
    double value(double x, double y) const { return (n * x + m * y) / (n + m); }
};

std::optional<Pair> pair_of(const Film& film, int x, int y) {
    const double n = film.divisor(x, y, 0), m = film.divisor(x, y, 1);
    if (!(n > 0) || !(m > 0)) return std::nullopt;
    return Pair{film.mean(x, y, 0), film.mean(x, y, 1), n, m};
}

double relative_error(const Pair& p, double a, double b) {
    const double noise = p.noise(a, b), value = p.value(a, b);
    // Of two values of one sign the noise is at most the square of the mean; filters with negative lobes make others.
    const double square = std::max(value * value - noise / 2, value * value / 2);
    return noise / (square + kRelativeErrorFloor);
}

double luminance(const Film::Color& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

double luminance_noise(const Pair& p) {
    const double noise = p.noise(luminance(p.a), luminance(p.b));
    return std::isfinite(noise) ? noise : std::numeric_limits<double>::infinity();
}

/// Summed anew for each window: a running sum would carry an infinity, or what rounding a bright pixel left, along the
/// row.
double sum_of_row(const std::vector<double>& values, std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += values[i];
    return sum;
}

}  // namespace

ErrorEstimate estimate_error(const Film& film, double scale) {
    ErrorEstimate estimate;
    double sum = 0, squares = 0;
    std::size_t count = 0;
    for (int y = 0; y < film.height(); ++y)
        for (int x = 0; x < film.width(); ++x) {
            const std::optional<Pair> p = pair_of(film, x, y);
            const double error = p ? (relative_error(*p, scale * p->a.r, scale * p->b.r) +
                                      relative_error(*p, scale * p->a.g, scale * p->b.g) +
                                      relative_error(*p, scale * p->a.b, scale * p->b.b)) /
                                         3
                                   : std::numeric_limits<double>::quiet_NaN();
            if (!std::isfinite(error)) {
                ++estimate.unknown_pixels;
                continue;
            }
            sum += error;
            squares += error * error;
            ++count;
        }
    if (count == 0) return estimate;
    const double n = static_cast<double>(count);
    estimate.known = true;
    estimate.relmse = sum / n;
    // Of relative errors, which are of one size and not negative: no cancellation to speak of in double.
    const double variance = std::max(0.0, squares / n - estimate.relmse * estimate.relmse);
    constexpr double kSigmas = 1.96;
    const double spread = kSigmas * std::sqrt(variance / n);
    estimate.relmse_low = std::max(0.0, estimate.relmse - spread);
    estimate.relmse_high = estimate.relmse + spread;
    return estimate;
}

WindowSums window_sums(const std::vector<double>& values, int width, int height, int radius) {
    WindowSums result{std::vector<double>(values.size()), std::vector<int>(values.size())};
    std::vector<double> rows(values.size());
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            rows[at(x, y)] =
                sum_of_row(values, at(std::max(0, x - radius), y), at(std::min(width - 1, x + radius), y) + 1);
    for (int y = 0; y < height; ++y) {
        const int first = std::max(0, y - radius), last = std::min(height - 1, y + radius);
        for (int x = 0; x < width; ++x) {
            for (int row = first; row <= last; ++row) result.sums[at(x, y)] += rows[at(x, row)];
            result.counts[at(x, y)] =
                (last - first + 1) * (std::min(width - 1, x + radius) - std::max(0, x - radius) + 1);
        }
    }
    return result;
}

std::vector<float> standard_errors(const Film& film) {
    constexpr int kRadius = 3;
    std::vector<double> noise, known;
    for (int y = 0; y < film.height(); ++y)
        for (int x = 0; x < film.width(); ++x) {
            const std::optional<Pair> p = pair_of(film, x, y);
            noise.push_back(p ? luminance_noise(*p) : 0);
            known.push_back(p ? 1 : 0);
        }
    const WindowSums sums = window_sums(noise, film.width(), film.height(), kRadius),
                     counts = window_sums(known, film.width(), film.height(), kRadius);
    std::vector<float> errors;
    for (std::size_t i = 0; i < noise.size(); ++i)
        errors.push_back(counts.sums[i] > 0 ? static_cast<float>(std::sqrt(sums.sums[i] / counts.sums[i])) : 0.0f);
    return errors;
}

}  // namespace kadr
