#include "film/film.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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
    if (!wanted) return;
    for (const Channel& channel : more) channels.push_back(channel);
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

Film::Film(int width, int height, FilmLayers layers, int halves, bool weighted)
    : width_(width), height_(height), layers_(layers), halves_(halves), weighted_(weighted), band_shift_(0) {
    // Large enough that what is freed goes back to the system (32 MiB and more, in glibc); small pictures are one band.
    constexpr std::size_t kBandPixels = std::size_t{1} << 21;
    const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
    while ((columns << band_shift_) < kBandPixels && (std::size_t{1} << band_shift_) < rows) ++band_shift_;
    const std::size_t band_rows = std::size_t{1} << band_shift_;
    bands_.resize((rows + band_rows - 1) / band_rows);
    for (std::size_t i = 0; i < bands_.size(); ++i) {
        Band& band = bands_[i];
        const std::size_t count = columns * std::min(band_rows, rows - i * band_rows);
        for (int half = 0; half < halves; ++half) {
            band.beauty[half].resize(count);
            band.samples[half].resize(count);
        }
        if (layers.albedo) band.albedo.resize(count);
        if (layers.normal) band.normal.resize(count);
        if (layers.depth) band.depth.resize(count);
        if (layers.motion) band.motion.resize(count);
        if (keeps_hits()) band.hits.resize(count);
    }
    resize_weights();
}

void Film::resize_weights() {
    for (Band& band : bands_)
        for (int half = 0; half < halves_; ++half) band.weights[half].assign(weighted_ ? band.beauty[half].size() : 0, 0.0);
}

void Film::clear(bool weighted) {
    weighted_ = weighted;
    resize_weights();
    const auto zero = []<class T>(std::vector<T>& values) { std::fill(values.begin(), values.end(), T{}); };
    for (Band& band : bands_) {
        for (int half = 0; half < halves_; ++half) zero(band.beauty[half]), zero(band.samples[half]);
        zero(band.albedo), zero(band.normal), zero(band.depth), zero(band.hits), zero(band.motion);
    }
}

std::size_t Film::bytes_per_pixel(const FilmLayers& layers, int halves, bool weighted) {
    const std::size_t half = sizeof(Beauty) + sizeof(std::uint32_t) + (weighted ? sizeof(double) : 0);
    return static_cast<std::size_t>(halves) * half + (layers.albedo ? sizeof(Vector) : 0) + (layers.normal ? sizeof(Vector) : 0) + (layers.depth ? sizeof(double) : 0) +
           (layers.motion ? sizeof(Pair) : 0) + (layers.depth || layers.motion ? sizeof(double) : 0);
}

void Film::add_surface(int x, int y, const Surface& sums) {
    Band& rows = band(y);
    const std::size_t i = index(x, y);
    const auto add = [i](std::vector<Vector>& to, const double (&from)[3]) {
        to[i].x += from[0];
        to[i].y += from[1];
        to[i].z += from[2];
    };
    if (layers_.albedo) add(rows.albedo, sums.albedo);
    if (layers_.normal) add(rows.normal, sums.normal);
    if (layers_.depth) rows.depth[i] += sums.depth;
    if (keeps_hits()) rows.hits[i] += sums.depth_weight;
    if (!layers_.motion) return;
    rows.motion[i].x += sums.motion[0];
    rows.motion[i].y += sums.motion[1];
}

Film::Surface Film::surface(int x, int y) const {
    const Band& rows = band(y);
    const std::size_t i = index(x, y);
    Surface sums;
    const auto copy = [i](const std::vector<Vector>& from, double (&to)[3]) { to[0] = from[i].x, to[1] = from[i].y, to[2] = from[i].z; };
    if (layers_.albedo) copy(rows.albedo, sums.albedo);
    if (layers_.normal) copy(rows.normal, sums.normal);
    if (layers_.depth) sums.depth = rows.depth[i];
    if (keeps_hits()) sums.depth_weight = rows.hits[i];
    if (layers_.motion) sums.motion[0] = rows.motion[i].x, sums.motion[1] = rows.motion[i].y;
    return sums;
}

std::uint32_t Film::samples_of_both(int x, int y) const {
    const Band& rows = band(y);
    const std::size_t i = index(x, y);
    return rows.samples[0][i] + (halves_ > 1 ? rows.samples[1][i] : 0);
}

double Film::divisor(int x, int y, int half) const {
    if (half >= halves_) return 0;
    const Band& rows = band(y);
    const std::size_t i = index(x, y);
    return weighted_ ? rows.weights[half][i] : static_cast<double>(rows.samples[half][i]);
}

Film::Color Film::mean(int x, int y, int half) const {
    const Beauty& sum = beauty(x, y, half);
    const double n = divisor(x, y, half);
    return {static_cast<float>(sum.r / n), static_cast<float>(sum.g / n), static_cast<float>(sum.b / n)};
}

/// @param done  called with the number of each band that is developed, but for the last
template <class Done>
Image Film::developed(const Done& done) const {
    const std::vector<Channel> channels = surface_channels(layers_);
    Image image{width_, height_, channel_names(channels, layers_), {}};
    const std::size_t row_values = static_cast<std::size_t>(width_) * image.channels.size();
    // Row by row: memory that nothing was written to yet takes none.
    image.pixels.reserve(row_values * static_cast<std::size_t>(height_));
    std::optional<StandardErrors> errors;
    if (layers_.error) errors.emplace(*this);
    for (int y = 0; y < height_; ++y) {
        image.pixels.resize(image.pixels.size() + row_values);
        float* out = image.pixels.data() + image.pixels.size() - row_values;
        if (errors) errors->move_to(y);
        for (int x = 0; x < width_; ++x) {
            const std::uint32_t samples = samples_of_both(x, y);
            const double weight = weighted_ ? divisor(x, y, 0) + divisor(x, y, 1) : samples;
            const Beauty a = beauty(x, y, 0), b = halves_ > 1 ? beauty(x, y, 1) : Beauty{};
            for (const double sum : {a.r + b.r, a.g + b.g, a.b + b.b}) *out++ = over_samples(sum, weight);
            *out++ = std::clamp(over_samples(a.alpha + b.alpha, weight), 0.0f, 1.0f);
            if (!channels.empty()) {
                const Surface sums = surface(x, y);
                for (const Channel& channel : channels) *out++ = channel.value(sums, weight);
            }
            if (layers_.samples) *out++ = static_cast<float>(samples);
            if (errors) *out++ = finite(errors->at(x));
        }
        if (y + 1 < height_ && band_of(y) != band_of(y + 1)) done(band_of(y));  // errors look ahead, not back
    }
    return image;
}

Image Film::develop() const {
    return developed([](std::size_t) {});
}

Image Film::develop(Film&& film) {
    return film.developed([&](std::size_t band) { film.bands_[band] = {}; });
}

}  // namespace kadr
