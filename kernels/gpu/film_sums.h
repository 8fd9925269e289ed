// One sample and how it is added to the film. The sums of a pixel are in the order of its samples, so that a film does
// not depend on how its samples were dealt to launches, and is the CPU's to the last bit where their samples are.
#pragma once

#include "kernels/gpu/launch_params.h"
#include "kernels/integrator/path.h"

namespace kadr::kernels {

/// What a path leaves behind.
template <class T>
struct SampleResult {
    Vec3<T> radiance{0, 0, 0};  ///< not a number: to be dropped
    T weight = 1;               ///< of the pixel filter
    T light = 1;                ///< weight in time
    T alpha = 0;
    Vec3<T> albedo{0, 0, 0}, normal{0, 0, 0};
    T depth = 0;
    Vec2<T> motion{0, 0};
    bool met_surface = false;  ///< depth and motion are those of a surface
};

template <class T>
SHARED_FN void add_surface(const SampleResult<T>& s, FilmSurface& sums) {
    const T albedo[3] = {s.albedo.x, s.albedo.y, s.albedo.z}, normal[3] = {s.normal.x, s.normal.y, s.normal.z};
    for (int c = 0; c < 3; ++c) {
        sums.albedo[c] += albedo[c] * s.light;
        sums.normal[c] += normal[c] * s.light;
    }
    sums.motion[0] += s.motion.x * s.light;
    sums.motion[1] += s.motion.y * s.light;
    if (!s.met_surface || !is_finite(s.depth)) return;
    sums.depth += s.depth * s.light;
    sums.depth_weight += s.light;
}

/// @return false: the sample is not finite, and was not added
template <class T>
SHARED_FN bool add_sample(const FilmView& film, unsigned long pixel, const SampleResult<T>& s) {
    const T sum = s.radiance.x + s.radiance.y + s.radiance.z;
    if (!(abs(sum) <= 3.4028234e38f)) return false;
    ++film.samples[pixel];
    const T w = s.weight * s.light;
    if (film.weights) film.weights[pixel] += s.light;
    FilmBeauty& beauty = film.beauty[pixel];
    beauty.r += s.radiance.x * w;
    beauty.g += s.radiance.y * w;
    beauty.b += s.radiance.z * w;
    beauty.alpha += s.alpha * w;
    if (film.surface) add_surface(s, film.surface[pixel]);
    return true;
}

}  // namespace kadr::kernels
