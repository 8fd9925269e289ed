#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "film/film.h"

// How noisy a film is, from its two halves A and B of n and m samples, scrambled independently of each other. The
// samples of one Owen-scrambled Sobol sequence are not independent: their variance says nothing of the error of their
// mean. Two means of independent sequences are: with I = (n A + m B) / (n + m), the mean square error of I is what (A -
// B)² n m / (n + m)² is on average, whatever the sequences do inside.

namespace kadr {

/// What keeps black places from deciding a relative mean square error alone: it is divided by value² + this.
inline constexpr double kRelativeErrorFloor = 0.01;

/// The relative mean square error of a picture as it is known from the picture alone.
struct ErrorEstimate {
    bool known = false;                      ///< both halves have samples somewhere
    double relmse = 0;                       ///< mean over pixels and R, G, B of error² / (value² + 0.01)
    double relmse_low = 0, relmse_high = 0;  ///< where it is in 95 of 100 frames
    std::size_t unknown_pixels = 0;          ///< one half is empty, or a sum overflowed
};

/// The value in the denominator is the pixel's own, less half of its noise: I² is too large by the noise, and I² less
/// the noise (A B) would be too small where one half alone holds a bright sample.
///
/// Such a sample may be a rare event over a dark surface, or a highlight that the other half missed; one frame does not
/// tell. The interval spans both: its low end takes the pixel's own value for the truth, its high end what the pixels
/// around that look like this one show (no less than the darker half). Both are widened by the spread over the pixels,
/// once for the estimate and once for the truth, which is one frame's too.
///
/// @param scale  of radiance in the picture over that in the film (physical exposure)
ErrorEstimate estimate_error(const Film& film, double scale = 1);

/// `relmse` of that alone, which takes a fraction of the time; 0 where nothing is known.
double mean_relative_error(const Film& film, double scale = 1);

/// Standard error of the luminance of every pixel, row by row: the root of the mean over 7 x 7 pixels (one pair of halves
/// says little). Infinite where a sum overflowed, 0 where nothing is known.
class StandardErrors {
public:
    explicit StandardErrors(const Film& film) : film_(film) {}
    /// To a row of the film, from the top one on; rows above it are not read again.
    void move_to(int y);
    float at(int x) const { return errors_[static_cast<std::size_t>(x)]; }

private:
    static constexpr int kRadius = 3, kRows = 2 * kRadius + 1;
    /// Sums over 2 kRadius + 1 pixels of a row: of the noise, and of the pixels of which it is known.
    struct Row {
        std::vector<double> noise, known;
    };
    void sum_row(int y);

    const Film& film_;
    int next_ = 0;
    std::array<Row, kRows> rows_;  ///< those around the row at hand, by their number modulo kRows
    std::vector<float> errors_;
};
/// Of all of them, [y][x].
std::vector<float> standard_errors(const Film& film);

/// Sums over squares of 2 `radius` + 1 pixels, clipped at the borders, and the number of pixels in each.
struct WindowSums {
    std::vector<double> sums;  ///< [y][x]
    std::vector<int> counts;   ///< [y][x]
};
WindowSums window_sums(const std::vector<double>& values, int width, int height, int radius);

}  // namespace kadr
