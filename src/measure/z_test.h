#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "film/film.h"

namespace kadr {

/// Whether two renderers draw from the same distribution: each renders replicates of a picture (the same but for the
/// random numbers), and means are compared in the units of their own standard errors.
///
/// Sources: Welch 1947, "The generalization of Student's problem when several different population variances are
/// involved" (Biometrika 34); Wallace 1959, "Bounds on normal approximations to Student's and the chi-square
/// distributions" (Ann. Math. Stat. 30); Holm 1979, "A simple sequentially rejective multiple test procedure" (Scand.
/// J. Stat. 6); for renderers Subr & Arvo 2007, "Statistical hypothesis testing for assessing Monte Carlo estimators".

/// Mean and spread of one value over replicates.
struct Moments {
    std::size_t count = 0;
    double mean = 0, squares = 0;  ///< squares: sum of the squared deviations from the mean
    void add(double value);        ///< Welford 1962
    double variance() const { return count > 1 ? squares / static_cast<double>(count - 1) : 0; }
    double variance_of_mean() const { return count > 0 ? variance() / static_cast<double>(count) : 0; }
};

/// The replicates of a picture by one renderer, at three scales: pixels, tiles, the whole picture; R, G, B of each.
class ReplicateSums {
public:
    static constexpr int kScales = 3;
    static constexpr int kTile = 16;  ///< pixels, the side of a tile
    struct Scale {
        int width = 0, height = 0;    ///< in cells
        std::vector<Moments> values;  ///< [y][x][channel]
    };

    /// @param image  R, G, B first; of one size for all
    void add(const Image& image);
    std::size_t count() const { return count_; }
    const Scale& scale(int i) const { return scales_[static_cast<std::size_t>(i)]; }
    /// The mean of all replicates: R, G, B.
    Image mean() const;

private:
    std::array<Scale, kScales> scales_;
    std::size_t count_ = 0;
};

/// The tests of one scale.
struct ScaleResult {
    static constexpr int kBounds = 3;      ///< |z| > 2, 3, 4
    std::string name;                      ///< "pixels", "tiles", "picture"
    std::size_t tests = 0;                 ///< values that have noise, on either side
    std::array<double, kBounds> beyond{};  ///< share of them with |z| above the bound
    double largest_z = 0;                  ///< of all values, its sign included; positive: the second is brighter
    int x = 0, y = 0, channel = 0;         ///< where that is, in cells
    std::size_t rejected = 0;              ///< by Holm's procedure, at kLevel / kScales for the scale
    double smallest_p = 1;                 ///< times the number of tests (Bonferroni), at most 1
};

/// The chance that a comparison calls two renderers different that are the same.
inline constexpr double kLevel = 1e-3;
/// Of normal numbers, the share beyond 2, 3, 4.
inline constexpr std::array<double, ScaleResult::kBounds> kNormalBeyond{0.0455002639, 0.0026997961, 0.0000633425};
/// What the arithmetic of two devices may make of one value, relative to it: they round other intermediate values, and
/// shading amplifies that. No picture differs visibly by it.
inline constexpr double kArithmetic = 1e-4;

struct ZTest {
    std::array<ScaleResult, ReplicateSums::kScales> scales;
    std::vector<float> z;     ///< [y][x] of the pixels: the largest of the three channels, with its sign
    double mean[2] = {0, 0};  ///< of the whole picture, over its channels
    double difference = 0, difference_from = 0, difference_to = 0;  ///< second less first over first; 95 % interval
    bool differs() const;                                           ///< whether any scale rejects
};

/// @param samples  of a pixel in one replicate: what one of them adds is as fine as a pixel's mean can tell
/// @pre at least two replicates each, of one size
ZTest compare_replicates(const ReplicateSums& first, const ReplicateSums& second, int samples);

/// The normal number that is as unlikely as `t` of Student's distribution.
double normal_of_student(double t, double degrees_of_freedom);

}  // namespace kadr
