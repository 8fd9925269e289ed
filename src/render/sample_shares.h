#pragma once

#include <vector>

namespace kadr {

/// A contiguous range of sample numbers.
struct SampleRange {
    int first = 0, count = 0;
    bool operator==(const SampleRange&) const = default;
};

/// Deals `total` samples to the parts of a shutter by weight (largest remainders, the earlier part on a tie). Every part
/// with weight gets at least one where there are enough samples; the ranges follow one another and cover [0, total).
std::vector<SampleRange> deal_samples(const std::vector<double>& weights, int total);

}  // namespace kadr
