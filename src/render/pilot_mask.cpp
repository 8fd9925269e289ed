#include "render/pilot_mask.h"

#include <algorithm>
#include <cmath>

namespace kadr {

PilotMask pilot_mask(int width, int height) {
    constexpr int kPixels = 32, kLeast = 1024;
    constexpr double kGolden = 0.6180339887498949;
    const std::int64_t pixels = std::int64_t{width} * height;
    const int stride = static_cast<int>(std::clamp<std::int64_t>(pixels / kLeast, 1, kPixels));
    PilotMask mask;
    mask.active.assign(static_cast<std::size_t>(pixels), 0);
    for (int y = 0; y < height; ++y) {
        const double turns = y * kGolden;
        for (int x = static_cast<int>((turns - std::floor(turns)) * stride); x < width; x += stride) {
            mask.active[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                1;
            ++mask.count;
        }
    }
    return mask;
}

}  // namespace kadr
