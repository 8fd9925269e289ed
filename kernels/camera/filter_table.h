// The tables by which pixel filters are sampled. Made once per frame, on the host, in double.
#pragma once

#include "kernels/camera/filter.h"

namespace kadr::kernels {

/// The filter at distance x of the centre, not normalised. Widths: Gaussian sigma = radius / 3 and 0 at the radius;
/// Mitchell-Netravali B = C = 1/3 stretched to the radius; 4-term Blackman-Harris over the full width.
inline double filter_value(FilterKind kind, double radius, double x) {
    const double r = x / radius;
    if (r >= 1.0) return 0.0;
    if (kind == FilterKind::gaussian) return __builtin_exp(-4.5 * r * r) - __builtin_exp(-4.5);
    if (kind == FilterKind::mitchell) {
        const double t = 2.0 * r;
        return t < 1.0 ? (7.0 * t * t * t - 12.0 * t * t + 16.0 / 3.0) / 6.0
                       : (-7.0 / 3.0 * t * t * t + 12.0 * t * t - 20.0 * t + 32.0 / 3.0) / 6.0;
    }
    if (kind == FilterKind::blackman_harris) {
        const double a = 3.14159265358979323846 * (r + 1.0);
        return 0.35875 - 0.48829 * __builtin_cos(a) + 0.14128 * __builtin_cos(2.0 * a) -
               0.01168 * __builtin_cos(3.0 * a);
    }
    return 1.0;
}

/// Fills the table of a filter.
inline void build_filter(FilterKind kind, float radius, FilterTable& out) {
    constexpr int kSteps = 8192;
    out.kind = kind;
    out.radius = radius;
    out.negative_beyond = kind == FilterKind::mitchell ? 0.5f * radius : 2.0f * radius + 1.0f;
    out.norm = 1.0f;
    const double step = static_cast<double>(radius) / kSteps;
    double total = 0.0;
    for (int i = 0; i < kSteps; ++i) total += __builtin_fabs(filter_value(kind, radius, (i + 0.5) * step));
    double mass = 0.0;
    int next = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double here = __builtin_fabs(filter_value(kind, radius, (i + 0.5) * step)) / total;
        for (; next < FilterTable::kIntervals; ++next) {
            const double rest = 1.0 - static_cast<double>(next) / FilterTable::kIntervals;
            const double target = 1.0 - rest * rest;
            if (target > mass + here) break;
            out.inverse_cdf[next] = static_cast<float>((i + (here > 0.0 ? (target - mass) / here : 0.0)) * step);
        }
        mass += here;
    }
    for (; next <= FilterTable::kIntervals; ++next) out.inverse_cdf[next] = radius;
    if (kind != FilterKind::mitchell) return;
    // The positive share of what the table samples, so that the mean weight is 1 whatever the table's own error.
    int cell = 0;
    while (out.inverse_cdf[cell + 1] < out.negative_beyond) ++cell;
    const double low = out.inverse_cdf[cell], high = out.inverse_cdf[cell + 1];
    const double rest = 1.0 - (cell + (out.negative_beyond - low) / (high - low)) / FilterTable::kIntervals;
    out.norm = static_cast<float>(1.0 / (1.0 - 2.0 * rest * rest));
}

}  // namespace kadr::kernels
