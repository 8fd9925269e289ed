// The tables by which an environment's image is sampled. Made once per image, on the host, in double.
#pragma once

#include "kernels/light/environment.h"

namespace kadr::kernels {

/// Mean luminance of a texel's bilinear surface: of its 3 x 3 neighbourhood, with weights 1/8, 3/4, 1/8 each way.
/// Positive wherever interpolation lets any light into the texel, which is what the density must be.
inline double texel_mean(const Vec3f* texels, int width, int height, int row, int column) {
    double sum = 0.0;
    for (int dy = -1; dy <= 1; ++dy) {
        const int r = row + dy < 0 ? 0 : (row + dy >= height ? height - 1 : row + dy);
        for (int dx = -1; dx <= 1; ++dx) {
            const int c = (column + dx + width) % width;
            const double weight = (dy == 0 ? 0.75 : 0.125) * (dx == 0 ? 0.75 : 0.125);
            const double y = luminance(texels[static_cast<long>(r) * width + c]);
            sum += y > 0.0 ? weight * y : 0.0;
        }
    }
    return sum;
}

/// Tables of an image.
///
/// @param marginal     [height + 1], out
/// @param conditional  [height][width + 1], out
/// @return mean luminance over the sphere: for EnvironmentMap::average_luminance
inline float build_environment_tables(const Vec3f* texels, int width, int height, float* marginal, float* conditional) {
    double total = 0.0, solid_angle = 0.0;
    marginal[0] = 0.0f;
    for (int row = 0; row < height; ++row) {
        float* cdf = conditional + static_cast<long>(row) * (width + 1);
        double sum = 0.0;
        for (int column = 0; column < width; ++column) sum += texel_mean(texels, width, height, row, column);
        double running = 0.0;
        cdf[0] = 0.0f;
        for (int column = 0; column < width; ++column) {
            running += texel_mean(texels, width, height, row, column);
            cdf[column + 1] = static_cast<float>(sum > 0.0 ? running / sum : (column + 1.0) / width);
        }
        cdf[width] = 1.0f;
        const double sine = __builtin_sin(3.14159265358979323846 * (row + 0.5) / height);
        total += sum * sine;
        solid_angle += width * sine;
        marginal[row + 1] = static_cast<float>(total);  // in place: a float of a sum in double, scaled below
    }
    for (int row = 1; row <= height; ++row) {
        marginal[row] = total > 0.0 ? static_cast<float>(marginal[row] / total)
                                    : static_cast<float>(row) / static_cast<float>(height);
    }
    marginal[height] = 1.0f;
    return static_cast<float>(total / solid_angle);
}

}  // namespace kadr::kernels
