#include "measure/frame_difference.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "output/flip.h"
#include "output/image_metrics.h"
#include "output/view.h"
#include "render/frame_identity.h"

namespace kadr {
namespace {

int index_of(const Image& image, const char* name) {
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    return found == image.channels.end() ? -1 : static_cast<int>(found - image.channels.begin());
}

/// Indices of the channels to keep; grey images have one for all three colours.
std::vector<std::size_t> beauty_of(const Image& image, const std::filesystem::path& file) {
    const int grey = index_of(image, "Y");
    std::vector<std::size_t> kept;
    for (const char* name : {"R", "G", "B"}) {
        const int channel = index_of(image, name) >= 0 ? index_of(image, name) : grey;
        if (channel < 0)
            throw InputError(
                fmt::format("the image '{}' has the channels {}", file.string(), fmt::join(image.channels, ", ")),
                "expected R, G and B, or Y");
        kept.push_back(static_cast<std::size_t>(channel));
    }
    if (const int alpha = index_of(image, "A"); alpha >= 0) kept.push_back(static_cast<std::size_t>(alpha));
    return kept;
}

bool has_alpha(const Image& image) { return image.channels.size() == 4; }

/// Sets what is not finite in either image to black in both. @return pixels
std::size_t blacken_not_finite(Image& a, Image& b) {
    const std::size_t sa = a.channels.size(), sb = b.channels.size(), pixels = a.pixels.size() / sa;
    const auto is_bad = [](float value) { return !std::isfinite(value); };
    std::size_t count = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        float *first = a.pixels.data() + i * sa, *second = b.pixels.data() + i * sb;
        if (std::none_of(first, first + sa, is_bad) && std::none_of(second, second + sb, is_bad)) continue;
        std::fill_n(first, sa, 0.0f);
        std::fill_n(second, sb, 0.0f);
        ++count;
    }
    return count;
}

Image without_alpha(const Image& image) {
    if (!has_alpha(image)) return image;
    Image result{image.width, image.height, {"R", "G", "B"}, {}};
    result.pixels.reserve(image.pixels.size() / 4 * 3);
    for (std::size_t i = 0; i < image.pixels.size(); i += 4)
        result.pixels.insert(result.pixels.end(), image.pixels.begin() + static_cast<std::ptrdiff_t>(i),
                             image.pixels.begin() + static_cast<std::ptrdiff_t>(i) + 3);
    return result;
}

Image displayed(const Image& image, bool linear, const ViewSpec& view) {
    return linear ? apply_view(image, view, false) : without_alpha(image);
}

/// Source: IEC 61966-2-1.
float decoded(float x) { return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f); }

Image radiance(const Image& image, bool linear) {
    Image result = without_alpha(image);
    if (!linear)
        for (float& value : result.pixels) value = decoded(value);
    return result;
}

}  // namespace

StoredImage read_stored(const std::filesystem::path& file) {
    const Image whole = image_io().read(file);
    const std::vector<std::size_t> kept = beauty_of(whole, file);
    Image image{whole.width, whole.height, {"R", "G", "B"}, {}};
    if (kept.size() == 4) image.channels.emplace_back("A");
    image.pixels.reserve(whole.pixels.size() / whole.channels.size() * kept.size());
    for (std::size_t i = 0; i < whole.pixels.size(); i += whole.channels.size())
        for (const std::size_t channel : kept) image.pixels.push_back(whole.pixels[i + channel]);
    return {std::move(image), is_linear_file(file)};
}

ShownDifference difference_between(const StoredImage& reference, const StoredImage& test,
                                   const DifferenceOptions& options) {
    Image a = reference.image, b = test.image;
    if (a.width != b.width || a.height != b.height)
        throw InputError(fmt::format("the images to compare are {}x{} and {}x{}", a.width, a.height, b.width, b.height),
                         "expected the same size");
    ShownDifference shown;
    FrameDifference& difference = shown.difference;
    difference.not_finite = blacken_not_finite(a, b);
    shown.reference = displayed(a, reference.linear, options.view);
    shown.test = displayed(b, test.linear, options.view);
    const bool as_radiance = reference.linear && test.linear;
    const bool alpha = has_alpha(a) && has_alpha(b) && as_radiance == reference.linear && as_radiance == test.linear;
    const Image& first = as_radiance || !reference.linear ? a : shown.reference;
    const Image& second = as_radiance || !test.linear ? b : shown.test;
    const Image va = alpha ? first : without_alpha(first), vb = alpha ? second : without_alpha(second);
    difference.values = image_io().compare(va, vb);
    difference.largest_channel = va.channels[static_cast<std::size_t>(difference.values.channel)];
    // Where only one image is linear, both are compared as they look on a display.
    difference.relmse = relative_mse(radiance(first, as_radiance), radiance(second, as_radiance));
    difference.ssim = structural_similarity(shown.reference, shown.test);
    shown.flip = flip_map(shown.reference, shown.test, options.pixels_per_degree);
    double sum = 0;
    for (const float error : shown.flip.pixels) sum += error;
    difference.flip = sum / static_cast<double>(shown.flip.pixels.size());
    return shown;
}

}  // namespace kadr
