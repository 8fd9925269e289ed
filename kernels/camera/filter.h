// Pixel filters, by importance: a sample lands where the filter is large and counts for one pixel alone.
#pragma once

#include "kernels/math/gather.h"
#include "kernels/scene/scene_types.h"

namespace kadr::kernels {

/// One dimension of a separable filter, ready for sampling |f|.
struct FilterTable {
    static constexpr int kIntervals = 512;
    FilterKind kind;
    float radius;  ///< pixels; half of the full width
    float inverse_cdf[kIntervals +
                      1];   ///< |offset| at the fraction 1 - (1 - i/kIntervals)^2 of the mass: dense in the tail
    float negative_beyond;  ///< |offset| from which the filter is negative; past the radius if nowhere
    float norm;             ///< integral of |f| over integral of f, of one dimension
};

/// The filter at distance x of the centre, not normalised. Widths: Gaussian sigma = radius / 3 and 0 at the radius;
/// Mitchell-Netravali B = C = 1/3 stretched to the radius; 4-term Blackman-Harris over the full width.
SHARED_FN double filter_value(FilterKind kind, double radius, double x) {
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

/// Fills the table of a filter. Once per frame, on the host.
SHARED_FN void build_filter(FilterKind kind, float radius, FilterTable& out) {
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

/// One dimension of sample_filter.
template <class F>
SHARED_FN F sample_filter_1d(const FilterTable& filter, F u, F& weight) {
    const F centred = u * F(2.0f) - F(1.0f);  // the filter is even: the sign chooses the side
    const F t = F(1.0f) - safe_sqrt(F(1.0f) - abs(centred));
    const F scaled = t * F(static_cast<float>(FilterTable::kIntervals));
    const Int<F> cell = clamp_index<F>(truncate(scaled), 0, FilterTable::kIntervals - 1);
    const F low = gather(filter.inverse_cdf, cell);
    const F high = gather(filter.inverse_cdf + 1, cell);
    const F distance = lerp(low, high, scaled - F(cell));
    weight = select(Mask<F>(distance > F(filter.negative_beyond)), F(-filter.norm), F(filter.norm));
    return copy_sign(distance, centred);
}

/// Position of a sample relative to its pixel's centre, and what it counts for.
///
/// @param offset_px  within +-radius
/// @param weight     1 for filters without negative lobes; else of either sign with mean 1
template <class F>
SHARED_FN void sample_filter(const FilterTable& filter, Vec2<F> u, Vec2<F>& offset_px, F& weight) {
    if (filter.kind == FilterKind::box) {
        const F width(2.0f * filter.radius);
        offset_px = {(u.x - F(0.5f)) * width, (u.y - F(0.5f)) * width};
        weight = F(1.0f);
        return;
    }
    F weight_x, weight_y;
    offset_px = {sample_filter_1d(filter, u.x, weight_x), sample_filter_1d(filter, u.y, weight_y)};
    weight = weight_x * weight_y;
}

}  // namespace kadr::kernels
