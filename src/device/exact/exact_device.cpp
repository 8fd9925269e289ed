#include "device/exact/exact_device.h"

#include <chrono>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "device/exact/exact_scene.h"
#include "device/exact/exact_tracer.h"
#include "device/sample_weight.h"
#include "device/tables/scene_probe.h"
#include "frame/bindings.h"
#include "kernels/camera/filter_table.h"
#include "kernels/sampler/sobol.h"

namespace kadr {
namespace {

using Params = kernels::LaunchParamsOf<double>;

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// A pass's sums of every pixel.
struct Sums {
    explicit Sums(const Film& film)
        : beauty(pixels(film)), samples(pixels(film)), weights(film.weighted() ? pixels(film) : 0) {}
    static std::size_t pixels(const Film& film) { return static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height()); }

    kernels::FilmView view() { return {beauty.data(), samples.data(), weights.empty() ? nullptr : weights.data(), nullptr, nullptr, nullptr, nullptr, nullptr}; }
    void add_to(Film& film, int half) const {
        for (int y = 0; y < film.height(); ++y)
            for (int x = 0; x < film.width(); ++x) {
                const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width()) + static_cast<std::size_t>(x);
                Film::Beauty& sum = film.beauty(x, y, half);
                sum = {sum.r + beauty[at].r, sum.g + beauty[at].g, sum.b + beauty[at].b, sum.alpha + beauty[at].alpha};
                film.samples(x, y, half) += samples[at];
                if (!weights.empty()) film.weight(x, y, half) += weights[at];
            }
    }

    std::vector<kernels::FilmBeauty> beauty;
    std::vector<unsigned> samples;
    std::vector<double> weights;
};

class ExactDevice final : public Device, private Probe {
public:
    explicit ExactDevice(const BoundShot& shot) : shot_(shot) {}

    std::string name() const override { return "exact (double precision)"; }

    void load(const Scene& scene, const Image* environment, const BuildSettings&) override {
        meshes_ = std::make_unique<ExactMeshes>(scene);
        if (environment) environment_ = EnvironmentTables(*environment);
    }

    void set_frame(const SceneSnapshot& snapshot) override {
        if (!snapshot.deformed.empty())
            throw InputError("the reference in double does not follow meshes that bend", "expected a shot without skins and morph targets");
        snapshot_ = snapshot;
        kernels::build_filter(snapshot.settings.filter, snapshot.settings.filter_radius, filter_);
        still_.reset();
        statistics_ = {};
        statistics_.instances = snapshot.instances.size();
        if (stands_still()) still_ = scene_at(0);
    }

    void render(const Pass& pass, Film& film) override {
        const auto begin = std::chrono::steady_clock::now();
        kernels::Shutter shutter = snapshot_.shutter;
        shutter.weight = sample_weight(shutter, snapshot_.weight, pass);
        Sums sums(film);
        Params params{};
        params.filter = &filter_;
        params.shutter = &shutter;
        params.active = pass.active;
        params.film = sums.view();
        params.seed = kernels::seed_of_half(snapshot_.settings.seed, pass.half);
        params.x1 = film.width();
        params.y1 = film.height();
        params.centred = pass.total_samples == 1 && snapshot_.settings.integrator == kernels::IntegratorKind::direct;
        tbb::enumerable_thread_specific<kernels::LaunchCounters> counters(kernels::LaunchCounters{});
        tbb::parallel_for(0, film.height(), [&](int y) {
            if (pass.cancel && pass.cancel->load(std::memory_order_relaxed)) return;
            render_line(params, pass, y, counters.local());
        });
        sums.add_to(film, pass.half);
        for (const kernels::LaunchCounters& c : counters) {
            statistics_.rays += c.rays;
            statistics_.pixel_samples += c.samples;
            statistics_.dropped_samples += c.dropped;
        }
        statistics_.render_s += seconds_since(begin);
    }

    DeviceStatistics statistics() const override { return statistics_; }
    Probe* probe() override { return this; }

private:
    std::vector<SurfaceHit> look(std::span<const kernels::Vec2f> film_px, double time) override {
        const std::unique_ptr<ExactScene> scene = scene_at(time);
        std::vector<SurfaceHit> hits(film_px.size());
        tbb::parallel_for(std::size_t{0}, hits.size(), [&](std::size_t i) {
            hits[i] = SceneProbe<double>(scene->view()).look(ExactTracer(*scene, true), film_px[i], time);
        });
        return hits;
    }

    std::vector<char> occluded(std::span<const SurfaceRay> rays, double time) override {
        const std::unique_ptr<ExactScene> scene = scene_at(time);
        std::vector<char> answers(rays.size());
        tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t i) {
            answers[i] = SceneProbe<double>(scene->view()).occluded(ExactTracer(*scene, true), rays[i], time);
        });
        return answers;
    }

    int light_count() const override { return SceneProbe<double>(scene_at(0)->view()).light_count(); }

    std::vector<LightSight> towards_lights(std::span<const LightRay> rays, double time) override {
        const std::unique_ptr<ExactScene> scene = scene_at(time);
        std::vector<LightSight> answers(rays.size());
        tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t i) {
            answers[i] = SceneProbe<double>(scene->view()).towards_light(ExactTracer(*scene, true), rays[i], time);
        });
        return answers;
    }

    /// Whether all samples of the part see the same.
    bool stands_still() const {
        if (!(snapshot_.close_s > snapshot_.open_s)) return true;
        if (snapshot_.camera_keys.size() > 1) return false;
        for (const LightKeys& light : snapshot_.lights)
            if (light.count > 1) return false;
        for (const kernels::TransformHeader& header : snapshot_.motion.headers)
            if (header.frame_count > 1) return false;
        return true;
    }

    std::unique_ptr<ExactScene> scene_at(double time) const {
        auto scene = std::make_unique<ExactScene>(shot_, *meshes_, environment_, snapshot_);
        scene->move_to(time);
        return scene;
    }

    void render_line(const Params& frame, const Pass& pass, int y, kernels::LaunchCounters& counters) const {
        std::unique_ptr<ExactScene> own = still_ ? nullptr : scene_at(0);
        Params params = frame;
        params.sample_count = 1;
        for (int x = 0; x < frame.x1; ++x)
            for (int s = 0; s < pass.sample_count; ++s) {
                params.first_sample = pass.first_sample + s;
                params.scene = (own ? *own : *still_).view();
                if (!kernels::is_wanted(params, x, y)) continue;
                if (own) {
                    own->move_to(time_of(params, x, y));
                    params.scene = own->view();
                }
                render_sample(own ? *own : *still_, params, x, y, counters);
            }
    }

    static double time_of(const Params& params, int x, int y) {
        return kernels::start_path<double>(params.scene, *params.filter, *params.shutter, params.seed, params.centred, x, y,
                                           static_cast<unsigned>(params.first_sample))
            .path.time;
    }

    static void render_sample(const ExactScene& scene, const Params& params, int x, int y, kernels::LaunchCounters& counters) {
        using namespace kernels;
        constexpr unsigned kEverything = requirement::kAll & ~requirement::kDeformation;
        const bool direct = params.scene.settings.integrator == IntegratorKind::direct;
        ExactTracer tracer(scene, direct);
        if (direct)
            PixelDriver<double, kEverything, IntegratorKind::direct, ExactTracer>(params, tracer, x, y).render(counters);
        else
            PixelDriver<double, kEverything, IntegratorKind::path, ExactTracer>(params, tracer, x, y).render(counters);
    }

    const BoundShot& shot_;
    std::unique_ptr<ExactMeshes> meshes_;
    EnvironmentTables environment_;
    SceneSnapshot snapshot_;
    std::unique_ptr<ExactScene> still_;  ///< null: something moves while the part is exposed
    kernels::FilterTable filter_{};
    DeviceStatistics statistics_;
};

}  // namespace

std::unique_ptr<Device> make_exact_device(const BoundShot& shot) { return std::make_unique<ExactDevice>(shot); }

}  // namespace kadr
