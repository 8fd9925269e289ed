#include "film/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kadr {
namespace {

/// One output channel: its name and its value at a pixel.
struct Channel {
    const char* name;
    float (*value)(const Film::Surface& surface, float samples);
};

/// A file must hold no NaN: one would spread through every filter a compositor applies.
float finite(float value) {
    if (std::isnan(value)) return 0;
    return std::clamp(value, -std::numeric_limits<float>::max(), std::numeric_limits<float>::max());
}

/// Divided, not multiplied by 1 / samples: n * (1 / n) may be just below 1, and an opaque pixel must be opaque.
float over_samples(float sum, float samples) { return samples > 0 ? finite(sum / samples) : 0; }

/// The mean of unit vectors is shorter than one at edges; only its direction is wanted.
float normal_channel(const Film::Surface& surface, int axis) {
    const float* n = surface.normal;
    const float largest = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
    if (!(largest > 0) || !std::isfinite(largest)) return 0;
    const float x = n[0] / largest, y = n[1] / largest, z = n[2] / largest;
    return finite(n[axis] / largest / std::sqrt(x * x + y * y + z * z));
}

float over_hits(const Film::Surface& surface, float sum) {
    return surface.depth_weight > 0 ? finite(sum / surface.depth_weight) : 0;
}

float depth_channel(const Film::Surface& surface) {
    return surface.depth_weight > 0 ? finite(surface.depth / surface.depth_weight) : std::numeric_limits<float>::infinity();
}

using Surface = Film::Surface;

constexpr Channel kAlbedo[] = {{"albedo.R", [](const Surface& s, float n) { return over_samples(s.albedo[0], n); }},
                               {"albedo.G", [](const Surface& s, float n) { return over_samples(s.albedo[1], n); }},
                               {"albedo.B", [](const Surface& s, float n) { return over_samples(s.albedo[2], n); }}};
constexpr Channel kNormal[] = {{"normal.X", [](const Surface& s, float) { return normal_channel(s, 0); }},
                               {"normal.Y", [](const Surface& s, float) { return normal_channel(s, 1); }},
                               {"normal.Z", [](const Surface& s, float) { return normal_channel(s, 2); }}};
constexpr Channel kDepth[] = {{"depth.Z", [](const Surface& s, float) { return depth_channel(s); }}};
constexpr Channel kMotion[] = {{"motion.X", [](const Surface& s, float) { return over_hits(s, s.motion[0]); }},
                               {"motion.Y", [](const Surface& s, float) { return over_hits(s, s.motion[1]); }}};

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

/// Standard error of the pixel's luminance: sqrt(variance of the group means / number of groups).
float standard_error(const Film::Groups& groups) {
    if (groups.count < 2) return 0;
    const double n = groups.count, mean = groups.sum / n;
    const double variance = std::max(0.0, groups.sum_of_squares / n - mean * mean) * n / (n - 1);
    return finite(static_cast<float>(std::sqrt(variance / n)));
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
    beauty_.resize(count);
    samples_.resize(count);
    if (layers.any_surface()) surface_.resize(count);
    if (layers.error) groups_.resize(count);
}

void Film::clear(bool weighted) {
    weights_.assign(weighted ? beauty_.size() : 0, 0.0f);
    std::fill(beauty_.begin(), beauty_.end(), Beauty{});
    std::fill(samples_.begin(), samples_.end(), 0u);
    std::fill(surface_.begin(), surface_.end(), Surface{});
    std::fill(groups_.begin(), groups_.end(), Groups{});
}

Image Film::develop() const {
    const std::vector<Channel> channels = surface_channels(layers_);
    Image image{width_, height_, channel_names(channels, layers_), {}};
    image.pixels.resize(beauty_.size() * image.channels.size());
    float* out = image.pixels.data();
    for (std::size_t i = 0; i < beauty_.size(); ++i) {
        const float samples = static_cast<float>(samples_[i]), weight = weighted() ? weights_[i] : samples;
        const Beauty& beauty = beauty_[i];
        for (const float sum : {beauty.r, beauty.g, beauty.b}) *out++ = over_samples(sum, weight);
        *out++ = std::clamp(over_samples(beauty.alpha, weight), 0.0f, 1.0f);
        for (const Channel& channel : channels) *out++ = channel.value(surface_[i], weight);
        if (layers_.samples) *out++ = samples;
        if (layers_.error) *out++ = standard_error(groups_[i]);
    }
    return image;
}

}  // namespace kadr
