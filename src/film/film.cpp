#include "film/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "film/error_estimate.h"

namespace kadr {
namespace {

/// One output channel: its name and its value at a pixel.
struct Channel {
    const char* name;
    float (*value)(const Film::Surface& surface, double samples);
};

/// A file must hold no NaN: one would spread through every filter a compositor applies.
float finite(double value) {
    if (std::isnan(value)) return 0;
    constexpr double kLargest = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

/// Divided, not multiplied by 1 / samples: n * (1 / n) may be just below 1, and an opaque pixel must be opaque.
float over_samples(double sum, double samples) { return samples > 0 ? finite(sum / samples) : 0; }

/// The mean of unit vectors is shorter than one at edges; only its direction is wanted.
float normal_channel(const Film::Surface& surface, int axis) {
    const double* n = surface.normal;
    const double largest = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
    if (!(largest > 0) || !std::isfinite(largest)) return 0;
    const double x = n[0] / largest, y = n[1] / largest, z = n[2] / largest;
    return finite(n[axis] / largest / std::sqrt(x * x + y * y + z * z));
}

float over_hits(const Film::Surface& surface, double sum) {
    return surface.depth_weight > 0 ? finite(sum / surface.depth_weight) : 0;
}

float depth_channel(const Film::Surface& surface) {
    return surface.depth_weight > 0 ? finite(surface.depth / surface.depth_weight) : std::numeric_limits<float>::infinity();
}

using Surface = Film::Surface;

constexpr Channel kAlbedo[] = {{"albedo.R", [](const Surface& s, double n) { return over_samples(s.albedo[0], n); }},
                               {"albedo.G", [](const Surface& s, double n) { return over_samples(s.albedo[1], n); }},
                               {"albedo.B", [](const Surface& s, double n) { return over_samples(s.albedo[2], n); }}};
constexpr Channel kNormal[] = {{"normal.X", [](const Surface& s, double) { return normal_channel(s, 0); }},
                               {"normal.Y", [](const Surface& s, double) { return normal_channel(s, 1); }},
                               {"normal.Z", [](const Surface& s, double) { return normal_channel(s, 2); }}};
constexpr Channel kDepth[] = {{"depth.Z", [](const Surface& s, double) { return depth_channel(s); }}};
constexpr Channel kMotion[] = {{"motion.X", [](const Surface& s, double) { return over_hits(s, s.motion[0]); }},
                               {"motion.Y", [](const Surface& s, double) { return over_hits(s, s.motion[1]); }}};

template <std::size_t N>
void append(std::vector<Channel>& channels, bool wanted, const Channel (&more)[N]) {
    if (wanted) channels.insert(channels.end(), std::begin(more), std::end(more));
}

std::vector<Channel> surface_channels(const FilmLayers& layers) {
    std::vector<Channel> channels;
    append(channels, layers.albedo, kAlbedo);
    append(channels, layers.normal, kNormal);
    append(channels, layers.depth, kDepth);
    append(channels, layers.motion, kMotion);
    return channels;
}

std::vector<std::string> channel_names(const std::vector<Channel>& surface, const FilmLayers& layers) {
    std::vector<std::string> names{"R", "G", "B", "A"};
    for (const Channel& channel : surface) names.emplace_back(channel.name);
    if (layers.samples) names.emplace_back("samples.N");
    if (layers.error) names.emplace_back("error.Y");
    return names;
}

}  // namespace

Film::Film(int width, int height, FilmLayers layers) : width_(width), height_(height), layers_(layers) {
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (int half = 0; half < kHalves; ++half) {
        beauty_[half].resize(count);
        samples_[half].resize(count);
    }
    if (layers.any_surface()) surface_.resize(count);
}

void Film::clear(bool weighted) {
    weighted_ = weighted;
    for (int half = 0; half < kHalves; ++half) {
        weights_[half].assign(weighted ? beauty_[half].size() : 0, 0.0);
        std::fill(beauty_[half].begin(), beauty_[half].end(), Beauty{});
        std::fill(samples_[half].begin(), samples_[half].end(), 0u);
    }
    std::fill(surface_.begin(), surface_.end(), Surface{});
}

double Film::divisor(int x, int y, int half) const {
    const std::size_t i = index(x, y);
    return weighted_ ? weights_[half][i] : static_cast<double>(samples_[half][i]);
}

Film::Color Film::mean(int x, int y, int half) const {
    const Beauty& sum = beauty_[half][index(x, y)];
    const double n = divisor(x, y, half);
    return {static_cast<float>(sum.r / n), static_cast<float>(sum.g / n), static_cast<float>(sum.b / n)};
}

Image Film::develop() const {
    const std::vector<Channel> channels = surface_channels(layers_);
    Image image{width_, height_, channel_names(channels, layers_), {}};
    image.pixels.resize(beauty_[0].size() * image.channels.size());
    const std::vector<float> errors = layers_.error ? standard_errors(*this) : std::vector<float>();
    float* out = image.pixels.data();
    for (std::size_t i = 0; i < beauty_[0].size(); ++i) {
        const double samples = samples_[0][i] + samples_[1][i];
        const double weight = weighted_ ? weights_[0][i] + weights_[1][i] : samples;
        const Beauty &a = beauty_[0][i], &b = beauty_[1][i];
        for (const double sum : {a.r + b.r, a.g + b.g, a.b + b.b}) *out++ = over_samples(sum, weight);
        *out++ = std::clamp(over_samples(a.alpha + b.alpha, weight), 0.0f, 1.0f);
        for (const Channel& channel : channels) *out++ = channel.value(surface_[i], weight);
        if (layers_.samples) *out++ = static_cast<float>(samples);
        if (layers_.error) *out++ = finite(errors[i]);
    }
    return image;
}

}  // namespace kadr
