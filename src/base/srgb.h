#pragma once

#include <cmath>

namespace kadr {

// The sRGB transfer of a value in [0, 1].  Source: IEC 61966-2-1.
inline double linear_from_srgb(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }
inline double srgb_from_linear(double x) { return x <= 0.0031308 ? x * 12.92 : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

}  // namespace kadr
