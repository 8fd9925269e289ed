#include "render/environment_image.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "output/image_io.h"

namespace kadr {
namespace {

constexpr std::size_t kColors = 3;

bool holds_linear_values(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return extension == ".exr" || extension == ".hdr" || extension == ".pfm";
}

/// Source: IEC 61966-2-1.
float linear_from_srgb(float value) {
    return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

/// A radiance that is not finite or negative would poison the importance table; a sky holds none but by damage.
float as_radiance(float value, bool linear) {
    if (!std::isfinite(value) || value < 0) return 0;
    return linear ? value : linear_from_srgb(value);
}

Image colors_of(const Image& image, bool linear) {
    Image colors{image.width, image.height, {"R", "G", "B"}, {}};
    const std::size_t channels = image.channels.size();
    colors.pixels.reserve(static_cast<std::size_t>(image.width) * image.height * kColors);
    for (std::size_t i = 0; i < image.pixels.size(); i += channels)
        for (std::size_t c = 0; c < kColors; ++c)
            // One or two channels (grey, grey and alpha): the first stands for all colours.
            colors.pixels.push_back(as_radiance(image.pixels[i + (channels < kColors ? 0 : c)], linear));
    return colors;
}

}  // namespace

std::optional<Image> read_environment(const EnvironmentSpec& environment) {
    if (!environment.image) return std::nullopt;
    try {
        return colors_of(image_io().read(*environment.image), holds_linear_values(*environment.image));
    } catch (const InputError& error) {
        Diagnostic problem = error.diagnostics().front();
        if (problem.where.file.empty()) problem.where = environment.where;
        throw InputError(problem);
    }
}

void load_device(Device& device, const LoadedShot& shot) {
    const std::optional<Image> environment = read_environment(shot.shot().environment);
    device.load(shot.scene(), environment ? &*environment : nullptr, shot.build_settings());
}

}  // namespace kadr
