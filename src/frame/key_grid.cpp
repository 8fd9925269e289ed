#include "frame/key_grid.h"

#include <algorithm>
#include <cmath>

namespace kadr {

int even_segments_for(const std::vector<double>& times) {
    constexpr int kMostUneven = 16;
    for (int segments = 1; segments <= kMostUneven; ++segments) {
        const auto on_grid = [segments](double time) { return std::abs(time * segments - std::round(time * segments)) < 1e-6 * segments; };
        if (std::all_of(times.begin(), times.end(), on_grid)) return segments;
    }
    return 1;
}

int refined_segments(int base, int wanted) {
    int segments = base;
    while (segments < wanted && 2 * segments <= kMostSegments) segments *= 2;
    return segments;
}

}  // namespace kadr
