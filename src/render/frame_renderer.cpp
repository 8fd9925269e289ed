#include "render/frame_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "output/view.h"
#include "render/denoising.h"
#include "render/frame_memory.h"
#include "render/loaded_shot.h"
#include "render/pilot_mask.h"
#include "render/render_job.h"
#include "render/sample_shares.h"
#include "render/stopwatch.h"

namespace kadr {
namespace {

// Enough for a log-average; the value is a function of the shot alone, so any small number would do.
constexpr int kMeterWidth = 160, kMeterSamples = 16;

std::vector<double> weights_of(const std::vector<SceneSnapshot>& parts) {
    std::vector<double> weights;
    for (const SceneSnapshot& part : parts) weights.push_back(part.weight);
    return weights;
}

/// Whether samples of different parts, or of different lines, stand for different amounts of light.
bool needs_weights(const std::vector<SceneSnapshot>& parts, const std::vector<SampleRange>& ranges, int total) {
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (!parts[i].shutter.plain || static_cast<float>(parts[i].weight * total) != static_cast<float>(ranges[i].count)) return true;
    return false;
}

/// Multiplies the radiance of a physical exposure; coverage and data layers stay.
void expose(Image& image, double factor) {
    if (factor == 1) return;
    constexpr std::size_t kColors = 3;
    for (std::size_t i = 0; i < image.pixels.size(); i += image.channels.size())
        for (std::size_t c = 0; c < kColors; ++c) image.pixels[i + c] *= static_cast<float>(factor);
}

/// Devices measure in the units of their snapshots; the layer is metres.
void scale_depth(Image& image, double unit_m) {
    const auto depth = std::find(image.channels.begin(), image.channels.end(), "depth.Z");
    if (unit_m == 1 || depth == image.channels.end()) return;
    const std::size_t channels = image.channels.size(), at = static_cast<std::size_t>(depth - image.channels.begin());
    for (std::size_t i = at; i < image.pixels.size(); i += channels) image.pixels[i] *= static_cast<float>(unit_m);
}

constexpr int kLeastPilotSamples = 16;  // fewer say little of how errors fall, and what a round takes beside them is most of its time

void stop_if_interrupted() {
    if (interrupt_requested()) throw Interrupted();
}

}  // namespace

void add(DeviceStatistics& sum, const DeviceStatistics& part) {
    sum.required |= part.required;
    sum.compiled |= part.compiled;
    sum.pixel_samples += part.pixel_samples;
    sum.rays += part.rays;
    sum.dropped_samples += part.dropped_samples;
    sum.load_s = part.load_s;
    sum.set_frame_s += part.set_frame_s;
    sum.staged += part.staged;
    if (!part.memory_steps.empty()) sum.memory_steps = part.memory_steps;
    sum.render_s += part.render_s;
    sum.flattened_triangles = std::max(sum.flattened_triangles, part.flattened_triangles);
    sum.instances = std::max(sum.instances, part.instances);
    sum.moving_instances = std::max(sum.moving_instances, part.moving_instances);
    sum.bending.meshes = std::max(sum.bending.meshes, part.bending.meshes);
    sum.bending.by_kernels = std::max(sum.bending.by_kernels, part.bending.by_kernels);
    sum.bending.blurred = std::max(sum.bending.blurred, part.bending.blurred);
    sum.bending.keys = std::max(sum.bending.keys, part.bending.keys);
    sum.structures.built += part.structures.built;
    sum.structures.updated += part.structures.updated;
    sum.structures.kept += part.structures.kept;
}

FilmLayers film_layers(const std::vector<Aov>& aovs) {
    const auto has = [&](Aov aov) { return std::find(aovs.begin(), aovs.end(), aov) != aovs.end(); };
    FilmLayers layers;
    layers.albedo = has(Aov::albedo);
    layers.normal = has(Aov::normal);
    layers.depth = has(Aov::depth);
    layers.motion = has(Aov::motion);
    layers.samples = has(Aov::samples);
    layers.error = has(Aov::error);
    return layers;
}

Film& FrameRenderer::cleared_film(const Shot& shot, const FilmLayers& layers, int halves, bool weighted) {
    const int width = shot.image.width, height = shot.image.height;
    const bool fits = film_ && film_->width() == width && film_->height() == height && film_->layers() == layers && film_->halves() == halves;
    if (fits) {
        film_->clear(weighted);
    } else {
        film_.reset();  // before there are two
        film_.emplace(width, height, layers, halves, weighted);
    }
    return *film_;
}

Image FrameRenderer::developed() {
    const std::uint64_t pixels = static_cast<std::uint64_t>(film_->width()) * static_cast<std::uint64_t>(film_->height());
    if (pixels * Film::bytes_per_pixel(film_->layers(), film_->halves(), film_->weighted()) <= kMostFilmKept) return film_->develop();
    Image image = Film::develop(std::move(*film_));
    film_.reset();
    return image;
}

/// The rounds of samples of one frame.
class FrameRenderer::Rounds {
public:
    using Parts = std::shared_ptr<const std::vector<SceneSnapshot>>;

    /// @param rounds  there may be more than one
    Rounds(Device& device, Film& film, Parts parts, const FrameRequest& request, bool rounds, RenderedFrame& frame)
        : device_(device), film_(film), held_(std::move(parts)), parts_(*held_), weights_(weights_of(parts_)), request_(request), rounds_(rounds), frame_(frame) {}

    /// Deals the samples of a round to the parts of the shutter, and those of each part to the halves of the film: both
    /// halves see all parts, as far as there are two samples for them. Every other round goes through the parts backwards,
    /// so that it begins with the one that is set.
    void render(int count, const std::uint8_t* active, bool only_sample, const std::function<void(double)>& progress) {
        const std::vector<SampleRange> ranges = deal_samples(weights_, count);
        int odd = 0, done = 0;
        for (std::size_t step = 0; step < parts_.size(); ++step) {
            const std::size_t i = part_at(step);
            if (ranges[i].count == 0) continue;
            set_part(i);
            next_part_ = part_after(step, ranges);
            const int larger = (ranges[i].count + 1) / 2, smaller = ranges[i].count - larger;
            const int counts[Film::kHalves] = {odd == 0 ? larger : smaller, odd == 0 ? smaller : larger};
            odd ^= ranges[i].count % 2;
            for (int half = 0; half < Film::kHalves; ++half) {
                if (counts[half] == 0) continue;
                Pass pass;
                pass.half = half;
                pass.active = active;
                pass.first_sample = first_[half];
                pass.sample_count = counts[half];
                pass.total_samples = only_sample ? 1 : std::max(count, 2);
                pass.dealt_share = static_cast<double>(ranges[i].count) / count;
                pass.cancel = &interrupt_requested();
                if (progress)
                    pass.progress = [&, done, n = counts[half]](double fraction) { progress((done + fraction * n) / count); };
                pass.idle = [&] { stage_next(); };
                device_.render(pass, film_);
                first_[half] += counts[half];
                done += counts[half];
                stop_if_interrupted();
            }
        }
        backwards_ = !backwards_;
    }

    /// Sets the part that the first round begins with.
    void prepare() { set_part(0); }

    /// Adds up what the device counted since the last part was set. Call once more after the last round.
    void gather() {
        if (part_) add(frame_.statistics, device_.statistics());
        part_.reset();
    }

private:
    std::size_t part_at(std::size_t step) const { return backwards_ ? parts_.size() - 1 - step : step; }

    /// The part that this round goes on with.
    std::optional<std::size_t> part_after(std::size_t step, const std::vector<SampleRange>& ranges) const {
        for (++step; step < parts_.size(); ++step)
            if (ranges[part_at(step)].count > 0) return part_at(step);
        return std::nullopt;
    }

    /// While the device renders: tells it what comes next, where that is known. After the last part of a round another one
    /// may follow, which begins with this part and goes on to the one before.
    void stage_next() {
        if (next_part_) return device_.stage({held_, &parts_[*next_part_]});
        if (!request_.next || (rounds_ && parts_.size() > 1)) return;
        if (const std::shared_ptr<const SceneSnapshot> next = request_.next()) device_.stage(next);
    }

    void set_part(std::size_t i) {
        if (part_ == i) return;
        gather();
        device_.set_frame(parts_[i]);
        part_ = i;
        frame_.light_error = std::max(frame_.light_error, parts_[i].light_error);
    }

    Device& device_;
    Film& film_;
    const Parts held_;
    const std::vector<SceneSnapshot>& parts_;
    const std::vector<double> weights_;
    const FrameRequest& request_;
    const bool rounds_;
    RenderedFrame& frame_;
    std::optional<std::size_t> part_, next_part_;
    bool backwards_ = false;
    int first_[Film::kHalves] = {0, 0};
};

FrameRenderer::FrameRenderer(Device& device, std::function<double()> clock) : device_(&device), clock_(std::move(clock)) {
    if (!clock_) clock_ = [watch = Stopwatch()] { return watch.seconds(); };
}

/// Of a frame whose budget looks at what its rounds take.
void revise_target(const FrameTarget& target, const Film& film, double scale, double seconds, const RenderSpec& spec, SampleSteering& steering) {
    if (!target.revise || steering.samples_so_far() == 0) return;
    const double relmse = mean_relative_error(film, scale);
    if (!(relmse > 0)) return;  // calm so far: nothing to learn from
    const FrameTarget revised = target.revise(seconds, relmse);
    steering.set_target(revised.relmse);
    steering.set_budget(std::min(revised.most_s, spec.time_budget_s.value_or(revised.most_s)));
}

RenderedFrame FrameRenderer::render(const BoundShot& shot, const FrameTime& time, const FrameRequest& request) {
    stop_if_interrupted();
    const Stopwatch watch;
    RenderedFrame frame = render(shot, std::make_shared<const std::vector<SceneSnapshot>>(make_snapshots(shot, time)), request);
    frame.time_s = time.time_s();
    frame.seconds = watch.seconds();
    return frame;
}

RenderedFrame FrameRenderer::render(const BoundShot& shot, const std::shared_ptr<const std::vector<SceneSnapshot>>& held, const FrameRequest& request) {
    stop_if_interrupted();
    check_frame_memory(shot.shot());
    const Stopwatch watch;
    const std::vector<SceneSnapshot>& parts = *held;
    RenderedFrame frame;
    frame.device = device_->name();
    frame.motion = motion_report(shot, parts);
    const RenderSpec& spec = shot.shot().render;
    const double begin_s = clock_(), scale = exposure_factor(shot.shot().shutter, shot.timing().fps);
    const ViewSpec view = request.view ? *request.view : shot.shot().view;
    double budget_s = spec.time_budget_s.value_or(std::numeric_limits<double>::infinity());
    if (request.target) budget_s = std::min(budget_s, request.target->most_s);
    SampleSteering steering(spec, budget_s, view, scale, [&] { return clock_() - begin_s; });
    if (request.target) steering.set_target(request.target->relmse);

    const bool steered = spec.max_error || std::isfinite(budget_s);
    const std::vector<SampleRange> all = deal_samples(weights_of(parts), spec.samples);
    Film& film = cleared_film(shot.shot(), layers_to_render(request.layers, spec), film_halves(spec, parts.size()), needs_weights(parts, all, spec.samples) || (steered && parts.size() > 1));
    device_->begin_film(film);
    Rounds rounds(*device_, film, held, request, steered, frame);
    const auto next_round = [&] {
        if (steering.looks_at_film()) device_->read_film(film);
        if (request.target) revise_target(*request.target, film, scale, clock_() - begin_s, spec, steering);
        return steering.next_round(film);
    };
    for (int count = 0, first = 0; (count = next_round()) > 0; first += count) {
        const double before = steered ? static_cast<double>(first) / spec.samples : 0, part = static_cast<double>(count) / (steered ? spec.samples : count);
        const auto progress = [&](double fraction) { request.progress(before + fraction * part); };
        rounds.render(count, steering.active(), spec.samples == 1, request.progress ? progress : std::function<void(double)>());
    }
    device_->read_film(film);
    rounds.gather();
    frame.sampling = report_sampling(film, steering.stopped_by(), view, scale);
    frame.image = developed();
    scale_depth(frame.image, parts.front().unit_m);
    denoise(frame.image, request.layers, spec);
    expose(frame.image, scale);
    frame.seconds = watch.seconds();
    return frame;
}

FrameForecast FrameRenderer::pilot(const BoundShot& shot, const std::shared_ptr<const std::vector<SceneSnapshot>>& held, const FilmLayers& layers,
                                   double most_s, DeviceStatistics& statistics) {
    const std::vector<SceneSnapshot>& parts = *held;
    const RenderSpec& spec = shot.shot().render;
    const double begin_s = clock_(), scale = exposure_factor(shot.shot().shutter, shot.timing().fps);
    Film& film = cleared_film(shot.shot(), layers_to_render(layers, spec), Film::kHalves, parts.size() > 1 || !parts.front().shutter.plain);
    device_->begin_film(film);
    const PilotMask mask = pilot_mask(film.width(), film.height());
    const double pixels = static_cast<double>(film.width()) * film.height();
    const FrameRequest nothing_follows;
    RenderedFrame frame;
    Rounds rounds(*device_, film, held, nothing_follows, true, frame);
    rounds.prepare();
    FrameForecast forecast;
    forecast.least_samples = std::min(spec.samples, SampleSteering::kTimingRound);
    forecast.most_samples = spec.samples;
    forecast.setup_s = clock_() - begin_s;
    // Up to a quarter or more of what the frame itself can have; beyond that the power of the last rounds goes on.
    for (int samples = 0, count = SampleSteering::kTimingRound; samples + count <= spec.samples; count = samples) {
        const double round_begin_s = clock_();
        rounds.render(count, mask.active.data(), false, {});
        device_->read_film(film);
        samples += count;
        // Of the last and longest round alone: what a round takes beside its samples is not thirty times as much in the frame.
        forecast.sample_s = (clock_() - round_begin_s) / count * pixels / mask.count;
        if (const double relmse = mean_relative_error(film, scale); relmse > 0)
            forecast.curve.push_back({static_cast<double>(samples), relmse});
        if (samples >= kLeastPilotSamples && forecast.setup_s + 4 * samples * forecast.sample_s > most_s) break;
    }
    if (forecast.curve.empty()) forecast.least_samples = std::min(spec.samples, spec.at_least);
    rounds.gather();
    add(statistics, frame.statistics);
    return forecast;
}

double meter_exposure(const Shot& shot, const Scene& scene, FrameRenderer& renderer, const FrameTime& first) {
    Shot small = shot;
    small.image = limited_width(small.image, kMeterWidth);
    small.render.fix_samples(std::min(small.render.samples, kMeterSamples));
    small.render.denoise = DenoiserKind::none;  // an average is none the worse for noise
    const BoundShot bound(small, scene);
    return metered_exposure(renderer.render(bound, first, {}).image);
}

}  // namespace kadr
