#include "output/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "base/srgb.h"

namespace kadr {
namespace {

using Color = glm::dvec3;

/// Constants of the paper, section 4.
constexpr double kColorExponent = 0.7;       // q_c
constexpr double kColorThreshold = 0.4;      // p_c
constexpr double kThresholdError = 0.95;     // p_t
constexpr double kFeatureWidth_deg = 0.082;  // w
constexpr double kFeatureExponent = 0.5;     // q_f

/// Contrast sensitivity of one opponent channel: two Gaussians in the frequency domain (table 1).
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr Sensitivity kSensitivities[3] = {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};
constexpr double kWidestSensitivity = 0.04;

/// One value a pixel, [y][x].
struct Plane {
    int width, height;
    std::vector<double> values;
    Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
    double& at(int x, int y) { return values[static_cast<std::size_t>(y) * width + x]; }
    double at(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
};

using Planes = std::array<Plane, 3>;
using Kernel = std::vector<double>;   ///< odd length, centre in the middle

// --- Colour spaces (the matrix of the authors' code: IEC 61966-2-1 with D65 as whole fractions) ---------------------

const glm::dmat3 kXyzFromRgb = glm::transpose(
    glm::dmat3(10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0, 2613072.0 / 12288897.0,
               8788810.0 / 12288897.0, 887015.0 / 12288897.0, 1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0));
const glm::dmat3 kRgbFromXyz = glm::inverse(kXyzFromRgb);
const Color kWhite = kXyzFromRgb * Color(1);

Color opponent_from_rgb(const Color& rgb) {
    const Color xyz = kXyzFromRgb * rgb / kWhite;
    return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

Color rgb_from_opponent(const Color& c) {
    const double y = (c.x + 16) / 116;
    return kRgbFromXyz * (Color(y + c.y / 500, y, y - c.z / 200) * kWhite);
}

double lab_curve(double t) {
    constexpr double kDelta = 6.0 / 29.0;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29.0;
}

/// CIE L*a*b* with the Hunt effect: colours of dark places look less colourful.
Color hunt_lab_from_rgb(const Color& rgb) {
    const Color xyz = kXyzFromRgb * rgb / kWhite;
    const Color f(lab_curve(xyz.x), lab_curve(xyz.y), lab_curve(xyz.z));
    const double lightness = 116 * f.y - 16;
    return {lightness, 0.01 * lightness * 500 * (f.x - f.y), 0.01 * lightness * 200 * (f.y - f.z)};
}

double hyab(const Color& a, const Color& b) {
    const Color d = a - b;
    return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

// --- Filters ---------------------------------------------------------------------------------------------------------

/// Rows then columns; beyond the border the border's pixel repeats.
Plane filtered(const Plane& source, const Kernel& along_x, const Kernel& along_y) {
    const auto convolve = [](const Plane& in, const Kernel& kernel, int dx, int dy) {
        Plane out(in.width, in.height);
        const int radius = static_cast<int>(kernel.size() / 2);
        tbb::parallel_for(0, in.height, [&](int y) {
            for (int x = 0; x < in.width; ++x)
                for (int k = -radius; k <= radius; ++k)
                    out.at(x, y) += kernel[static_cast<std::size_t>(k + radius)] *
                                    in.at(std::clamp(x + k * dx, 0, in.width - 1), std::clamp(y + k * dy, 0, in.height - 1));
        });
        return out;
    };
    return convolve(convolve(source, along_x, 1, 0), along_y, 0, 1);
}

double sum_of(const Kernel& kernel) {
    double sum = 0;
    for (const double weight : kernel) sum += weight;
    return sum;
}

template <class Function>
Kernel kernel_of(int radius, const Function& weight) {
    Kernel kernel;
    for (int i = -radius; i <= radius; ++i) kernel.push_back(weight(static_cast<double>(i)));
    return kernel;
}

void scale(Kernel& kernel, double factor) {
    for (double& weight : kernel) weight *= factor;
}

Plane sensitivity_filtered(const Plane& source, const Sensitivity& s, double pixels_per_degree) {
    using std::numbers::pi;
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kWidestSensitivity / (2 * pi * pi)) * pixels_per_degree));
    const auto gaussian = [&](double b) {
        return kernel_of(radius, [&](double i) { return std::exp(-pi * pi * i * i / (pixels_per_degree * pixels_per_degree * b)); });
    };
    // The weight of each Gaussian in the plane is its amplitude times the sum of its (separable) samples.
    const auto part = [&](double a, double b, Kernel& kernel) {
        kernel = gaussian(b);
        const double sum = sum_of(kernel);
        scale(kernel, 1 / sum);
        return a * std::sqrt(pi / b) * sum * sum;
    };
    Kernel first, second;
    const double weight1 = part(s.a1, s.b1, first), weight2 = part(s.a2, s.b2, second);
    Plane result = filtered(source, first, first);
    if (weight2 == 0) return result;
    const Plane other = filtered(source, second, second);
    for (std::size_t i = 0; i < result.values.size(); ++i)
        result.values[i] = (weight1 * result.values[i] + weight2 * other.values[i]) / (weight1 + weight2);
    return result;
}

/// Positive weights sum to 1, negative to -1.
void normalise_signs(Kernel& kernel) {
    double positive = 0, negative = 0;
    for (const double weight : kernel) (weight > 0 ? positive : negative) += weight;
    for (double& weight : kernel) weight /= weight > 0 ? positive : -negative;
}

struct FeatureKernels {
    Kernel smooth, edge, point;
};

FeatureKernels feature_kernels(double pixels_per_degree) {
    const double deviation = 0.5 * kFeatureWidth_deg * pixels_per_degree, variance = deviation * deviation;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const auto gaussian = [&](double i) { return std::exp(-i * i / (2 * variance)); };
    FeatureKernels kernels{kernel_of(radius, gaussian), kernel_of(radius, [&](double i) { return -i * gaussian(i); }),
                           kernel_of(radius, [&](double i) { return (i * i / variance - 1) * gaussian(i); })};
    scale(kernels.smooth, 1 / sum_of(kernels.smooth));
    normalise_signs(kernels.edge);
    normalise_signs(kernels.point);
    return kernels;
}

Plane magnitude(const Plane& luminance, const Kernel& across, const Kernel& smooth) {
    Plane x = filtered(luminance, across, smooth);
    const Plane y = filtered(luminance, smooth, across);
    for (std::size_t i = 0; i < x.values.size(); ++i) x.values[i] = std::hypot(x.values[i], y.values[i]);
    return x;
}

// --- The two pipelines -----------------------------------------------------------------------------------------------

Planes opponent_planes(const Image& image) {
    Planes planes{Plane(image.width, image.height), Plane(image.width, image.height), Plane(image.width, image.height)};
    int channel[3] = {0, 0, 0};
    constexpr const char* kNames[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < image.channels.size(); ++i)
            if (image.channels[i] == kNames[c]) channel[c] = static_cast<int>(i);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            Color rgb;
            for (int c = 0; c < 3; ++c) rgb[c] = linear_from_srgb(std::clamp(static_cast<double>(image.at(x, y, channel[c])), 0.0, 1.0));
            const Color opponent = opponent_from_rgb(rgb);
            for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].at(x, y) = opponent[c];
        }
    return planes;
}

std::vector<Color> seen_colors(const Planes& opponent, double pixels_per_degree) {
    Planes seen = opponent;
    for (std::size_t c = 0; c < 3; ++c) seen[c] = sensitivity_filtered(opponent[c], kSensitivities[c], pixels_per_degree);
    std::vector<Color> colors;
    for (std::size_t i = 0; i < seen[0].values.size(); ++i) {
        const Color rgb = rgb_from_opponent({seen[0].values[i], seen[1].values[i], seen[2].values[i]});
        colors.push_back(hunt_lab_from_rgb(glm::clamp(rgb, 0.0, 1.0)));
    }
    return colors;
}

/// Maps a colour distance to [0, 1]: most of the range goes to small differences.
double color_error(const Color& a, const Color& b) {
    static const double largest =
        std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), kColorExponent);
    const double distance = std::pow(hyab(a, b), kColorExponent), threshold = kColorThreshold * largest;
    if (distance < threshold) return kThresholdError / threshold * distance;
    return kThresholdError + (distance - threshold) / (largest - threshold) * (1 - kThresholdError);
}

struct Features {
    Plane edges, points;
};

Features features_of(const Plane& opponent_luminance, const FeatureKernels& kernels) {
    Plane luminance = opponent_luminance;
    for (double& value : luminance.values) value = (value + 16) / 116;
    return {magnitude(luminance, kernels.edge, kernels.smooth), magnitude(luminance, kernels.point, kernels.smooth)};
}

double feature_error(const Features& a, const Features& b, std::size_t i) {
    const double edge = std::abs(a.edges.values[i] - b.edges.values[i]);
    const double point = std::abs(a.points.values[i] - b.points.values[i]);
    return std::pow(std::clamp(std::max(edge, point) / std::numbers::sqrt2, 0.0, 1.0), kFeatureExponent);
}

}  // namespace

Image flip_map(const Image& reference, const Image& test, double pixels_per_degree) {
    if (reference.width != test.width || reference.height != test.height)
        throw InputError(fmt::format("the images to compare are {} x {} and {} x {}", reference.width, reference.height,
                                     test.width, test.height),
                         "expected the same size");
    const Planes opponent_a = opponent_planes(reference), opponent_b = opponent_planes(test);
    const std::vector<Color> colors_a = seen_colors(opponent_a, pixels_per_degree);
    const std::vector<Color> colors_b = seen_colors(opponent_b, pixels_per_degree);
    const FeatureKernels kernels = feature_kernels(pixels_per_degree);
    const Features features_a = features_of(opponent_a[0], kernels), features_b = features_of(opponent_b[0], kernels);
    Image map{reference.width, reference.height, {"Y"}, {}};
    map.pixels.reserve(colors_a.size());
    for (std::size_t i = 0; i < colors_a.size(); ++i) {
        const double error = std::pow(color_error(colors_a[i], colors_b[i]), 1 - feature_error(features_a, features_b, i));
        map.pixels.push_back(static_cast<float>(error));
    }
    return map;
}

double mean_flip(const Image& reference, const Image& test, double pixels_per_degree) {
    const Image map = flip_map(reference, test, pixels_per_degree);
    double sum = 0;
    for (const float error : map.pixels) sum += error;
    return map.pixels.empty() ? 0 : sum / static_cast<double>(map.pixels.size());
}

}  // namespace kadr
