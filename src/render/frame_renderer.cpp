#include "render/frame_renderer.h"

#include <algorithm>

#include "output/view.h"
#include "render/loaded_shot.h"
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

void stop_if_interrupted() {
    if (interrupt_requested()) throw Interrupted();
}

}  // namespace

void add(DeviceStatistics& sum, const DeviceStatistics& part) {
    sum.pixel_samples += part.pixel_samples;
    sum.rays += part.rays;
    sum.dropped_samples += part.dropped_samples;
    sum.load_s = part.load_s;
    sum.set_frame_s += part.set_frame_s;
    sum.render_s += part.render_s;
    sum.flattened_triangles = std::max(sum.flattened_triangles, part.flattened_triangles);
    sum.instances = std::max(sum.instances, part.instances);
    sum.moving_instances = std::max(sum.moving_instances, part.moving_instances);
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

Film& FrameRenderer::cleared_film(const ImageSpec& image, const FilmLayers& layers, bool weighted) {
    const bool fits = film_ && film_->width() == image.width && film_->height() == image.height && film_->layers() == layers;
    if (!fits) film_.emplace(image.width, image.height, layers);
    film_->clear(weighted);
    return *film_;
}

RenderedFrame FrameRenderer::render(const BoundShot& shot, const FrameTime& time, const FilmLayers& layers,
                                    const std::function<void(double)>& progress) {
    stop_if_interrupted();
    const Stopwatch watch;
    RenderedFrame frame = render(shot, make_snapshots(shot, time), layers, progress);
    frame.time_s = time.time_s();
    frame.seconds = watch.seconds();
    return frame;
}

RenderedFrame FrameRenderer::render(const BoundShot& shot, const std::vector<SceneSnapshot>& parts, const FilmLayers& layers,
                                    const std::function<void(double)>& progress) {
    stop_if_interrupted();
    const Stopwatch watch;
    RenderedFrame frame;
    frame.motion = motion_report(shot, parts);
    const int total = shot.shot().render.samples;
    const std::vector<SampleRange> ranges = deal_samples(weights_of(parts), total);
    Film& film = cleared_film(shot.shot().image, layers, needs_weights(parts, ranges, total));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (ranges[i].count == 0) continue;
        device_->set_frame(parts[i]);
        Pass pass;
        pass.first_sample = ranges[i].first;
        pass.sample_count = ranges[i].count;
        pass.total_samples = total;
        pass.dealt_share = static_cast<double>(ranges[i].count) / total;
        pass.cancel = &interrupt_requested();
        if (progress)
            pass.progress = [&, range = ranges[i]](double fraction) {
                progress((range.first + fraction * range.count) / total);
            };
        device_->render(pass, film);
        add(frame.statistics, device_->statistics());
        frame.light_error = std::max(frame.light_error, parts[i].light_error);
        stop_if_interrupted();
    }
    frame.image = film.develop();
    expose(frame.image, exposure_factor(shot.shot().shutter, shot.timing().fps));
    frame.seconds = watch.seconds();
    return frame;
}

double meter_exposure(const Shot& shot, const Scene& scene, FrameRenderer& renderer, const FrameTime& first) {
    Shot small = shot;
    small.image = limited_width(small.image, kMeterWidth);
    small.render.samples = std::min(small.render.samples, kMeterSamples);
    const BoundShot bound(small, scene);
    return metered_exposure(renderer.render(bound, first, FilmLayers{}).image);
}

}  // namespace kadr
