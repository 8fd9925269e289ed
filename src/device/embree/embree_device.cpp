#include "device/embree/embree_device.h"

#include <chrono>
#include <cmath>
#include <mutex>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <xmmintrin.h>

#include "base/error.h"
#include "device/embree/embree_scene.h"
#include "device/embree/embree_tracer.h"
#include "device/embree/kernel_sets.h"
#include "device/embree/tile_job.h"
#include "device/sample_weight.h"
#include "device/tables/deformed_geometry.h"
#include "device/tables/scene_probe.h"
#include "kernels/camera/filter_table.h"
#include "kernels/sampler/sobol.h"

namespace kadr {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Denormals are flushed while a thread traces, as Embree advises, and restored after.
class FlushDenormals {
public:
    FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040); }
    ~FlushDenormals() { _mm_setcsr(saved_); }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
    unsigned saved_;
};

/// TBB caps its workers at the cores there are; more threads than that have to be asked for before an arena starts.
std::unique_ptr<tbb::global_control> allow_threads(int threads) {
    if (threads <= tbb::info::default_concurrency()) return nullptr;
    return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                 static_cast<std::size_t>(threads));
}

/// One thread's driver, results and counters.
struct Worker {
    std::unique_ptr<TileDriver> driver;
    std::unique_ptr<TileResult> result = std::make_unique<TileResult>();
    TileCounters counters;
    std::uint64_t samples = 0;
};

class EmbreeDevice final : public Device, private Probe {
public:
    EmbreeDevice(int threads, int width, KernelChoice kernels)
        : width_(width),
          kernels_(kernels),
          limit_(allow_threads(threads)),
          arena_(threads > 0 ? threads : tbb::task_arena::automatic),
          device_(rtcNewDevice(nullptr)) {
        if (!device_) throw RenderError("cannot start Embree");
        // Workers start now. Later, creating a thread would wait for the dynamic loader while the image module is
        // opened in the background: 0.25 s before the first ray.
        arena_.execute([] {
            tbb::parallel_for(
                0, 64, [](int) {}, tbb::simple_partitioner());
        });
    }

    std::string name() const override {
        return fmt::format("cpu (Embree {}.{}.{}, {} lane{}, {} thread{})",
                           rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                           rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_VERSION_MINOR),
                           rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_VERSION_PATCH), width_,
                           width_ == 1 ? "" : "s", arena_.max_concurrency(), arena_.max_concurrency() == 1 ? "" : "s");
    }

    bool has_robust_rays() const override { return true; }

    void load(const Scene& scene, const Image* environment, const BuildSettings& build) override {
        const auto begin = std::chrono::steady_clock::now();
        arena_.execute([&] { scene_ = std::make_unique<EmbreeScene>(device_.get(), scene, environment, build); });
        statistics_.load_s = seconds_since(begin);
    }

    void set_frame(const SceneSnapshot& snapshot) override {
        const auto begin = std::chrono::steady_clock::now();
        arena_.execute([&] { scene_->set_frame(snapshot); });
        shutter_ = snapshot.shutter;
        part_weight_ = snapshot.weight;
        kernels::build_filter(snapshot.settings.filter, snapshot.settings.filter_radius, filter_);
        const double load_s = statistics_.load_s;
        statistics_ = {};
        statistics_.load_s = load_s;
        statistics_.set_frame_s = seconds_since(begin);
        statistics_.required = scene_->requirements();
        statistics_.compiled = compiled_set(snapshot.settings.integrator,
                                            kernels_ == KernelChoice::all ? kernels::requirement::kAll : scene_->requirements());
        statistics_.flattened_triangles = scene_->flat_triangles();
        statistics_.instances = scene_->instance_count();
        statistics_.moving_instances = scene_->moving_count();
        statistics_.structures = scene_->structures();
        statistics_.bending = count_bending(snapshot);
    }

    void render(const Pass& pass, Film& film) override {
        const auto begin = std::chrono::steady_clock::now();
        const kernels::Settings& settings = scene_->view().settings;
        shutter_.weight = sample_weight(shutter_, part_weight_, pass);
        const int columns = (film.width() + kTileEdge - 1) / kTileEdge,
                  rows = (film.height() + kTileEdge - 1) / kTileEdge;
        tbb::enumerable_thread_specific<Worker> workers([&] {
            Worker worker;
            worker.driver = make_tile_driver(width_, settings.integrator, statistics_.compiled);
            return worker;
        });
        std::atomic<int> done{0};
        arena_.execute([&] {
            tbb::parallel_for(0, columns * rows, [&](int tile) {
                if (pass.cancel && pass.cancel->load(std::memory_order_relaxed)) return;
                const FlushDenormals flush;
                render_tile(pass, (tile % columns) * kTileEdge, (tile / columns) * kTileEdge, film, workers.local());
                const int finished = ++done;
                if (pass.progress && finished % 16 == 0)
                    pass.progress(static_cast<double>(finished) / (columns * rows));
            });
        });
        for (const Worker& worker : workers) {
            statistics_.rays += worker.counters.rays;
            statistics_.dropped_samples += worker.counters.dropped;
            statistics_.pixel_samples += worker.samples;
        }
        statistics_.render_s += seconds_since(begin);
    }

    DeviceStatistics statistics() const override { return statistics_; }
    Probe* probe() override { return this; }

private:
    std::vector<SurfaceHit> look(std::span<const kernels::Vec2f> film_px, double time) override {
        std::vector<SurfaceHit> hits(film_px.size());
        for_each_ray(hits.size(), [&](std::size_t i) {
            hits[i] = SceneProbe<float>(scene_->view()).look(EmbreeTracer(*scene_, true), film_px[i], time);
        });
        return hits;
    }

    std::vector<char> occluded(std::span<const SurfaceRay> rays, double time) override {
        std::vector<char> answers(rays.size());
        for_each_ray(rays.size(), [&](std::size_t i) {
            answers[i] = SceneProbe<float>(scene_->view()).occluded(EmbreeTracer(*scene_, true), rays[i], time);
        });
        return answers;
    }

    int light_count() const override { return SceneProbe<float>(scene_->view()).light_count(); }

    std::vector<LightSight> towards_lights(std::span<const LightRay> rays, double time) override {
        std::vector<LightSight> answers(rays.size());
        for_each_ray(rays.size(), [&](std::size_t i) {
            answers[i] = SceneProbe<float>(scene_->view()).towards_light(EmbreeTracer(*scene_, true), rays[i], time);
        });
        return answers;
    }

    template <class Ask>
    void for_each_ray(std::size_t count, const Ask& ask) {
        arena_.execute([&] {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
                const FlushDenormals flush;
                for (std::size_t i = range.begin(); i < range.end(); ++i) ask(i);
            });
        });
    }

    void render_tile(const Pass& pass, int x0, int y0, Film& film, Worker& worker) const {
        TileJob job;
        job.scene = &scene_->view();
        job.flat = scene_->flat();
        job.instanced = scene_->instanced();
        job.filter = &filter_;
        job.shutter = &shutter_;
        job.x0 = x0;
        job.y0 = y0;
        job.x1 = std::min(x0 + kTileEdge, film.width());
        job.y1 = std::min(y0 + kTileEdge, film.height());
        job.surface_layers = film.layers().any_surface();
        job.half = pass.half;
        job.seed = kernels::seed_of_half(job.scene->settings.seed, pass.half);
        job.active = pass.active;
        job.film_width = film.width();
        if (!any_active(job)) return;
        job.centred = pass.total_samples == 1 && job.scene->settings.integrator == kernels::IntegratorKind::direct;
        for (int s = 0; s < pass.sample_count; s += kSamplesPerBatch) {
            if (pass.cancel && pass.cancel->load(std::memory_order_relaxed)) return;
            job.first_sample = pass.first_sample + s;
            job.sample_count = std::min(kSamplesPerBatch, pass.sample_count - s);
            worker.driver->render(job, *worker.result, worker.counters);
            accumulate(job, *worker.result, film, worker);
        }
    }

    static bool any_active(const TileJob& job) {
        if (!job.active) return true;
        for (int y = job.y0; y < job.y1; ++y)
            for (int x = job.x0; x < job.x1; ++x)
                if (job.is_active(x, y)) return true;
        return false;
    }

    /// Adds a batch to the film, in the order of the samples.
    static void accumulate(const TileJob& job, const TileResult& r, Film& film, Worker& worker) {
        int slot = 0;
        for (int y = job.y0; y < job.y1; ++y)
            for (int x = job.x0; x < job.x1; ++x) {
                if (!job.is_active(x, y)) {
                    slot += job.sample_count;
                    continue;
                }
                for (int s = 0; s < job.sample_count; ++s, ++slot) {
                    const float sum = r.radiance[0][slot] + r.radiance[1][slot] + r.radiance[2][slot];
                    if (!std::isfinite(sum)) {
                        ++worker.counters.dropped;
                        continue;
                    }
                    ++film.samples(x, y, job.half);
                    ++worker.samples;
                    Film::Beauty& beauty = film.beauty(x, y, job.half);
                    const float w = r.weight[slot] * r.light[slot];
                    if (film.weighted()) film.weight(x, y, job.half) += r.light[slot];
                    beauty.r += r.radiance[0][slot] * w;
                    beauty.g += r.radiance[1][slot] * w;
                    beauty.b += r.radiance[2][slot] * w;
                    beauty.alpha += r.alpha[slot] * w;
                    if (job.surface_layers) film.add_surface(x, y, surface_of(r, slot));
                }
            }
    }

    static Film::Surface surface_of(const TileResult& r, int slot) {
        const float light = r.light[slot];
        Film::Surface surface;
        for (int c = 0; c < 3; ++c) {
            surface.albedo[c] = r.albedo[c][slot] * light;
            surface.normal[c] = r.normal[c][slot] * light;
        }
        for (int c = 0; c < 2; ++c) surface.motion[c] = r.motion[c][slot] * light;
        if (!std::isfinite(r.depth[slot])) return surface;
        surface.depth = r.depth[slot] * light;
        surface.depth_weight = light;
        return surface;
    }

    int width_;
    KernelChoice kernels_;
    std::unique_ptr<tbb::global_control> limit_;
    tbb::task_arena arena_;
    EmbreeDeviceHandle device_;
    std::unique_ptr<EmbreeScene> scene_;
    kernels::FilterTable filter_{};
    kernels::Shutter shutter_;   ///< of the part at hand
    double part_weight_ = 1;
    DeviceStatistics statistics_;
};

}  // namespace

int best_width() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2") ? 8 : 1;
#else
    return 1;
#endif
}

std::unique_ptr<Device> make_embree_device(int threads, int width, KernelChoice kernels) {
    return std::make_unique<EmbreeDevice>(threads, width, kernels);
}

}  // namespace kadr
