#include "film/error_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
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

using Rgb = std::array<double, 3>;

Rgb rgb(const Film::Color& color, double scale) { return {scale * color.r, scale * color.g, scale * color.b}; }

/// What a pixel's halves say: its value, the mean square error of that, and the square of the darker half.
struct PixelNoise {
    bool known = false;
    Rgb value{}, noise{}, darker{};
    double noise_sum() const { return noise[0] + noise[1] + noise[2]; }
};

PixelNoise noise_of(const Film& film, int x, int y, double scale) {
    const std::optional<Pair> p = pair_of(film, x, y);
    PixelNoise pixel;
    if (!p) return pixel;
    const Rgb a = rgb(p->a, scale), b = rgb(p->b, scale);
    for (std::size_t c = 0; c < 3; ++c) {
        pixel.value[c] = p->value(a[c], b[c]), pixel.noise[c] = p->noise(a[c], b[c]);
        pixel.darker[c] = a[c] * b[c] > 0 ? std::min(a[c] * a[c], b[c] * b[c]) : 0;
    }
    pixel.known = std::isfinite(pixel.noise_sum()) && std::isfinite(pixel.value[0] + pixel.value[1] + pixel.value[2]);
    return pixel;
}

constexpr int kAround = 2;  // pixels to each side that a pixel is compared with

/// The pixels of the rows around the one at hand: of a large picture all would take more memory than its film.
class NoiseRows {
public:
    NoiseRows(const Film& film, double scale) : film_(film), scale_(scale) {}
    /// Rows y - kAround to y + kAround, as far as the picture goes; ascending.
    void move_to(int y) {
        for (; next_ <= std::min(film_.height() - 1, y + kAround); ++next_) {
            std::vector<PixelNoise>& row = rows_[slot(next_)];
            row.clear();
            for (int x = 0; x < film_.width(); ++x) row.push_back(noise_of(film_, x, next_, scale_));
        }
    }
    int width() const { return film_.width(); }
    int height() const { return film_.height(); }
    const PixelNoise& at(int x, int y) const { return rows_[slot(y)][static_cast<std::size_t>(x)]; }

private:
    static std::size_t slot(int y) { return static_cast<std::size_t>(y) % (2 * kAround + 1); }
    const Film& film_;
    double scale_;
    int next_ = 0;
    std::array<std::vector<PixelNoise>, 2 * kAround + 1> rows_;
};

/// Mean over R, G, B of the noise over the square of a value that is the truth.
double relative_error(const PixelNoise& pixel, const Rgb& square) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += pixel.noise[c] / (square[c] + kRelativeErrorFloor);
    return sum / 3;
}

/// The pixel's own value, squared.
Rgb own_square(const PixelNoise& pixel) {
    Rgb square;
    // Of two values of one sign the noise is at most the square of the mean; filters with negative lobes make others.
    for (std::size_t c = 0; c < 3; ++c) {
        const double value = pixel.value[c] * pixel.value[c];
        square[c] = std::max(value - pixel.noise[c] / 2, value / 2);
    }
    return square;
}

/// The value of the pixels around that differ from this one by no more than twice the noise of both, squared; the
/// pixel's own where there are fewer than five.  Source: Rousselle et al., "Adaptive Rendering with Non-Local Means
/// Filtering", 2012, section 4 (the distance), with equal weights.
Rgb square_around(const NoiseRows& pixels, int x, int y) {
    constexpr int kLeast = 5;
    constexpr double kDeviations2 = 4;
    const PixelNoise& own = pixels.at(x, y);
    Rgb sum{};
    int count = 0;
    for (int j = std::max(0, y - kAround); j <= std::min(pixels.height() - 1, y + kAround); ++j)
        for (int i = std::max(0, x - kAround); i <= std::min(pixels.width() - 1, x + kAround); ++i) {
            const PixelNoise& other = pixels.at(i, j);
            if (!other.known || (i == x && j == y)) continue;
            double distance = 0;
            for (std::size_t c = 0; c < 3; ++c) distance += (own.value[c] - other.value[c]) * (own.value[c] - other.value[c]);
            if (distance > kDeviations2 * (own.noise_sum() + other.noise_sum())) continue;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += other.value[c];
            ++count;
        }
    Rgb square;
    for (std::size_t c = 0; c < 3; ++c) {
        const double value = count < kLeast ? (sum[c] + own.value[c]) / (count + 1) : sum[c] / count;
        square[c] = std::max(value * value, own.darker[c]);
    }
    return square;
}

/// A mean over pixels and how far it strays.
struct MeanOfPixels {
    double sum = 0, squares = 0;
    std::size_t count = 0;
    void add(double value) { sum += value, squares += value * value, ++count; }
    double mean() const { return sum / static_cast<double>(count); }
    /// Standard error. The terms are of one size and not negative: no cancellation to speak of in double.
    double spread() const { return std::sqrt(std::max(0.0, squares / static_cast<double>(count) - mean() * mean()) / static_cast<double>(count)); }
};

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
    NoiseRows pixels(film, scale);
    MeanOfPixels own, around;
    for (int y = 0; y < film.height(); ++y) {
        pixels.move_to(y);
        for (int x = 0; x < film.width(); ++x) {
            const PixelNoise& pixel = pixels.at(x, y);
            if (!pixel.known) {
                ++estimate.unknown_pixels;
                continue;
            }
            own.add(relative_error(pixel, own_square(pixel)));
            around.add(pixel.noise_sum() > 0 ? relative_error(pixel, square_around(pixels, x, y)) : 0);
        }
    }
    if (own.count == 0) return estimate;
    estimate.known = true;
    estimate.relmse = own.mean();
    // 95 of 100 of a normal distribution, of the difference of two means of one spread: the estimate and the truth.
    constexpr double kSigmas = 1.96 * std::numbers::sqrt2;
    estimate.relmse_low = std::max(0.0, own.mean() - kSigmas * own.spread());
    estimate.relmse_high = std::max(own.mean() + kSigmas * own.spread(), around.mean() + kSigmas * around.spread());
    return estimate;
}

double mean_relative_error(const Film& film, double scale) {
    MeanOfPixels own;
    for (int y = 0; y < film.height(); ++y)
        for (int x = 0; x < film.width(); ++x)
            if (const PixelNoise pixel = noise_of(film, x, y, scale); pixel.known) own.add(relative_error(pixel, own_square(pixel)));
    return own.count > 0 ? own.mean() : 0;
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

void StandardErrors::sum_row(int y) {
    const auto width = static_cast<std::size_t>(film_.width());
    std::vector<double> noise, known;
    for (int x = 0; x < film_.width(); ++x) {
        const std::optional<Pair> p = pair_of(film_, x, y);
        noise.push_back(p ? luminance_noise(*p) : 0);
        known.push_back(p ? 1 : 0);
    }
    Row& row = rows_[static_cast<std::size_t>(y) % kRows];
    row = {};
    for (std::size_t x = 0; x < width; ++x) {
        const std::size_t begin = x - std::min<std::size_t>(x, kRadius), end = std::min(width, x + kRadius + 1);
        row.noise.push_back(sum_of_row(noise, begin, end));
        row.known.push_back(sum_of_row(known, begin, end));
    }
}

void StandardErrors::move_to(int y) {
    for (; next_ <= std::min(film_.height() - 1, y + kRadius); ++next_) sum_row(next_);
    errors_.clear();
    for (std::size_t x = 0; x < static_cast<std::size_t>(film_.width()); ++x) {
        double noise = 0, known = 0;
        for (int row = std::max(0, y - kRadius); row <= std::min(film_.height() - 1, y + kRadius); ++row) {
            noise += rows_[static_cast<std::size_t>(row) % kRows].noise[x];
            known += rows_[static_cast<std::size_t>(row) % kRows].known[x];
        }
        errors_.push_back(known > 0 ? static_cast<float>(std::sqrt(noise / known)) : 0.0f);
    }
}

std::vector<float> standard_errors(const Film& film) {
    StandardErrors rows(film);
    std::vector<float> errors;
    for (int y = 0; y < film.height(); ++y) {
        rows.move_to(y);
        for (int x = 0; x < film.width(); ++x) errors.push_back(rows.at(x));
    }
    return errors;
}

}  // namespace kadr
