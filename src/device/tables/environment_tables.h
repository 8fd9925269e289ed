#pragma once

#include <vector>

#include "film/film.h"
#include "kernels/light/environment.h"

namespace kadr {

/// An environment image as the kernels fetch and sample it. Empty without an image.
class EnvironmentTables {
public:
    EnvironmentTables() = default;
    /// Values that are negative or not finite count as black. @param image  R, G, B, or one channel as grey
    explicit EnvironmentTables(const Image& image);

    bool empty() const { return texels_.empty(); }
    const std::vector<kernels::Vec3f>& texels() const { return texels_; }
    const std::vector<float>& marginal() const { return marginal_; }
    const std::vector<float>& conditional() const { return conditional_; }
    /// Points to the tables; factor 1, no turn.
    kernels::EnvironmentMap map() const;

private:
    std::vector<kernels::Vec3f> texels_;
    std::vector<float> marginal_, conditional_;
    int width_ = 0, height_ = 0;
    float average_luminance_ = 0;
};

}  // namespace kadr
