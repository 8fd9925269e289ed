#include "device/hiprt/hiprt_device.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "device/hiprt/gpu_film.h"
#include "device/hiprt/hiprt_scene.h"
#include "device/hiprt/launch_queue.h"
#include "device/hiprt/ray_probe.h"
#include "device/hiprt/shared_context.h"
#include "device/hiprt/trace_kernels.h"
#include "device/sample_weight.h"
#include "kernels/camera/filter_table.h"
#include "kernels/gpu/entry_points.h"
#include "kernels/sampler/sobol.h"

namespace kadr {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

GpuRuntime& current(GpuRuntime& runtime) {
    check(runtime.make_current(), "use the GPU");
    return runtime;
}

/// Kernels are compiled for compute capability 7.5 (kCudaOptions), which runs on every later one.
void check_architecture(const GpuProperties& gpu) {
    constexpr int kLeast = 75;
    if (gpu.vendor != GpuVendor::nvidia || gpu.compute >= kLeast) return;
    throw InputError(
        fmt::format("the GPU {} has compute capability {}.{}, and 7.5 is the least that our kernels are compiled for",
                    gpu.name, gpu.compute / 10, gpu.compute % 10));
}

class HiprtDevice final : public Device {
public:
    explicit HiprtDevice(HiprtParts parts)
        : runtime_(std::move(parts.runtime)),
          memory_(current(*runtime_)),
          stream_(*runtime_),
          scene_stream_(*runtime_),
          staged_(*runtime_),
          uploads_(*runtime_, stream_, DownloadQueue::kBlockBytes),
          scene_uploads_(*runtime_, scene_stream_, UploadQueue::kBlockBytes),
          downloads_(*runtime_, stream_),
          shared_(std::make_shared<SharedContext>(runtime_, parts.api, parts.cache_folder)),
          functions_(shared_->context),
          kernels_({shared_, &shared_->context}, std::move(parts.kernel_folder)),
          choice_(parts.kernels),
          builder_(shared_->context, memory_, scene_stream_),
          film_(memory_, uploads_, downloads_, stream_),
          launches_(*runtime_, stream_),
          probe_(memory_, uploads_, stream_, [this] { return probe_frame(); }) {}

    ~HiprtDevice() override { report(runtime_->make_current(), "use the GPU"); }

    std::string name() const override {
        return fmt::format("hiprt ({}, HIPRT API {})", runtime_->properties().name, hiprt::kApiVersion);
    }

    void watch(DeviceWatch watch) override { watch_ = std::move(watch); }
    bool compiles() const override { return true; }
    void prepare(const KernelSet& set) override {
        kernels_.begin(need_of(set.integrator, set.requirements, set.asks_functions));
    }

    /// Structures are built once and traced in every frame: medium is as good as high here. low is HIPRT's fastest.
    void load(const Scene& scene, const Image* environment, const BuildSettings& build) override {
        if (build.robust == BuildSettings::Robust::required)
            throw InputError("--device hiprt: render.robust is true, but HIPRT tests triangles one by one, and rays slip between two that share an edge",
                             "use robust: false, or --device cpu");
        const auto begin = std::chrono::steady_clock::now();
        current(*runtime_);
        scene_.reset();
        stages_ = true;
        memory_.forget_steps();
        with_memory("the scene",
                    [&] {
                        scene_ = std::make_unique<HiprtScene>(
                            scene, environment, builder_, scene_uploads_,
                            [this](kernels::Kernel kernel) { return kernels_.get({kernel, 0, false}, waiting()).function; });
                    });
        if (build.quality == BuildQuality::low)
            while (scene_->quality() != StructureQuality::fast) scene_->lower_quality();
        scene_stream_.synchronize("copy the scene to the GPU");
        statistics_.load_s = seconds_since(begin);
    }

    void set_frame(const SceneSnapshot& snapshot) override {
        const auto begin = std::chrono::steady_clock::now();
        current(*runtime_);
        bool staged = scene_->is_staged(snapshot);
        if (!staged) kernels_.wait(waiting());  // see TraceKernels: before structures are built
        with_memory("the frame", [&] { staged = scene_->set_frame(snapshot); });
        if (staged)
            stream_.wait_for(staged_);
        else
            scene_stream_.synchronize("build the structures of the frame on the GPU");
        const HiprtFrame& frame = scene_->frame();
        // Here and not when it renders: compiling takes long the first time, and is no part of what samples cost.
        kernel_ = kernels_.get(need_of(frame.view().settings.integrator, frame.requirements(), frame.asks_functions()), waiting());
        shutter_ = snapshot.shutter;
        part_weight_ = snapshot.weight;
        take_filter(snapshot.settings);
        const double load_s = statistics_.load_s;
        statistics_ = {};
        statistics_.load_s = load_s;
        statistics_.required = frame.requirements();
        statistics_.compiled = kernel_.compiled_for.requirements;
        statistics_.instances = frame.instance_count();
        statistics_.moving_instances = frame.moving_count();
        statistics_.structures = frame.structures();
        statistics_.staged = staged ? 1 : 0;
        statistics_.memory_steps = memory_.steps();
        statistics_.bending = frame.bending();
        statistics_.set_frame_s = seconds_since(begin);
    }

    /// By the thread that renders, between two launches: HIPRT's context is for one thread at a time, and this one would
    /// only wait. Copies and builds go on a stream of their own, for which the launches of that frame will wait.
    void stage(const std::shared_ptr<const SceneSnapshot>& next) override {
        if (!stages_ || !scene_ || scene_->is_staged(*next) || kernels_.is_compiling()) return;
        current(*runtime_);
        try {
            scene_->stage(next);
            staged_.record(scene_stream_);
        } catch (const GpuOutOfMemory&) {
            stop_staging();
        } catch (const InputError&) {  // it is said when it is that frame's turn
        }
    }

    void begin_film(Film& film) override { film_.begin(film); }

    void render(const Pass& pass, Film& film) override {
        const auto begin = std::chrono::steady_clock::now();
        current(*runtime_);
        const kernels::LaunchParams params = params_of(pass, film);
        int done = 0;
        while (done < film.height()) {
            const int end = film_.take_rows(film, pass.half, done);
            if (!render_rows(params, pass, film, done, end)) break;
            done = end;
        }
        add_counters();
        statistics_.render_s += seconds_since(begin);
    }

    void read_film(Film&) override {
        const auto begin = std::chrono::steady_clock::now();
        current(*runtime_);
        film_.read();
        statistics_.render_s += seconds_since(begin);
    }

    DeviceStatistics statistics() const override { return statistics_; }
    Probe* probe() override { return &probe_; }

private:
    /// What rays of any kind need: the frame at hand, without a film.
    kernels::LaunchParams frame_params(const TraceKernel& kernel) const {
        const HiprtFrame& frame = scene_->frame();
        kernels::LaunchParams params{};
        params.scene = frame.view();
        params.top = frame.top();
        params.functions = kernel.compiled_for.functions ? functions_.handle() : nullptr;
        params.instance_of = frame.instance_of();
        params.ray_mask = hiprt::kFullRayMask;
        return params;
    }

    RayProbe::Frame probe_frame() {
        current(*runtime_);
        const unsigned set = kernels::kernel_requirements(kernels::Kernel::probe, scene_->frame().requirements());
        const TraceKernel kernel =
            kernels_.get({kernels::Kernel::probe, set, scene_->frame().asks_functions()}, waiting());
        return {frame_params(kernel), kernel.function};
    }

    KernelNeed need_of(kernels::IntegratorKind integrator, unsigned requirements, bool functions) const {
        const unsigned wanted = choice_ == KernelChoice::all ? kernels::requirement::kAll : requirements;
        return {kernels::kernel_of(integrator), kernels::kernel_requirements(integrator, wanted), functions};
    }

    TraceKernels::Waiting waiting() const {
        return [this](double seconds) {
            if (watch_.cancel && watch_.cancel->load(std::memory_order_relaxed)) throw Interrupted();
            if (watch_.compiling) watch_.compiling(seconds);
        };
    }

    /// From here on to the end of the scene, one frame is on the GPU at a time. @return whether there were two
    bool stop_staging() {
        if (!scene_->drop_staged()) return false;
        stages_ = false;
        memory_.note_step("frames are no longer made ahead");
        return true;
    }

    /// Runs what may not fit into memory, with less and less around it: first the frame to come is dropped; then the film
    /// goes home, to come back in smaller parts; then structures are built at lower quality.
    template <class Action>
    void with_memory(const char* what, const Action& action) {
        std::string steps;
        while (true) {
            try {
                return action();
            } catch (const GpuOutOfMemory& error) {
                if (scene_ && stop_staging())
                    steps += "; frames are no longer made ahead";
                else if (film_.give_back())
                    steps += "; the film was given back";
                else if (scene_ && scene_->lower_quality()) {
                    steps += "; structures were built at lower quality";
                    memory_.note_step("structures of lower quality");
                } else
                    throw RenderError(
                        fmt::format("the memory of the GPU does not hold {}: {}{}", what, error.what(), steps));
            }
        }
    }

    kernels::LaunchParams params_of(const Pass& pass, const Film& film) {
        const HiprtFrame& frame = scene_->frame();
        const kernels::Settings& settings = frame.view().settings;
        shutter_.weight = sample_weight(shutter_, part_weight_, pass);
        const std::size_t pixels = static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height());
        shutter_table_.set_changed(memory_, uploads_, {&shutter_, 1});
        if (pass.active) active_.set_changed(memory_, uploads_, {pass.active, pixels});
        constexpr kernels::LaunchCounters kNone{};
        counters_.set(memory_, uploads_, {&kNone, 1});
        kernels::LaunchParams params = frame_params(kernel_);
        params.filter = filter_table_.data();
        params.shutter = shutter_table_.data();
        params.active = pass.active ? active_.data() : nullptr;
        params.counters = static_cast<kernels::LaunchCounters*>(counters_.pointer());
        params.seed = kernels::seed_of_half(settings.seed, pass.half);
        params.centred = pass.total_samples == 1 && settings.integrator == kernels::IntegratorKind::direct;
        return params;
    }

    /// Made and copied when the shot's filter is seen first.
    void take_filter(const kernels::Settings& settings) {
        if (filter_table_.data() && filter_kind_ == settings.filter && filter_radius_ == settings.filter_radius) return;
        kernels::FilterTable filter{};
        kernels::build_filter(settings.filter, settings.filter_radius, filter);
        filter_table_.set(memory_, uploads_, {&filter, 1});
        filter_kind_ = settings.filter;
        filter_radius_ = settings.filter_radius;
    }

    /// @return whether they were rendered to their end
    bool render_rows(kernels::LaunchParams params, const Pass& pass, Film& film, int first, int end) {
        params.film = film_.view(pass.half);
        const LaunchPiece rows{0, first, film.width(), end, pass.first_sample, pass.sample_count};
        const auto progress = [&](double done) {
            if (pass.progress) pass.progress((first + done * (end - first)) / film.height());
        };
        if (!launches_.run(kernel_.function, params, rows, pass.cancel, progress, pass.idle)) return false;
        film_.rows_done();
        return true;
    }

    void add_counters() {
        kernels::LaunchCounters counters{};
        downloads_.add(&counters, reinterpret_cast<DeviceAddress>(counters_.pointer()), sizeof counters);
        downloads_.finish();
        statistics_.rays += counters.rays;
        statistics_.pixel_samples += counters.samples;
        statistics_.dropped_samples += counters.dropped;
        if (counters.stack_overflows > 0)
            fmt::print(stderr,
                       "kadr: {} rays needed a deeper traversal stack than the GPU has; their samples were dropped\n",
                       counters.stack_overflows);
    }

    // In the order in which they rest on each other; freed in the reverse order.
    std::shared_ptr<GpuRuntime> runtime_;
    GpuMemory memory_;
    GpuStream stream_;        ///< renders
    GpuStream scene_stream_;  ///< copies and builds what is to be rendered
    GpuEvent staged_;         ///< on it: the frame to come is complete
    UploadQueue uploads_, scene_uploads_;
    DownloadQueue downloads_;
    std::shared_ptr<SharedContext> shared_;
    HiprtFunctionTable functions_;
    TraceKernels kernels_;
    KernelChoice choice_;
    StructureBuilder builder_;
    DeviceTable<kernels::Shutter> shutter_table_;
    DeviceTable<kernels::FilterTable> filter_table_;
    DeviceTable<std::uint8_t> active_{MemoryUse::film};
    DeviceTable<kernels::LaunchCounters> counters_;
    GpuFilm film_;
    LaunchQueue launches_;
    RayProbe probe_;
    std::unique_ptr<HiprtScene> scene_;

    bool stages_ = true;                  ///< the frame to come is made while one renders: there is memory for both
    TraceKernel kernel_;                  ///< of the frame at hand
    DeviceWatch watch_;
    kernels::FilterKind filter_kind_{};  ///< of what filter_table_ holds
    float filter_radius_ = 0;
    kernels::Shutter shutter_;  ///< of the part at hand
    double part_weight_ = 1;
    DeviceStatistics statistics_;
};

}  // namespace

std::unique_ptr<Device> make_hiprt_device(HiprtParts parts) {
    check_architecture(parts.runtime->properties());
    return std::make_unique<HiprtDevice>(std::move(parts));
}

}  // namespace kadr
