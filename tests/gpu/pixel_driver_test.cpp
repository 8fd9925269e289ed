// The GPU's driver, built for the host over Embree: the same film as the processor's device to the last bit.
#include <gtest/gtest.h>

#include <xmmintrin.h>

#include <cstring>
#include <stdexcept>

#include "device/varied_scenes.h"
#include "device/embree/embree_tracer.h"
#include "kernels/camera/filter_table.h"
#include "kernels/gpu/entry_points.h"
#include "kernels/gpu/render_pixel.h"
#include "kernels/sampler/sobol.h"

namespace kadr::test {
namespace {

using kernels::IntegratorKind;

static_assert(sizeof(Film::Beauty) == sizeof(kernels::FilmBeauty));

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
    DeviceFilm(int width, int height, const FilmLayers& layers) : width_(width), pixels_(static_cast<std::size_t>(width * height)) {
        for (int half = 0; half < Film::kHalves; ++half) {
            beauty_[half].resize(pixels_);
            samples_[half].resize(pixels_);
            weights_[half].resize(pixels_);
        }
        if (layers.albedo) albedo_.resize(pixels_);
        if (layers.normal) normal_.resize(pixels_);
        if (layers.depth) depth_.resize(pixels_);
        if (layers.depth || layers.motion) hits_.resize(pixels_);
        if (layers.motion) motion_.resize(pixels_);
    }
    kernels::FilmView view(int half, bool weighted) {
        // Of an empty vector: null.
        return {beauty_[half].data(), samples_[half].data(), weighted ? weights_[half].data() : nullptr,
                albedo_.data(),       normal_.data(),        depth_.data(),
                hits_.data(),         motion_.data()};
    }
    void copy_to(Film& film) const {
        for (std::size_t i = 0; i < pixels_; ++i) {
            const int x = static_cast<int>(i) % width_, y = static_cast<int>(i) / width_;
            for (int half = 0; half < Film::kHalves; ++half) {
                std::memcpy(static_cast<void*>(&film.beauty(x, y, half)), &beauty_[half][i], sizeof(Film::Beauty));
                film.samples(x, y, half) = samples_[half][i];
                if (film.weighted()) film.weight(x, y, half) = weights_[half][i];
            }
            Film::Surface surface;
            if (!albedo_.empty()) std::memcpy(surface.albedo, &albedo_[i], sizeof surface.albedo);
            if (!normal_.empty()) std::memcpy(surface.normal, &normal_[i], sizeof surface.normal);
            if (!depth_.empty()) surface.depth = depth_[i];
            if (!hits_.empty()) surface.depth_weight = hits_[i];
            if (!motion_.empty()) std::memcpy(surface.motion, &motion_[i], sizeof surface.motion);
            film.add_surface(x, y, surface);
        }
    }

private:
    int width_;
    std::size_t pixels_;
    std::vector<kernels::FilmBeauty> beauty_[Film::kHalves];
    std::vector<unsigned> samples_[Film::kHalves];
    std::vector<double> weights_[Film::kHalves];
    std::vector<kernels::FilmVector> albedo_, normal_;
    std::vector<double> depth_, hits_;
    std::vector<kernels::FilmMotion> motion_;
};

template <unsigned R, IntegratorKind kIntegrator>
void run(const kernels::LaunchParams& params, const EmbreeScene& scene, int grid_width, int grid_height) {
    EmbreeTracer tracer(scene, kIntegrator == IntegratorKind::direct);
    for (int y = params.y0; y < params.y0 + grid_height; ++y)
        for (int x = params.x0; x < params.x0 + grid_width; ++x)
            if (is_wanted(params, x, y))
                kernels::PixelDriver<float, R, kIntegrator, EmbreeTracer>(params, tracer, x, y).render(*params.counters);
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
        KADR_KERNEL(path, kMaps | kSpecials | kTransforms | kDeformation),
        KADR_KERNEL(path, kEmitters),
        KADR_KERNEL(path, kTransforms | kEmitters),
        KADR_KERNEL(path, kMaps | kSpecials | kEmitters | kMirrors),
        KADR_KERNEL(path, kMaps | kSpecials | kTransforms | kMirrors),
        KADR_KERNEL(path, kEmitters | kMirrors | kIor),
        KADR_KERNEL(path, kTransforms | kEmitters | kFresnel),
        KADR_KERNEL(direct, 0),
        KADR_KERNEL(direct, kTransforms | kFresnel),
        KADR_KERNEL(direct, kIor),
        KADR_KERNEL(direct, kTransforms),
        KADR_KERNEL(direct, kTransforms | kDeformation),
        KADR_KERNEL(direct, kMaps | kSpecials | kTransforms | kDeformation),
        KADR_KERNEL(direct, kMaps | kSpecials),
        KADR_KERNEL(direct, kMaps | kSpecials | kTransforms),
#undef KADR_KERNEL
    };
    for (const auto& k : kKernels)
        if (k.integrator == integrator && k.requirements == requirements)
            return k.kernel(params, scene, (params.x1 - params.x0 + 7) / 8 * 8, (params.y1 - params.y0 + 7) / 8 * 8);
    throw std::runtime_error("the test has no kernel for the set " + std::to_string(requirements));
}

/// What is asked of a frame.
struct Request {
    FilmLayers layers;
    int samples = 7;  ///< of each half
    int halves = Film::kHalves;
    bool weighted = true;
    std::vector<std::uint8_t> active;  ///< of the last half; empty: all
    bool centred = false;
    const std::uint8_t* active_of(int half) const {
        return half == halves - 1 && !active.empty() ? active.data() : nullptr;
    }
};

struct Rendered {
    Image image;
    std::uint64_t rays, samples, dropped;
};

Rendered render_by_device(SmallScene& s, const Request& wanted) {
    DeviceRequest request;
    request.name = "cpu";
    request.threads = 2;
    request.width = 1;
    const DeviceChoice choice = make_device(request);
    choice.device->load(s.scene, s.environment.width > 0 ? &s.environment : nullptr);
    choice.device->set_frame(s.snapshot);
    Film film(s.snapshot.settings.width, s.snapshot.settings.height, wanted.layers);
    film.clear(wanted.weighted);
    Pass pass;
    pass.sample_count = wanted.samples;
    pass.total_samples = wanted.samples * wanted.halves;
    for (pass.half = 0; pass.half < wanted.halves; ++pass.half) {
        pass.active = wanted.active_of(pass.half);
        choice.device->render(pass, film);
    }
    const DeviceStatistics statistics = choice.device->statistics();
    return {film.develop(), statistics.rays, statistics.pixel_samples, statistics.dropped_samples};
}

/// All samples of one half: in two launches of each of two rectangles.
void launch_half(kernels::LaunchParams& params, const Request& wanted, const EmbreeScene& scene) {
    const kernels::Settings& settings = params.scene.settings;
    const unsigned set = kernels::kernel_requirements(settings.integrator, scene.requirements());
    const int split = wanted.samples / 2;
    params.x1 = settings.width;
    for (const int begin : {0, split}) {
        params.first_sample = begin;
        params.sample_count = begin == 0 && split > 0 ? split : wanted.samples - split;
        for (const int y0 : {0, settings.height / 3}) {
            params.y0 = y0;
            params.y1 = y0 == 0 ? settings.height / 3 : settings.height;
            launch(settings.integrator, set, params, scene);
        }
        if (split == 0) return;
    }
}

Rendered render_by_launches(SmallScene& s, const Request& wanted) {
    const EmbreeDeviceHandle device(rtcNewDevice(nullptr));
    EmbreeScene scene(device.get(), s.scene, s.environment.width > 0 ? &s.environment : nullptr);
    scene.set_frame(s.snapshot);
    const int width = s.snapshot.settings.width, height = s.snapshot.settings.height;
    DeviceFilm device_film(width, height, wanted.layers);
    kernels::FilterTable filter{};
    build_filter(s.snapshot.settings.filter, s.snapshot.settings.filter_radius, filter);
    kernels::LaunchCounters counters{};
    kernels::LaunchParams params{};
    params.scene = scene.view();
    params.filter = &filter;
    params.shutter = &s.snapshot.shutter;
    params.counters = &counters;
    params.centred = wanted.centred;
    const FlushDenormals flush;
    for (int half = 0; half < wanted.halves; ++half) {
        params.film = device_film.view(half, wanted.weighted);
        params.seed = kernels::seed_of_half(s.snapshot.settings.seed, half);
        params.active = wanted.active_of(half);
        launch_half(params, wanted, scene);
    }
    Film film(width, height, wanted.layers);
    film.clear(wanted.weighted);
    device_film.copy_to(film);
    return {film.develop(), counters.rays, counters.samples, counters.dropped};
}

/// No tolerance: one source, one tracer, one order of additions; and the set that is compiled here is exactly what the
/// scene requires, where the device takes a larger one.
void expect_same(SmallScene& s, const Request& wanted, const std::string& name) {
    s.snapshot.geometry_key = 1;
    const Rendered device = render_by_device(s, wanted), launches = render_by_launches(s, wanted);
    EXPECT_EQ(launches.image.pixels, device.image.pixels) << name;
    EXPECT_EQ(launches.rays, device.rays) << name;
    EXPECT_EQ(launches.samples, device.samples) << name;
    EXPECT_EQ(launches.dropped, device.dropped) << name;
}

class PixelDriver : public testing::TestWithParam<IntegratorKind> {};

TEST_P(PixelDriver, LeavesTheFilmOfTheProcessorsDevice) {
    Request wanted;
    wanted.layers.depth = wanted.layers.normal = wanted.layers.albedo = wanted.layers.motion = true;
    wanted.layers.samples = true;
    for (const VariedScene& content : varied_scenes()) {
        SmallScene s = sunlit(GetParam());
        content.add(s);
        expect_same(s, wanted, content.name);
    }
}

TEST_P(PixelDriver, LeavesPixelsAloneThatHaveSamplesEnough) {
    SmallScene s = sunlit(GetParam());
    varied_scenes()[0].add(s);
    Request wanted;
    wanted.weighted = false;
    wanted.layers.samples = true;
    for (int i = 0; i < s.snapshot.settings.width * s.snapshot.settings.height; ++i)
        wanted.active.push_back(i % 3 != 0);
    expect_same(s, wanted, "every third pixel is left alone");
}

TEST(PixelDriverAlone, TakesItsOneSampleInTheMiddle) {
    SmallScene s = sunlit(IntegratorKind::direct);
    varied_scenes().back().add(s);
    s.snapshot.camera_keys[0].lens_radius = 0.5f;
    s.snapshot.settings.filter_radius = 3;
    Request wanted;
    wanted.samples = wanted.halves = 1;
    wanted.weighted = false;
    wanted.centred = true;
    expect_same(s, wanted, "one sample");
}

/// Meets nothing, and loses every third ray.
struct LossyTracer {
    int rays = 0;
    bool closest(const kernels::PathState<float>&, kernels::Hit<float>&) { return ++rays % 3 != 0; }
    bool shadow(const kernels::ShadowRay<float>&, float, float&) { return true; }
};

TEST(PixelDriverAlone, DropsSamplesWhoseRayIsLost) {
    SmallScene s = sunlit(IntegratorKind::path);
    kernels::FilterTable filter{};
    build_filter(kernels::FilterKind::box, 0.5f, filter);
    DeviceFilm film(1, 1, {});
    kernels::LaunchCounters counters{};
    kernels::LaunchParams params{};
    params.scene.settings.width = params.scene.settings.height = params.x1 = params.y1 = 1;
    params.scene.camera = s.snapshot.camera;
    params.scene.camera.keys = s.snapshot.camera_keys.data();
    params.scene.lights.environment = {1, 2, 3};
    params.scene.lights.environment_visible = true;
    params.filter = &filter;
    params.shutter = &s.snapshot.shutter;
    params.film = film.view(0, false);
    params.sample_count = 9;
    LossyTracer tracer;
    kernels::PixelDriver<float, 0, IntegratorKind::path, LossyTracer>(params, tracer, 0, 0).render(counters);
    EXPECT_EQ(counters.rays, 9u);
    EXPECT_EQ(counters.samples, 6u);
    EXPECT_EQ(counters.dropped, 3u);
    EXPECT_EQ(*params.film.samples, 6u);
    EXPECT_EQ(params.film.beauty->r, 6.0f);
    EXPECT_EQ(params.film.beauty->b, 18.0f);
}

INSTANTIATE_TEST_SUITE_P(PathAndDirect, PixelDriver, testing::Values(IntegratorKind::path, IntegratorKind::direct));

}  // namespace
}  // namespace kadr::test
