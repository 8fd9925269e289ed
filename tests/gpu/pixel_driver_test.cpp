// The GPU's driver, built for the host over Embree: the same film as the processor's device to the last bit.
#include <gtest/gtest.h>

#include <xmmintrin.h>

#include <cstring>
#include <stdexcept>

#include "device/varied_scenes.h"
#include "gpu/embree_tracer.h"
#include "kernels/camera/filter_table.h"
#include "kernels/gpu/entry_points.h"
#include "kernels/gpu/render_pixel.h"
#include "kernels/sampler/sobol.h"

namespace kadr::test {
namespace {

using kernels::IntegratorKind;

static_assert(sizeof(Film::Beauty) == sizeof(kernels::FilmBeauty) &&
              sizeof(Film::Surface) == sizeof(kernels::FilmSurface));

/// The device flushes denormals while it traces.
class FlushDenormals {
public:
    FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040); }
    ~FlushDenormals() { _mm_setcsr(saved_); }

private:
    unsigned saved_;
};

/// A film as it lies on a device.
struct DeviceFilm {
    DeviceFilm(int width, int height, bool layers) : width_(width), pixels_(static_cast<std::size_t>(width * height)) {
        for (int half = 0; half < Film::kHalves; ++half) {
            beauty_[half].resize(pixels_);
            samples_[half].resize(pixels_);
            weights_[half].resize(pixels_);
        }
        if (layers) surface_.resize(pixels_);
    }
    kernels::FilmView view(int half) {
        return {beauty_[half].data(), samples_[half].data(), weights_[half].data(),
                surface_.empty() ? nullptr : surface_.data()};
    }
    void copy_to(Film& film) const {
        for (std::size_t i = 0; i < pixels_; ++i) {
            const int x = static_cast<int>(i) % width_, y = static_cast<int>(i) / width_;
            for (int half = 0; half < Film::kHalves; ++half) {
                std::memcpy(static_cast<void*>(&film.beauty(x, y, half)), &beauty_[half][i], sizeof(Film::Beauty));
                film.samples(x, y, half) = samples_[half][i];
                film.weight(x, y, half) = weights_[half][i];
            }
            if (!surface_.empty())
                std::memcpy(static_cast<void*>(&film.surface(x, y)), &surface_[i], sizeof(Film::Surface));
        }
    }

private:
    int width_;
    std::size_t pixels_;
    std::vector<kernels::FilmBeauty> beauty_[Film::kHalves];
    std::vector<unsigned> samples_[Film::kHalves];
    std::vector<float> weights_[Film::kHalves];
    std::vector<kernels::FilmSurface> surface_;
};

template <unsigned R, IntegratorKind kIntegrator>
void run(const kernels::LaunchParams& params, const EmbreeScene& scene, int grid_width, int grid_height) {
    EmbreeTracer tracer(scene, kIntegrator == IntegratorKind::direct);
    for (int y = params.y0; y < params.y0 + grid_height; ++y)
        for (int x = params.x0; x < params.x0 + grid_width; ++x)
            if (is_wanted(params, x, y))
                kernels::PixelDriver<R, kIntegrator, EmbreeTracer>(params, tracer, x, y).render(*params.counters);
}

/// Launches the kernel of exactly this set. The grid is larger than the rectangle, as a grid of blocks is.
void launch(IntegratorKind integrator, unsigned requirements, const kernels::LaunchParams& params,
            const EmbreeScene& scene) {
    using namespace kernels::requirement;
    using Kernel = void (*)(const kernels::LaunchParams&, const EmbreeScene&, int, int);
    static constexpr struct {
        IntegratorKind integrator;
        unsigned requirements;
        Kernel kernel;
    } kKernels[] = {
#define KADR_KERNEL(integrator, set) {IntegratorKind::integrator, (set), &run<(set), IntegratorKind::integrator>}
        KADR_KERNEL(path, 0),
        KADR_KERNEL(path, kTransforms),
        KADR_KERNEL(path, kTransforms | kDeformation),
        KADR_KERNEL(path, kMaps | kTransforms | kDeformation),
        KADR_KERNEL(path, kEmitters),
        KADR_KERNEL(path, kTransforms | kEmitters),
        KADR_KERNEL(path, kMaps | kEmitters),
        KADR_KERNEL(path, kMaps | kTransforms),
        KADR_KERNEL(direct, 0),
        KADR_KERNEL(direct, kTransforms),
        KADR_KERNEL(direct, kTransforms | kDeformation),
        KADR_KERNEL(direct, kMaps | kTransforms | kDeformation),
        KADR_KERNEL(direct, kMaps),
        KADR_KERNEL(direct, kMaps | kTransforms),
#undef KADR_KERNEL
    };
    for (const auto& k : kKernels)
        if (k.integrator == integrator && k.requirements == requirements)
            return k.kernel(params, scene, (params.x1 - params.x0 + 7) / 8 * 8, (params.y1 - params.y0 + 7) / 8 * 8);
    throw std::runtime_error("the test has no kernel for the set " + std::to_string(requirements));
}

constexpr int kSamples = 7;  ///< of each half, in two launches

struct Rendered {
    Image image;
    std::uint64_t rays, samples, dropped;
};

Rendered render_by_device(SmallScene& s, FilmLayers layers) {
    DeviceRequest request;
    request.name = "cpu";
    request.threads = 2;
    request.width = 1;
    const DeviceChoice choice = make_device(request);
    choice.device->load(s.scene, s.environment.width > 0 ? &s.environment : nullptr);
    choice.device->set_frame(s.snapshot);
    Film film(s.snapshot.settings.width, s.snapshot.settings.height, layers);
    film.clear(true);
    Pass pass;
    pass.sample_count = kSamples;
    pass.total_samples = 2 * kSamples;
    for (pass.half = 0; pass.half < Film::kHalves; ++pass.half) choice.device->render(pass, film);
    const DeviceStatistics statistics = choice.device->statistics();
    return {film.develop(), statistics.rays, statistics.pixel_samples, statistics.dropped_samples};
}

Rendered render_by_launches(SmallScene& s, FilmLayers layers) {
    const EmbreeDeviceHandle device(rtcNewDevice(nullptr));
    EmbreeScene scene(device.get(), s.scene, s.environment.width > 0 ? &s.environment : nullptr);
    scene.set_frame(s.snapshot);
    const int width = s.snapshot.settings.width, height = s.snapshot.settings.height;
    DeviceFilm device_film(width, height, layers.any_surface());
    kernels::FilterTable filter{};
    build_filter(s.snapshot.settings.filter, s.snapshot.settings.filter_radius, filter);
    kernels::LaunchCounters counters{};
    kernels::LaunchParams params{};
    params.scene = scene.view();
    params.filter = &filter;
    params.shutter = &s.snapshot.shutter;
    params.counters = &counters;
    const FlushDenormals flush;
    for (int half = 0; half < Film::kHalves; ++half) {
        params.film = device_film.view(half);
        params.seed = kernels::seed_of_half(s.snapshot.settings.seed, half);
        for (const int begin : {0, 3}) {
            params.first_sample = begin;
            params.sample_count = begin == 0 ? 3 : kSamples - 3;
            for (const int y0 : {0, height / 3}) {  // two rectangles
                params.x1 = width;
                params.y0 = y0;
                params.y1 = y0 == 0 ? height / 3 : height;
                const IntegratorKind integrator = s.snapshot.settings.integrator;
                launch(integrator, kernels::kernel_requirements(integrator, scene.requirements()), params, scene);
            }
        }
    }
    Film film(width, height, layers);
    film.clear(true);
    device_film.copy_to(film);
    return {film.develop(), counters.rays, counters.samples, counters.dropped};
}

class PixelDriver : public testing::TestWithParam<IntegratorKind> {};

TEST_P(PixelDriver, LeavesTheFilmOfTheProcessorsDevice) {
    FilmLayers layers;
    layers.depth = layers.normal = layers.albedo = layers.motion = layers.samples = true;
    for (const VariedScene& content : varied_scenes()) {
        SmallScene s = sunlit(GetParam());
        content.add(s);
        s.snapshot.geometry_key = 1;
        const Rendered device = render_by_device(s, layers), launches = render_by_launches(s, layers);
        // No tolerance: one source, one tracer, one order of additions; and the set that is compiled here is exactly
        // what the scene requires, where the device takes a larger one.
        EXPECT_EQ(launches.image.pixels, device.image.pixels) << content.name;
        EXPECT_EQ(launches.rays, device.rays) << content.name;
        EXPECT_EQ(launches.samples, device.samples) << content.name;
        EXPECT_EQ(launches.dropped, device.dropped) << content.name;
    }
}

INSTANTIATE_TEST_SUITE_P(PathAndDirect, PixelDriver, testing::Values(IntegratorKind::path, IntegratorKind::direct));

}  // namespace
}  // namespace kadr::test
