#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "output/frame_writer.h"
#include "output/image_io.h"
#include "render/environment_image.h"
#include "render/frame_identity.h"
#include "render/frame_renderer.h"
#include "render/loaded_shot.h"
#include "render/output_plan.h"
#include "render/render_job.h"
#include "render/stopwatch.h"

namespace kadr {
namespace {

constexpr int kPreviewSamples = 4, kPreviewWidth = 640;

Shot preview_shot(const RenderOptions& options) {
    Shot shot = parse_shot(options.shot, options.overrides);
    if (options.overrides.samples == 0) shot.render.samples = std::min(shot.render.samples, kPreviewSamples);
    if (options.overrides.width == 0) shot.image = limited_width(shot.image, kPreviewWidth);
    return shot;
}

FrameTime preview_time(const PreviewOptions& options, const BoundShot& shot) {
    if (options.time_s) return shot.sequence().at_time(*options.time_s);
    return shot.sequence().frame(options.frame.value_or(shot.timing().frames.front()));
}

std::filesystem::path preview_file(const PreviewOptions& options, const Shot& shot, int frame) {
    if (!options.output.empty()) return frame_path(options.output.string(), frame);
    return fmt::format("{}.{:04}.preview.png", shot.name, frame);
}

ViewSpec preview_view(const LoadedShot& shot, FrameRenderer& renderer) {
    ViewSpec view = shot.shot().view;
    if (!view.automatic) return view;
    const FrameTime first = shot.bound().sequence().frame(shot.bound().timing().frames.front());
    view.exposure_stops = meter_exposure(shot.shot(), shot.scene(), renderer, first);
    view.automatic = false;
    return view;
}

}  // namespace

FrameReport preview_frame(const PreviewOptions& options, const RenderEvents& events) {
    const Stopwatch watch;
    // The device first: it starts its threads, which would wait for the image module while that is being opened.
    const DeviceChoice choice = make_device(options.render.device);
    open_image_io_in_background();
    const LoadedShot loaded(preview_shot(options.render));
    for (const Diagnostic& warning : loaded.warnings()) events.warning(warning);
    load_device(*choice.device, loaded);
    FrameRenderer renderer(*choice.device);

    const FrameTime time = preview_time(options, loaded.bound());
    const std::filesystem::path file = preview_file(options, loaded.shot(), time.number);
    prepare_folders({std::filesystem::absolute(file).parent_path()});
    const FilmLayers layers = is_linear_file(file) ? film_layers(loaded.shot().output.aovs) : FilmLayers{};
    const ViewSpec view = preview_view(loaded, renderer);
    const RenderedFrame frame = renderer.render(
        loaded.bound(), time, layers, [&](double fraction) { events.frame_progress(time.number, fraction, 0); });
    // No settings hash: a preview never passes for a frame of the shot.
    write_frame(file, frame.image, view, loaded.shot().output.png_bits,
                frame_metadata(loaded.shot(), time, frame, choice.device->name()));

    FrameReport report;
    report.frame = time.number;
    report.seconds = watch.seconds();
    report.samples = frame.statistics.pixel_samples;
    report.dropped = frame.statistics.dropped_samples;
    report.motion_error_px = frame.motion_error_px;
    report.files = {file};
    report.device = frame.statistics;
    events.frame_done(report);
    return report;
}

}  // namespace kadr
