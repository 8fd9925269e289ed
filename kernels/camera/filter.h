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
