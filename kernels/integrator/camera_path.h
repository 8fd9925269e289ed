// The beginning of a sample's path: where on the film, when, and through which point of the lens.
#pragma once

#include "kernels/camera/camera.h"
#include "kernels/camera/filter.h"
#include "kernels/camera/shutter.h"
#include "kernels/integrator/path.h"

namespace kadr::kernels {

/// A camera ray and what its sample counts for.
template <class F>
struct CameraSample {
    PathState<F> path;
    F weight;  ///< of the pixel filter (negative lobes); 1 otherwise
    F light;   ///< weight in time (a split or a rolling shutter); 1 otherwise. 0: the line is closed, there is no ray
};

/// @param seed     of the half of the film that the sample belongs to
/// @param centred  through the pixel's centre and the lens' too, at the shutter's opening
template <class F>
SHARED_FN CameraSample<F> start_path(const SceneFor<F>& scene, const FilterTable& filter, const Shutter& shutter,
                                     unsigned seed, bool centred, Int<F> x, Int<F> y, UInt<F> sample) {
    CameraSample<F> start;
    const Sampler<F> sampler = make_sampler<F>(x, y, sample, seed);
    Vec2<F> offset{F(0.0f), F(0.0f)}, lens{F(0.5f), F(0.5f)};
    F u_time(0.0f);
    start.weight = start.light = F(1.0f);
    if (!centred) {
        sample_filter(filter, sampler.get_2d(UInt<F>(dimension::kFilter)), offset, start.weight);
        const bool pinhole = scene.camera.key_count == 1 && !(scene.camera.keys->lens_radius > 0);
        if (!pinhole) lens = sampler.get_2d(UInt<F>(dimension::kLens));
        u_time = sampler.get_1d(UInt<F>(dimension::kTime));
    }
    const int width = scene.settings.width, height = scene.settings.height;
    PathState<F>& path = start.path;
    sample_shutter(shutter, line_of_pixel<F>(shutter.direction, x, y, width, height), u_time, path.time, start.light);
    const Vec2<F> film{F(x) + F(0.5f) + offset.x, F(y) + F(0.5f) + offset.y};
    camera_ray(scene.camera, width, height, film, path.time, lens, path.origin, path.direction);
    path.beta = {F(1.0f), F(1.0f), F(1.0f)};
    path.bsdf_pdf = F(0.0f);
    path.light_weight = F(0.0f);
    path.sampler_key = sampler.key;
    path.sample = sampler.index;
    path.bounces = UInt<F>(0u);
    return start;
}

}  // namespace kadr::kernels
