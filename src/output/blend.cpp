#include "output/blend.h"

#include <algorithm>
#include <cmath>

#include "base/srgb.h"

namespace kadr {
namespace {

constexpr std::size_t kColors = 3;

double decoded(double v, ReelBlend space) { return space == ReelBlend::linear ? linear_from_srgb(v) : v; }
double encoded(double v, ReelBlend space) { return space == ReelBlend::linear ? srgb_from_linear(v) : v; }

glm::dvec3 color_sum(const std::vector<BlendColor>& colors, ReelBlend space) {
    glm::dvec3 sum(0);
    for (const BlendColor& each : colors)
        for (int c = 0; c < 3; ++c) sum[c] += each.weight * decoded(each.color[c], space);
    return sum;
}

/// Index of a colour's channel; a missing one repeats the first (grey images).
std::size_t channel_of(const Image& image, const char* name) {
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    return found == image.channels.end() ? 0 : static_cast<std::size_t>(found - image.channels.begin());
}

Image filled(int width, int height, const glm::dvec3& color) {
    Image image{width, height, {"R", "G", "B"}, {}};
    image.pixels.resize(static_cast<std::size_t>(width) * height * kColors);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(color[static_cast<int>(i % kColors)]);
    return image;
}

}  // namespace

Image blend(const std::vector<BlendLayer>& layers, const std::vector<BlendColor>& colors, ReelBlend space) {
    const bool single = layers.size() == 1 && colors.empty();
    Image result = *layers.front().image;
    if (single) return result;
    const glm::dvec3 plain = color_sum(colors, space);
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
        double sum = plain[static_cast<int>(i % kColors)];
        for (const BlendLayer& layer : layers) sum += layer.weight * decoded(layer.image->pixels[i], space);
        result.pixels[i] = static_cast<float>(encoded(sum, space));
    }
    return result;
}

Image centred(const Image& display, int width, int height, const glm::dvec3& bars) {
    Image result = filled(width, height, bars);
    const std::size_t channels[kColors] = {channel_of(display, "R"), channel_of(display, "G"), channel_of(display, "B")};
    const std::size_t stride = display.channels.size();
    const int left = (width - display.width) / 2, top = (height - display.height) / 2;
    for (int y = std::max(0, top); y < std::min(height, top + display.height); ++y)
        for (int x = std::max(0, left); x < std::min(width, left + display.width); ++x) {
            const std::size_t from = (static_cast<std::size_t>(y - top) * display.width + (x - left)) * stride;
            const std::size_t to = (static_cast<std::size_t>(y) * width + x) * kColors;
            for (std::size_t c = 0; c < kColors; ++c) result.pixels[to + c] = display.pixels[from + channels[c]];
        }
    return result;
}

}  // namespace kadr
