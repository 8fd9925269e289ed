#include "render/image_checks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace kadr {
namespace {

constexpr std::size_t kColors = 3;

struct Range {
    float low = INFINITY, high = -INFINITY;
    std::size_t not_finite = 0;
    bool constant = true;
};

Range color_range(const Image& image) {
    Range range;
    const std::size_t channels = image.channels.size();
    for (std::size_t i = 0; i < image.pixels.size(); i += channels)
        for (std::size_t c = 0; c < kColors; ++c) {
            const float value = image.pixels[i + c];
            range.not_finite += !std::isfinite(value);
            range.low = std::min(range.low, value);
            range.high = std::max(range.high, value);
            range.constant = range.constant && value == image.pixels[c];
        }
    return range;
}

}  // namespace

std::vector<std::string> obvious_faults(const Image& linear) {
    const Range range = color_range(linear);
    std::vector<std::string> faults;
    if (range.not_finite > 0) faults.push_back(fmt::format("{} values are not finite", range.not_finite));
    if (range.low < 0) faults.push_back(fmt::format("a colour is negative ({})", range.low));
    if (range.high <= 0)
        faults.push_back("the image is black");
    else if (range.constant)
        faults.push_back("every pixel has the same colour");
    return faults;
}

}  // namespace kadr
