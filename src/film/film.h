#pragma once

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
/// known of the noise (see error_estimate.h); together they are the picture.
class Film {
public:
    static constexpr int kHalves = 2;

    Film(int width, int height, FilmLayers layers);
    /// @param weighted  samples count for different amounts of light (a split or a rolling shutter): see weight()
    void clear(bool weighted = false);

    int width() const { return width_; }
    int height() const { return height_; }
    const FilmLayers& layers() const { return layers_; }

    /// In double: a float sum of a million equal samples is off by percents, since each is rounded to the sum's last place.
    struct Beauty { double r = 0, g = 0, b = 0, alpha = 0; };
    /// Sums over samples, times their weight where the film is weighted; normal in world space; depth (metres along the view axis) and motion (pixels since the previous
    /// frame, x right, y down) over the samples that hit a surface, whose number is depth_weight.
    struct Surface { double albedo[3] = {}, normal[3] = {}; double depth = 0; double depth_weight = 0; double motion[2] = {}; };

    Beauty& beauty(int x, int y, int half = 0) { return beauty_[half][index(x, y)]; }
    const Beauty& beauty(int x, int y, int half = 0) const { return beauty_[half][index(x, y)]; }
    std::uint32_t& samples(int x, int y, int half = 0) { return samples_[half][index(x, y)]; }
    bool weighted() const { return weighted_; }
    /// Sum of the samples' shares of the light over the shutter, about 1 each; what sums are divided by instead of the
    /// number of samples. Only when weighted().
    double& weight(int x, int y, int half = 0) { return weights_[half][index(x, y)]; }
    Surface& surface(int x, int y) { return surface_[index(x, y)]; }     ///< only when layers().any_surface()

    std::uint32_t samples_of_both(int x, int y) const { return samples_[0][index(x, y)] + samples_[1][index(x, y)]; }
    /// What sums of a half are divided by: its number of samples, or their shares of the light.
    double divisor(int x, int y, int half) const;
    /// Mean R, G and B of a half. Only where its divisor is above zero; not finite where the sums overflowed.
    struct Color { float r, g, b; };
    Color mean(int x, int y, int half) const;

    /// Linear radiance (premultiplied alpha) and the layers, sums over counts or weights: R G B A, albedo.R/G/B, normal.X/Y/Z (unit,
    /// or zero), depth.Z (+infinity where nothing was hit), motion.X/Y, samples.N, error.Y (standard error of the
    /// luminance, over the neighbourhood). Holds no NaN, and no infinity but that of the depth.
    Image develop() const;

private:
    std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }
    int width_, height_;
    FilmLayers layers_;
    bool weighted_ = false;
    std::vector<Beauty> beauty_[kHalves];
    std::vector<std::uint32_t> samples_[kHalves];
    std::vector<double> weights_[kHalves];
    std::vector<Surface> surface_;
};

}  // namespace kadr
