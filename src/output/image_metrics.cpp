#include "output/image_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "film/error_estimate.h"

namespace kadr {
namespace {

/// Where R, G and B are.
std::array<std::size_t, 3> color_channels(const Image& image) {
    constexpr const char* kNames[3] = {"R", "G", "B"};
    std::array<std::size_t, 3> channels{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto found = std::find(image.channels.begin(), image.channels.end(), kNames[c]);
        if (found != image.channels.end()) channels[c] = static_cast<std::size_t>(found - image.channels.begin());
    }
    return channels;
}

/// One value a pixel, [y][x].
struct Plane {
    int width, height;
    std::vector<double> values;
    double at(int x, int y) const {
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

/// Rec. 709 weights of encoded values, as video does.
Plane luma_of(const Image& image) {
    const std::array<std::size_t, 3> channel = color_channels(image);
    Plane plane{image.width, image.height, {}};
    plane.values.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    for (std::size_t i = 0; i < image.pixels.size(); i += image.channels.size()) {
        const float* p = image.pixels.data() + i;
        plane.values.push_back(0.2126 * p[channel[0]] + 0.7152 * p[channel[1]] + 0.0722 * p[channel[2]]);
    }
    return plane;
}

Plane product(const Plane& a, const Plane& b) {
    Plane result = a;
    for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] *= b.values[i];
    return result;
}

/// Weights of sum 1 over 2 `radius` + 1 pixels.
std::vector<double> gaussian(int radius) {
    constexpr double kDeviation = 1.5;
    std::vector<double> weights;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
        weights.push_back(std::exp(-i * i / (2 * kDeviation * kDeviation)));
        sum += weights.back();
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

/// The weighted means of all windows that lie in the plane as a whole; smaller than the plane by 2 radii.
Plane window_means(const Plane& plane, const std::vector<double>& across, const std::vector<double>& down) {
    Plane rows{plane.width - static_cast<int>(across.size()) + 1, plane.height, {}};
    for (int y = 0; y < rows.height; ++y)
        for (int x = 0; x < rows.width; ++x) {
            double sum = 0;
            for (std::size_t k = 0; k < across.size(); ++k) sum += across[k] * plane.at(x + static_cast<int>(k), y);
            rows.values.push_back(sum);
        }
    Plane result{rows.width, rows.height - static_cast<int>(down.size()) + 1, {}};
    for (int y = 0; y < result.height; ++y)
        for (int x = 0; x < result.width; ++x) {
            double sum = 0;
            for (std::size_t k = 0; k < down.size(); ++k) sum += down[k] * rows.at(x, y + static_cast<int>(k));
            result.values.push_back(sum);
        }
    return result;
}

int window_radius(int size) {
    constexpr int kRadius = 5;
    return std::min(kRadius, (size - 1) / 2);
}

}  // namespace

double relative_mse(const Image& reference, const Image& test) {
    const std::array<std::size_t, 3> r = color_channels(reference), t = color_channels(test);
    const std::size_t pixels = static_cast<std::size_t>(reference.width) * static_cast<std::size_t>(reference.height);
    double sum = 0;
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double expected = reference.pixels[i * reference.channels.size() + r[c]];
            const double difference = test.pixels[i * test.channels.size() + t[c]] - expected;
            sum += difference * difference / (expected * expected + kRelativeErrorFloor);
        }
    return pixels == 0 ? 0 : sum / (3.0 * static_cast<double>(pixels));
}

double structural_similarity(const Image& reference, const Image& test) {
    constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // (K L)², L = 1
    const Plane a = luma_of(reference), b = luma_of(test);
    const std::vector<double> across = gaussian(window_radius(a.width)), down = gaussian(window_radius(a.height));
    const auto means = [&](const Plane& plane) { return window_means(plane, across, down); };
    const Plane mean_a = means(a), mean_b = means(b);
    const Plane aa = means(product(a, a)), bb = means(product(b, b)), ab = means(product(a, b));
    double sum = 0;
    for (std::size_t i = 0; i < mean_a.values.size(); ++i) {
        const double ma = mean_a.values[i], mb = mean_b.values[i];
        const double variance_a = aa.values[i] - ma * ma, variance_b = bb.values[i] - mb * mb;
        const double covariance = ab.values[i] - ma * mb;
        sum += (2 * ma * mb + kC1) * (2 * covariance + kC2) /
               ((ma * ma + mb * mb + kC1) * (variance_a + variance_b + kC2));
    }
    return mean_a.values.empty() ? 1 : sum / static_cast<double>(mean_a.values.size());
}

}  // namespace kadr
