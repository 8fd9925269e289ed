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

SHARED_FN bool has_layers(const FilmView& film) { return film.albedo || film.normal || film.hits; }

template <class T>
SHARED_FN void add_vector(FilmVector& sum, Vec3<T> value, T light) {
    sum.x += value.x * light;
    sum.y += value.y * light;
    sum.z += value.z * light;
}

template <class T>
SHARED_FN void add_surface(const FilmView& film, unsigned long pixel, const SampleResult<T>& s) {
    if (film.albedo) add_vector(film.albedo[pixel], s.albedo, s.light);
    if (film.normal) add_vector(film.normal[pixel], s.normal, s.light);
    if (film.motion) {
        film.motion[pixel].x += s.motion.x * s.light;
        film.motion[pixel].y += s.motion.y * s.light;
    }
    if (!s.met_surface || !is_finite(s.depth)) return;
    if (film.depth) film.depth[pixel] += s.depth * s.light;
    if (film.hits) film.hits[pixel] += s.light;
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
    add_surface(film, pixel, s);
    return true;
}

}  // namespace kadr::kernels
