// The times of samples: how the light of a frame is spread over the shutter.
#pragma once

#include "kernels/math/gather.h"

namespace kadr::kernels {

/// The way from the first line that a rolling shutter exposes to the last one.
enum class RollingDirection : unsigned char { none, down, up, left, right };

/// The shutter as one part of it sees it. Times are lengths of this part from its beginning, so that a sample's time
/// lies in [0, 1]; a line may open before the part and close after it.
struct Shutter {
    static constexpr int kIntervals = 512;
    bool plain = true;  ///< the same light at any time, all lines at once: a sample's time is its random number
    RollingDirection direction = RollingDirection::none;
    float weight = 1;  ///< of a sample, before its line's share of the light; what unequal dealing of samples asks for
    float first_open = 0, delay = 0;  ///< when the first line opens; how much later the last one does
    float length = 1;                 ///< how long a line is open; 0: an instant
    /// Share of its light that a line has received after i / kIntervals of its time; from 0 to 1. Between entries light
    /// arrives evenly. Unused by a plain shutter.
    float passed[kIntervals + 1] = {};
};

/// Place of a pixel's line among the lines, in (0, 1) from the first to the last.
template <class F>
SHARED_FN F line_of_pixel(RollingDirection direction, Int<F> x, Int<F> y, int width, int height) {
    const F across = (F(x) + F(0.5f)) * F(1.0f / static_cast<float>(width));
    const F along = (F(y) + F(0.5f)) * F(1.0f / static_cast<float>(height));
    if (direction == RollingDirection::down) return along;
    if (direction == RollingDirection::up) return F(1.0f) - along;
    return direction == RollingDirection::left ? F(1.0f) - across : across;
}

/// Share of a line's light that has arrived at a fraction of its open time.
template <class F>
SHARED_FN F light_passed(const Shutter& shutter, F fraction) {
    const F scaled = saturate(fraction) * F(static_cast<float>(Shutter::kIntervals));
    const Int<F> cell = clamp_index<F>(truncate(scaled), 0, Shutter::kIntervals - 1);
    return lerp<F>(gather(shutter.passed, cell), gather(shutter.passed + 1, cell), scaled - F(cell));
}

/// When a sample is taken: by the inverse of the curve's integral, so that samples of equal weight lie densest where most
/// light passes.
///
/// @param line    in [0, 1]: which line the sample's pixel belongs to
/// @param u       random number in [0, 1)
/// @param time    in [0, 1] over this part of the shutter
/// @param weight  0 where the line is closed throughout this part
template <class F>
SHARED_FN void sample_shutter(const Shutter& shutter, F line, F u, F& time, F& weight) {
    time = u;
    weight = F(shutter.weight);
    if (shutter.plain) return;
    const F zero(0.0f), one(1.0f);
    const F open = F(shutter.first_open) + line * F(shutter.delay);
    if (!(shutter.length > 0.0f)) {
        weight = select(Mask<F>((open >= zero) & (open < one)), weight, zero);
        time = saturate(open);
        return;
    }
    const F per_length(1.0f / shutter.length);
    const F before = light_passed(shutter, (zero - open) * per_length);
    const F share = light_passed(shutter, (one - open) * per_length) - before;
    const F target = before + u * share;
    const Int<F> cell = find_interval(shutter.passed, Int<F>(0), Shutter::kIntervals, target);
    const F low = gather(shutter.passed, cell), rise = gather(shutter.passed + 1, cell) - low;
    const F inside = select(Mask<F>(rise > zero), (target - low) / select(Mask<F>(rise > zero), rise, one), zero);
    const F fraction = (F(cell) + min(inside, one)) * F(1.0f / static_cast<float>(Shutter::kIntervals));
    time = saturate(open + fraction * F(shutter.length));
    weight = weight * share;
}

}  // namespace kadr::kernels
