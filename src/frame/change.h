#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace kadr {

/// Values at five even steps of an interval, ends included.
inline constexpr int kChangeSteps = 5;
using Changing = std::array<double, kChangeSteps>;

/// value(time) at the five steps.
template <class Value>
Changing sampled(double begin_s, double end_s, Value value) {
    Changing values{};
    for (int i = 0; i < kChangeSteps; ++i) values[static_cast<std::size_t>(i)] = value(begin_s + (end_s - begin_s) * i / (kChangeSteps - 1));
    return values;
}

/// Whether something that radiance is linear in has another mean than the value in the middle, by more than a thousandth:
/// a tenth of a step of 8-bit output, as for lights. The mean by Boole's rule.
inline bool bends(const Changing& v) {
    constexpr double kTolerance = 1e-3;
    const double mean = (7 * (v[0] + v[4]) + 32 * (v[1] + v[3]) + 12 * v[2]) / 90;
    return std::abs(mean - v[2]) > kTolerance * *std::max_element(v.begin(), v.end());
}

/// Whether the values spread by more than a limit.
inline bool spreads(const Changing& v, double limit) {
    const auto [least, most] = std::minmax_element(v.begin(), v.end());
    return *most - *least > limit;
}

}  // namespace kadr
