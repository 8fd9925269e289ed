#include "device/tables/environment_tables.h"

#include <cmath>

#include "kernels/light/environment_tables.h"

namespace kadr {

EnvironmentTables::EnvironmentTables(const Image& image) : width_(image.width), height_(image.height) {
    const std::size_t channels = image.channels.size();
    texels_.resize(static_cast<std::size_t>(image.width) * image.height);
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        const float* p = image.pixels.data() + i * channels;
        const auto clean = [](float x) { return std::isfinite(x) && x > 0 ? x : 0.0f; };
        texels_[i] = channels >= 3 ? kernels::Vec3f{clean(p[0]), clean(p[1]), clean(p[2])}
                                   : kernels::Vec3f{clean(p[0]), clean(p[0]), clean(p[0])};
    }
    marginal_.resize(image.height + 1);
    conditional_.resize(static_cast<std::size_t>(image.height) * (image.width + 1));
    average_luminance_ = kernels::build_environment_tables(texels_.data(), image.width, image.height, marginal_.data(),
                                                           conditional_.data());
}

kernels::EnvironmentMap EnvironmentTables::map() const {
    kernels::EnvironmentMap map;
    map.average_luminance = average_luminance_;
    map.texels = texels_.data();
    map.width = width_;
    map.height = height_;
    map.marginal = marginal_.data();
    map.conditional = conditional_.data();
    return map;
}

}  // namespace kadr
