#pragma once

// Written by tools/bench/prices.py: what choices between speed and accuracy cost and lose. Not edited by hand.

#include <array>

namespace kadr {

/// A setting of `render`; medians over the sample shots whose picture it changes.
struct MeasuredPrice {
    const char* key;
    const char* value;
    double cost, most_cost;  ///< processor time over that of the shot's own settings: median, and the most of all samples
    double relmse;           ///< over that of the shot's own settings, at as many samples
    double flip, most_flip;
    int changed;             ///< of how many samples the picture changes; 0: the medians are those of all
};

/// Ways to the same FLIP: processor time over that of equal samples for every pixel.
struct MeasuredShortcut {
    const char* way;
    double median, least, most;  ///< of the samples
};

inline constexpr int kPriceSamples = 64, kPriceShots = 15;
inline constexpr std::array<MeasuredPrice, 21> kMeasuredPrices{{
    {"integrator", "direct", 0.31, 1.03, 532, 36.1, 48.8, 2},
    {"bounces", "0", 0.523, 1.02, 31.7, 12, 48.8, 14},
    {"bounces", "1", 0.925, 0.984, 2.79, 3.97, 12.9, 14},
    {"bounces", "3", 0.999, 1.09, 0.996, 1, 2.62, 13},
    {"bounces", "32", 1, 1.03, 1, 1, 1.03, 13},
    {"fresnel", "exact", 1.05, 1.14, 1.01, 0.889, 0.997, 15},
    {"motion_tolerance", "0.02 px", 1.03, 1.11, 1, 0.998, 1, 6},
    {"motion_tolerance", "0.5 px", 0.977, 1.04, 1, 0.997, 1, 1},
    {"motion_tolerance", "2 px", 0.977, 1.03, 1, 0.997, 1, 1},
    {"motion_frames", "2", 1.04, 1.23, 0.998, 1, 1.43, 8},
    {"motion_frames", "5", 1.04, 2.27, 1, 1, 1.09, 8},
    {"motion_frames", "17", 1.06, 6.1, 1, 1, 1.09, 8},
    {"motion_frames", "{ count: 2, mix: matrix }", 0.94, 1.05, 0.999, 1, 2.34, 5},
    {"motion_frames", "{ count: 17, mix: matrix }", 1.02, 1.52, 0.999, 1, 1.01, 8},
    {"clamp", "{ indirect: 3 }", 1, 1.04, 1.06, 1.02, 1.44, 4},
    {"denoise", "oidn", 1.2, 1.72, 0.885, 1.07, 4.79, 15},
    {"build", "low", 1.01, 1.02, 1, 1, 1, 1},
    {"build", "high", 1.15, 1.4, 0.999, 0.999, 1, 1},
    {"robust", "true", 1.06, 1.13, 1, 1, 1.01, 15},
    {"texture_limit", "16 px", 0.96, 1.01, 1.59, 1.24, 2.05, 13},
    {"texture_limit", "64 px", 0.967, 1.01, 1.14, 1.1, 1.47, 13},
}};
inline constexpr std::array<MeasuredShortcut, 5> kMeasuredShortcuts{{
    {"denoised, 4 samples", 0.834, 0.377, 6.89},
    {"denoised, 16 samples", 0.742, 0.372, 7.11},
    {"max_error: 0.1", 0.988, 0.913, 1.43},
    {"max_error: 0.05", 1.14, 0.974, 1.49},
    {"max_error: 0.025", 1.68, 0.891, 2.55},
}};

}  // namespace kadr
