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
          api_(parts.api),
          memory_(current(*runtime_)),
          stream_(*runtime_),
          uploads_(*runtime_, stream_),
          context_(api_, *runtime_, parts.cache_folder),
          functions_(context_),
          kernels_(context_, std::move(parts.kernel_folder)),
          choice_(parts.kernels),
          builder_(context_, memory_, stream_),
          film_(memory_, stream_),
          launches_(*runtime_, stream_) {}

    ~HiprtDevice() override { report(runtime_->make_current(), "use the GPU"); }

    std::string name() const override {
        return fmt::format("hiprt ({}, HIPRT API {})", runtime_->properties().name, hiprt::kApiVersion);
    }

    /// Structures are built once and traced in every frame: medium is as good as high here. low is HIPRT's fastest.
    void load(const Scene& scene, const Image* environment, const BuildSettings& build) override {
        if (build.robust == BuildSettings::Robust::required)
            throw InputError("--device hiprt: render.robust is true, but HIPRT tests triangles one by one, and rays slip between two that share an edge",
                             "use robust: false, or --device cpu");
        const auto begin = std::chrono::steady_clock::now();
        current(*runtime_);
        scene_.reset();
        with_memory("the scene",
                    [&] { scene_ = std::make_unique<HiprtScene>(scene, environment, builder_, uploads_); });
        if (build.quality == BuildQuality::low)
            while (scene_->quality() != StructureQuality::fast) scene_->lower_quality();
        stream_.synchronize("copy the scene to the GPU");
        statistics_.load_s = seconds_since(begin);
    }

    void set_frame(const SceneSnapshot& snapshot) override {
        const auto begin = std::chrono::steady_clock::now();
        current(*runtime_);
        with_memory("the frame", [&] { scene_->set_frame(snapshot); });
        stream_.synchronize("build the structures of the frame on the GPU");
        // Here and not when it renders: compiling takes long the first time, and is no part of what samples cost.
        const kernels::IntegratorKind integrator = scene_->view().settings.integrator;
        const unsigned set = kernels::kernel_requirements(
            integrator, choice_ == KernelChoice::all ? kernels::requirement::kAll : scene_->requirements());
        function_ = kernels_.get({integrator, set, scene_->asks_functions()});
        shutter_ = snapshot.shutter;
        part_weight_ = snapshot.weight;
        kernels::build_filter(snapshot.settings.filter, snapshot.settings.filter_radius, filter_);
        const double load_s = statistics_.load_s;
        statistics_ = {};
        statistics_.load_s = load_s;
        statistics_.required = scene_->requirements();
        statistics_.compiled = set;
        statistics_.instances = scene_->instance_count();
        statistics_.moving_instances = scene_->moving_count();
        statistics_.structures = scene_->structures();
        statistics_.set_frame_s = seconds_since(begin);
    }

    void render(const Pass& pass, Film& film) override {
        const auto begin = std::chrono::steady_clock::now();
        current(*runtime_);
        const kernels::LaunchParams params = params_of(pass, film);
        int done = 0;
        while (done < film.height()) {
            const int end = begin_rows(film, done);
            if (!render_rows(params, pass, film, done, end)) break;
            done = end;
        }
        add_counters();
        statistics_.render_s += seconds_since(begin);
    }

    DeviceStatistics statistics() const override { return statistics_; }

private:
    /// Runs what may not fit into memory, with less and less around it: first the film is given back, to come in
    /// smaller parts; then structures are built at lower quality.
    template <class Action>
    void with_memory(const char* what, const Action& action) {
        std::string steps;
        while (true) {
            try {
                return action();
            } catch (const GpuOutOfMemory& error) {
                if (film_.give_back())
                    steps += "; the film was given back";
                else if (scene_ && scene_->lower_quality())
                    steps += "; structures were built at lower quality";
                else
                    throw RenderError(
                        fmt::format("the memory of the GPU does not hold {}: {}{}", what, error.what(), steps));
            }
        }
    }

    kernels::LaunchParams params_of(const Pass& pass, const Film& film) {
        const kernels::Settings& settings = scene_->view().settings;
        shutter_.weight = sample_weight(shutter_, part_weight_, pass);
        shutter_table_.set(memory_, uploads_, {&shutter_, 1});
        filter_table_.set(memory_, uploads_, {&filter_, 1});
        const std::size_t pixels = static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height());
        if (pass.active) active_.set(memory_, uploads_, {pass.active, pixels});
        counters_.set(memory_, uploads_, std::vector<kernels::LaunchCounters>(1, kernels::LaunchCounters{}));
        kernels::LaunchParams params{};
        params.scene = scene_->view();
        params.top = scene_->top();
        params.functions = scene_->asks_functions() ? functions_.handle() : nullptr;
        params.instance_of = scene_->instance_of();
        params.filter = filter_table_.data();
        params.shutter = shutter_table_.data();
        params.active = pass.active ? active_.data() : nullptr;
        params.counters = static_cast<kernels::LaunchCounters*>(counters_.pointer());
        params.seed = kernels::seed_of_half(settings.seed, pass.half);
        params.ray_mask = hiprt::kFullRayMask;
        params.centred = pass.total_samples == 1 && settings.integrator == kernels::IntegratorKind::direct;
        return params;
    }

    /// Takes memory for as many rows as there is room for. @return the row behind them
    int begin_rows(const Film& film, int first) {
        while (true) {
            const int end = std::min(film.height(), first + std::min(most_rows_, film.height()));
            try {
                film_.begin(film, first, end);
                return end;
            } catch (const GpuOutOfMemory&) {
                if (end - first == 1) throw;
                film_.give_back();
                most_rows_ = (end - first + 1) / 2;
            }
        }
    }

    /// @return whether they were rendered to their end
    bool render_rows(kernels::LaunchParams params, const Pass& pass, Film& film, int first, int end) {
        params.film = film_.view();
        const LaunchPiece rows{0, first, film.width(), end, pass.first_sample, pass.sample_count};
        const auto progress = [&](double done) {
            if (pass.progress) pass.progress((first + done * (end - first)) / film.height());
        };
        if (!launches_.run(function_, params, rows, pass.cancel, progress)) return false;
        film_.add_to(film, pass.half);
        return true;
    }

    void add_counters() {
        const PinnedMemory back(*runtime_, sizeof(kernels::LaunchCounters));
        check(runtime_->download(back.data(), reinterpret_cast<DeviceAddress>(counters_.pointer()),
                                 sizeof(kernels::LaunchCounters), stream_.handle()),
              "read the counters back from the GPU");
        stream_.synchronize("render on the GPU");
        const auto& counters = *reinterpret_cast<const kernels::LaunchCounters*>(back.data());
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
    hiprt::Api api_;
    GpuMemory memory_;
    GpuStream stream_;
    UploadQueue uploads_;
    HiprtContext context_;
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
    std::unique_ptr<HiprtScene> scene_;

    int most_rows_ = 1 << 30;             ///< of the film that are on the GPU at a time; learned when memory runs out
    hiprt::Function function_ = nullptr;  ///< of the frame at hand
    kernels::FilterTable filter_{};
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
