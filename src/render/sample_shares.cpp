#include "render/sample_shares.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kadr {
namespace {

std::vector<double> exact_shares(const std::vector<double>& weights, int total) {
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::vector<double> shares;
    for (const double weight : weights) shares.push_back(sum > 0 ? total * weight / sum : 0);
    return shares;
}

/// One sample to each part with weight, the heaviest first while there are samples.
std::vector<int> one_each(const std::vector<double>& weights, int total) {
    std::vector<int> order(weights.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return weights[a] > weights[b]; });
    std::vector<int> counts(weights.size(), 0);
    for (const int part : order)
        if (weights[part] > 0 && total-- > 0) counts[part] = 1;
    return counts;
}

}  // namespace

std::vector<SampleRange> deal_samples(const std::vector<double>& weights, int total) {
    const std::vector<double> shares = exact_shares(weights, total);
    std::vector<int> counts = one_each(weights, total);
    for (int left = total - std::accumulate(counts.begin(), counts.end(), 0); left > 0; --left) {
        // The part that is furthest below its share. Shutters have few parts and the loop is short beside one ray.
        std::size_t neediest = 0;
        for (std::size_t part = 1; part < counts.size(); ++part)
            if (shares[part] - counts[part] > shares[neediest] - counts[neediest]) neediest = part;
        if (counts.empty()) break;
        ++counts[neediest];
    }
    std::vector<SampleRange> ranges;
    int first = 0;
    for (const int count : counts) {
        ranges.push_back({first, count});
        first += count;
    }
    return ranges;
}

}  // namespace kadr
