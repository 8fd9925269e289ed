#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace kadr {

/// A developed image: interleaved float channels, row 0 on top.
struct Image {
    int width = 0, height = 0;
    std::vector<std::string> channels;   ///< "R", "G", "B", "A", "albedo.R", "normal.X", "depth.Z", "samples.N", ...
    std::vector<float> pixels;           ///< [y][x][channel]
    float at(int x, int y, int channel) const { return pixels[(static_cast<std::size_t>(y) * width + x) * channels.size() + channel]; }
};

/// Which data layers are kept beside the beauty.
struct FilmLayers {
    bool albedo = false, normal = false, depth = false, motion = false, samples = false, error = false;
    bool operator==(const FilmLayers&) const = default;
    bool any_surface() const { return albedo || normal || depth || motion; }
};

/// Sums over the samples of every pixel. Pixels are owned by one tile at a time and summed in sample order, so the
/// result does not depend on threads.
///
/// The samples come in two halves that are scrambled independently of each other: how far the halves differ is what is
/// known of the noise (see error_estimate.h); together they are the picture. A film of one half knows nothing of it.
///
/// Only what the layers ask for is there. Bands of rows are allocated apart, so that a large film can go while the
/// picture comes.
class Film {
public:
    static constexpr int kHalves = 2;

    /// @param halves    1 or 2
    /// @param weighted  samples count for different amounts of light (a split or a rolling shutter): see weight()
    Film(int width, int height, FilmLayers layers, int halves = kHalves, bool weighted = false);
    void clear(bool weighted = false);

    int width() const { return width_; }
    int height() const { return height_; }
    int halves() const { return halves_; }
    const FilmLayers& layers() const { return layers_; }

    /// In double: a float sum of a million equal samples is off by percents, since each is rounded to the sum's last place.
    struct Beauty { double r = 0, g = 0, b = 0, alpha = 0; };
    /// Sums over samples, times their weight where the film is weighted; normal in world space; depth (metres along the view axis) and motion (pixels since the previous
    /// frame, x right, y down) over the samples that hit a surface, whose number is depth_weight.
    struct Surface { double albedo[3] = {}, normal[3] = {}; double depth = 0; double depth_weight = 0; double motion[2] = {}; };

    // Of a half that the film has.
    Beauty& beauty(int x, int y, int half = 0) { return band(y).beauty[half][index(x, y)]; }
    const Beauty& beauty(int x, int y, int half = 0) const { return band(y).beauty[half][index(x, y)]; }
    std::uint32_t& samples(int x, int y, int half = 0) { return band(y).samples[half][index(x, y)]; }
    bool weighted() const { return weighted_; }
    /// Sum of the samples' shares of the light over the shutter, about 1 each; what sums are divided by instead of the
    /// number of samples. Only when weighted().
    double& weight(int x, int y, int half = 0) { return band(y).weights[half][index(x, y)]; }
    // Sums of single layers, where they are kept: depth and motion over the samples that hit a surface, whose weight is hits.
    struct Vector { double x = 0, y = 0, z = 0; };
    struct Pair { double x = 0, y = 0; };
    Vector& albedo(int x, int y) { return band(y).albedo[index(x, y)]; }
    Vector& normal(int x, int y) { return band(y).normal[index(x, y)]; }
    double& depth(int x, int y) { return band(y).depth[index(x, y)]; }
    double& hits(int x, int y) { return band(y).hits[index(x, y)]; }
    Pair& motion(int x, int y) { return band(y).motion[index(x, y)]; }
    /// The row behind the last one that lies in one piece with row y: sums of [y, end) follow each other.
    int end_of_band(int y) const { return std::min(height_, static_cast<int>((band_of(y) + 1) << band_shift_)); }
    /// Adds to the sums of the layers that are kept; the others are dropped.
    void add_surface(int x, int y, const Surface& sums);
    /// The sums of the layers that are kept; 0 of the others.
    Surface surface(int x, int y) const;

    std::uint32_t samples_of_both(int x, int y) const;
    /// What sums of a half are divided by: its number of samples, or their shares of the light; 0 of a half that is not there.
    double divisor(int x, int y, int half) const;
    /// Mean R, G and B of a half. Only where its divisor is above zero; not finite where the sums overflowed.
    struct Color { float r, g, b; };
    Color mean(int x, int y, int half) const;

    /// Linear radiance (premultiplied alpha) and the layers, sums over counts or weights: R G B A, albedo.R/G/B, normal.X/Y/Z (unit,
    /// or zero), depth.Z (+infinity where nothing was hit), motion.X/Y, samples.N, error.Y (standard error of the
    /// luminance, over the neighbourhood). Holds no NaN, and no infinity but that of the depth.
    Image develop() const;
    /// The same of a film that is not needed any more: a band of it is freed as soon as it is developed.
    static Image develop(Film&& film);

    /// Bytes a pixel of the sums.
    static std::size_t bytes_per_pixel(const FilmLayers& layers, int halves, bool weighted);

private:
    /// Rows of the film; [y][x] from the band's first row on. What is not kept is empty.
    struct Band {
        std::vector<Beauty> beauty[kHalves];
        std::vector<std::uint32_t> samples[kHalves];
        std::vector<double> weights[kHalves];
        std::vector<Vector> albedo, normal;
        std::vector<double> depth, hits;  ///< hits: the weight of the samples that met a surface
        std::vector<Pair> motion;
    };
    std::size_t band_of(int y) const { return static_cast<std::size_t>(y) >> band_shift_; }
    Band& band(int y) { return bands_[band_of(y)]; }
    const Band& band(int y) const { return bands_[band_of(y)]; }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y & ((1 << band_shift_) - 1)) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    bool keeps_hits() const { return layers_.depth || layers_.motion; }
    void resize_weights();
    template <class Done>
    Image developed(const Done& done) const;

    int width_, height_;
    FilmLayers layers_;
    int halves_;
    bool weighted_;
    int band_shift_;  ///< a band has 2^this rows, the last one fewer
    std::vector<Band> bands_;
};

}  // namespace kadr
