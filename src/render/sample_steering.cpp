#include "render/sample_steering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "output/view.h"

namespace kadr {
namespace {

constexpr int kWindowRadius = 3;
// As fast as errors fall with the samples: what leads to a target is rather too few than too many.
constexpr double kMostPower = 2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Rows of one half as a picture: linear R, G, B, A.
Image half_of(const Film& film, int half, int y0, int y1, double scale) {
    Image image{film.width(), y1 - y0, {"R", "G", "B", "A"}, {}};
    image.pixels.reserve(4 * static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(y1 - y0));
    for (int y = y0; y < y1; ++y)
        for (int x = 0; x < film.width(); ++x) {
            const double n = film.divisor(x, y, half);
            const Film::Color color = n > 0 ? film.mean(x, y, half) : Film::Color{0, 0, 0};
            const auto alpha = static_cast<float>(n > 0 ? film.beauty(x, y, half).alpha / n : 0);
            for (const float value : {color.r, color.g, color.b})
                image.pixels.push_back(static_cast<float>(scale) * value);
            image.pixels.push_back(alpha);
        }
    return image;
}

bool is_finite(const Film::Color& color) {
    return std::isfinite(color.r) && std::isfinite(color.g) && std::isfinite(color.b);
}

/// 1, 2, 3, 4, 6, 8, 12, 16, ...: the next after n.
int after_in_ladder(int n) {
    int power = 1;
    while (power * 2 <= n) power *= 2;
    return n < power + power / 2 ? power + power / 2 : 2 * power;
}

}  // namespace

const char* name_of(SamplingStop stop) {
    constexpr const char* kNames[] = {"samples", "max_error", "at_most", "time_budget"};
    return kNames[static_cast<std::size_t>(stop)];
}

namespace {

/// display_noise of rows [y0, y1).
std::vector<double> noise_of_rows(const Film& film, int y0, int y1, const ViewSpec& view, double scale) {
    const Image a = apply_view(half_of(film, 0, y0, y1, scale), view, false),
                b = apply_view(half_of(film, 1, y0, y1, scale), view, false);
    std::vector<double> noise;
    noise.reserve(a.pixels.size() / 3);
    std::size_t i = 0;
    for (int y = y0; y < y1; ++y)
        for (int x = 0; x < film.width(); ++x, i += 3) {
            const double n = film.divisor(x, y, 0), m = film.divisor(x, y, 1);
            double squares = 0;
            for (std::size_t c = 0; c < 3; ++c)
                squares += (static_cast<double>(a.pixels[i + c]) - b.pixels[i + c]) *
                           (static_cast<double>(a.pixels[i + c]) - b.pixels[i + c]);
            const double error = squares / 3 * n * m / ((n + m) * (n + m));
            // The view shows NaN as black, which would look calm.
            const bool known = n > 0 && m > 0 && is_finite(film.mean(x, y, 0)) && is_finite(film.mean(x, y, 1));
            noise.push_back(known ? error : kInfinity);
        }
    return noise;
}

/// Calls `visit` with the noise of a few rows after the other.
template <class Visit>
void for_noise(const Film& film, const ViewSpec& view, double scale, Visit visit) {
    for (int y = 0; y < film.height(); y += kNoiseRows) visit(noise_of_rows(film, y, std::min(film.height(), y + kNoiseRows), view, scale));
}

}  // namespace

std::vector<double> display_noise(const Film& film, const ViewSpec& view, double scale) {
    std::vector<double> all;
    all.reserve(static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height()));
    for_noise(film, view, scale, [&](const std::vector<double>& rows) { all.insert(all.end(), rows.begin(), rows.end()); });
    return all;
}

SamplingReport report_sampling(const Film& film, SamplingStop stopped_by, const ViewSpec& view, double scale) {
    SamplingReport report;
    report.stopped_by = stopped_by;
    report.error = estimate_error(film, scale);
    report.least = std::numeric_limits<std::uint32_t>::max();
    for (int y = 0; y < film.height(); ++y)
        for (int x = 0; x < film.width(); ++x) {
            const std::uint32_t n = film.samples_of_both(x, y);
            report.least = std::min(report.least, n);
            report.most = std::max(report.most, n);
            report.mean += n;
        }
    const double pixels = static_cast<double>(film.width()) * film.height();
    report.mean /= pixels;
    if (!report.error.known) return report;
    double sum = 0;
    std::size_t count = 0;
    for_noise(film, view, scale, [&](const std::vector<double>& rows) {
        for (const double noise : rows)
            if (std::isfinite(noise)) sum += noise, ++count;
    });
    report.display_error = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : kInfinity;
    return report;
}

SampleSteering::SampleSteering(const RenderSpec& render, double budget_s, ViewSpec view, double scale,
                               std::function<double()> clock)
    : render_(render), budget_s_(budget_s), view_(std::move(view)), scale_(scale), clock_(std::move(clock)) {}

int SampleSteering::stop(SamplingStop reason) {
    stop_ = reason;
    return 0;
}

int SampleSteering::ladder_step() const {
    const bool timed = std::isfinite(budget_s_) || target_relmse_ > 0;
    if (!render_.max_error && !timed) return render_.samples - so_far_;
    const int begin = timed ? std::min(kTimingRound, render_.at_least) : render_.at_least;
    int next = so_far_ == 0 ? begin : after_in_ladder(so_far_);
    if (so_far_ > 0 && so_far_ < render_.at_least) next = std::min(next, render_.at_least);
    next += next % 2;  // halves stay equal
    return std::min(next, render_.samples) - so_far_;
}

/// @return whether a pixel goes on
bool SampleSteering::update_active(const Film& film) {
    const int width = film.width(), height = film.height();
    // Of one sample: neighbours that stopped earlier know as much about this pixel as those that go on.
    std::vector<double> noise = display_noise(film, view_, scale_);
    std::size_t pixel = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) noise[pixel++] *= film.samples_of_both(x, y);
    const WindowSums window = window_sums(noise, width, height, kWindowRadius);
    if (active_.empty()) active_.assign(noise.size(), 1);
    const double limit = *render_.max_error * *render_.max_error * so_far_;
    active_count_ = 0;
    for (std::size_t i = 0; i < noise.size(); ++i) {
        const int others = window.counts[i] - 1;
        // A picture of one pixel has no neighbours.
        const double error = others > 0 ? (window.sums[i] - noise[i]) / others : noise[i];
        // Not finite (a sum overflowed; infinity less infinity): goes on.
        if (active_[i] != 0 && error <= limit) active_[i] = 0;
        active_count_ += active_[i];
    }
    return active_count_ > 0;
}

/// Samples a pixel that the time left pays for, even.
int SampleSteering::affordable(const Film& film) const {
    if (!std::isfinite(budget_s_) || pixel_samples_ <= 0) return std::numeric_limits<int>::max();
    const double now = clock_();
    const double per_pixel_sample_s = (now - rounds_begin_s_) / pixel_samples_;
    const double pixels =
        active_.empty() ? static_cast<double>(film.width()) * film.height() : static_cast<double>(active_count_);
    const double samples = std::max(0.0, budget_s_ - now) / std::max(per_pixel_sample_s * pixels, 1e-12);
    return 2 * static_cast<int>(std::min(samples / 2, 1e8));
}

/// Samples a pixel to the target, as the last two rounds tell; 0 where the next ones would lead farther away from it.
/// Absent: without a target, or nothing is known.
std::optional<int> SampleSteering::until_target(const Film& film) {
    if (!(target_relmse_ > 0) || so_far_ == 0) return std::nullopt;
    const double relmse = mean_relative_error(film, scale_);
    // Calm so far: the fewest samples that a shot asks for may have missed what there is.
    if (!(relmse > 0)) return so_far_ >= render_.at_least ? std::optional<int>(0) : std::nullopt;
    before_ = std::exchange(last_, FrameForecast::Point{static_cast<double>(so_far_), relmse});
    const double power = before_ ? convergence_between(*before_, *last_) : kMostPower;
    const double samples = so_far_ * std::pow(relmse / target_relmse_, 1 / power);
    return static_cast<int>(std::clamp(samples - so_far_ + 0.5, 0.0, 1e8));
}

int SampleSteering::next_round(const Film& film) {
    const bool steered = render_.max_error || std::isfinite(budget_s_) || target_relmse_ > 0;
    if (so_far_ == 0) rounds_begin_s_ = clock_();
    if (so_far_ >= render_.samples) return stop(steered ? SamplingStop::at_most : SamplingStop::samples);
    if (render_.max_error && so_far_ >= render_.at_least && !update_active(film)) return stop(SamplingStop::max_error);
    const std::optional<int> to_target = until_target(film);
    if (to_target == 0) return stop(SamplingStop::time_budget);
    const int affordable_count = affordable(film), step = std::min(ladder_step(), to_target.value_or(std::numeric_limits<int>::max()));
    if (affordable_count < 1 || (so_far_ > 0 && affordable_count < 2)) return stop(SamplingStop::time_budget);
    const int count = std::min(step, affordable_count);
    so_far_ += count;
    pixel_samples_ += count * (active_.empty() ? static_cast<double>(film.width()) * film.height()
                                               : static_cast<double>(active_count_));
    return count;
}

}  // namespace kadr
