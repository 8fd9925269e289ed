#include "measure/frame_error.h"

#include <cmath>

#include "base/error.h"
#include "output/view.h"

namespace kadr {

namespace {

constexpr double kDark = 0.01;  // of relative_mse (output/image_metrics.h)

/// Visits the colours of four images and of the first two's mean.
template <class Term>
double relative_mean(const Replicates& reference, const Replicates& test, Term term) {
    const Image &r1 = reference.a.image, &r2 = reference.b.image, &a = test.a.image, &b = test.b.image;
    const std::size_t pixels = static_cast<std::size_t>(r1.width) * static_cast<std::size_t>(r1.height);
    const auto value = [](const Image& image, std::size_t pixel, std::size_t c) {
        const float found = image.pixels[pixel * image.channels.size() + c];
        return std::isfinite(found) ? static_cast<double>(found) : 0.0;
    };
    double sum = 0;
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double x = value(r1, i, c), y = value(r2, i, c), mean = 0.5 * (x + y);
            sum += term(x, y, value(a, i, c), value(b, i, c)) / (mean * mean + kDark);
        }
    return sum / (3 * static_cast<double>(pixels));
}

void check_sizes(const Replicates& reference, const Replicates& test) {
    const auto same = [&](const StoredImage& image) { return image.image.width == reference.a.image.width && image.image.height == reference.a.image.height; };
    if (!same(reference.b) || !same(test.a) || !same(test.b)) throw InputError("the images to compare differ in size", "expected the same size");
}

}  // namespace

StoredImage mean_of(const Replicates& images) {
    StoredImage mean = images.a;
    for (std::size_t i = 0; i < mean.image.pixels.size(); ++i) mean.image.pixels[i] = 0.5f * (mean.image.pixels[i] + images.b.image.pixels[i]);
    return mean;
}

double noise_of_mean(const Replicates& reference) {
    return relative_mean(reference, reference, [](double x, double y, double, double) { return 0.25 * (x - y) * (x - y); });
}

FrameError error_of(const Replicates& reference, const Replicates& test, const DifferenceOptions& options) {
    check_sizes(reference, test);
    FrameError error;
    error.noise = relative_mean(reference, test, [](double, double, double a, double b) { return 0.5 * (a - b) * (a - b); });
    error.bias = relative_mean(reference, test, [](double x, double y, double a, double b) { return (a - x) * (b - y); });
    error.relmse = relative_mean(reference, test, [](double x, double y, double a, double b) {
                       const double mean = 0.5 * (x + y);
                       return 0.5 * ((a - mean) * (a - mean) + (b - mean) * (b - mean));
                   }) - noise_of_mean(reference);
    const StoredImage truth = mean_of(reference);
    error.ssim = 0;
    for (const StoredImage* image : {&test.a, &test.b}) {
        const FrameDifference difference = difference_between(truth, *image, options).difference;
        error.flip += 0.5 * difference.flip;
        error.ssim += 0.5 * difference.ssim;
    }
    return error;
}

double flicker(const StoredImage& reference, const StoredImage& next_reference, const StoredImage& test,
               const StoredImage& next_test, const ViewSpec& view) {
    const Image r0 = apply_view(reference.image, view, false), r1 = apply_view(next_reference.image, view, false),
                t0 = apply_view(test.image, view, false), t1 = apply_view(next_test.image, view, false);
    double sum = 0;
    for (std::size_t i = 0; i < r0.pixels.size(); ++i)
        sum += std::abs((static_cast<double>(t1.pixels[i]) - t0.pixels[i]) - (static_cast<double>(r1.pixels[i]) - r0.pixels[i]));
    return sum / static_cast<double>(r0.pixels.size());
}

}  // namespace kadr
