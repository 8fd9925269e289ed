#pragma once

#include <cstddef>
#include <vector>

namespace kadr {

inline constexpr int kMostSegments = 128;  ///< 129 frames: Embree's limit

/// Of the motion tolerance, what a fit may use up: it looks in three places of a segment and at corners, not everywhere.
inline constexpr double kMotionMargin = 0.9;

/// The smallest number of even segments of [0, 1] whose ends meet all the given times (each inside it) to 1e-6, among
/// 1 ... 16; 1 where none does. A key between two frames is smoothed away and converges only like 1/n.
int even_segments_for(const std::vector<double>& times);

/// base * 2^k, the smallest that is at least `wanted`.
int refined_segments(int base, int wanted);

/// Keys evenly spaced on [0, 1]: one where every sample is the same, else as few as fit, by doubling.
/// @param sample  (u) -> value
/// @param same    (a, b) -> whether two values are the same
/// @param fits    (a, b, u, wanted) -> whether interpolating a and b at u in (0, 1) comes near enough to `wanted`
template <class Sample, class Same, class Fits>
auto fit_keys(int base, int at_least, int at_most, Sample sample, Same same, Fits fits) {
    using Value = decltype(sample(0.0));
    for (int segments = refined_segments(base, at_least);; segments *= 2) {
        std::vector<Value> samples;
        bool still = true, close = true;
        for (int i = 0; i <= 4 * segments; ++i) {
            samples.push_back(sample(i / (4.0 * segments)));
            still = still && same(samples.front(), samples.back());
        }
        if (still) return std::vector<Value>{samples.front()};
        for (int i = 0; close && i < 4 * segments; ++i) {
            const std::size_t from = static_cast<std::size_t>(i / 4 * 4);
            if (i % 4 != 0) close = fits(samples[from], samples[from + 4], 0.25 * (i % 4), samples[static_cast<std::size_t>(i)]);
        }
        if (!close && 2 * segments <= at_most) continue;
        std::vector<Value> keys;
        for (std::size_t i = 0; i < samples.size(); i += 4) keys.push_back(samples[i]);
        return keys;
    }
}

}  // namespace kadr
