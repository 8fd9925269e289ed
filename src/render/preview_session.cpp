#include "render/preview_session.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/version.h"
#include "output/frame_writer.h"
#include "output/view.h"
#include "render/denoising.h"
#include "render/environment_image.h"
#include "render/frame_identity.h"

namespace kadr {
namespace {

constexpr int kPreviewSamples = 4;

/// The device first: it starts its threads, which would wait for the image module while that is being opened.
DeviceChoice open_device(const DeviceRequest& request) {
    DeviceChoice choice = make_device(request);
    open_image_io_in_background();
    return choice;
}

Shot preview_shot(const RenderOptions& options, const std::function<void(Shot&)>& adjust) {
    Shot shot = parse_shot(options.shot, options.overrides);
    if (options.overrides.samples == 0) shot.render.fix_samples(std::min(shot.render.samples, kPreviewSamples));
    adjust(shot);
    return shot;
}

}  // namespace

PreviewSession::PreviewSession(const RenderOptions& options, const RenderEvents& events,
                               const std::function<void(Shot&)>& adjust)
    : events_(events),
      choice_(open_device(options.device)),
      device_name_(choice_.device->name()),
      loaded_(preview_shot(options, adjust)),
      renderer_(*choice_.device),
      view_(loaded_.shot().view) {
    choice_.device->watch({events_.compiling, &interrupt_requested()});
    for (const Diagnostic& warning : loaded_.warnings()) events_.warning(warning);
    denoiser_of(shot().render);  // a missing one is known before the first ray
    load_device(*choice_.device, loaded_);
}

FrameTime PreviewSession::checked(const FrameTime& time) const {
    const double lead_s = shot().output.has(Aov::motion) ? 1 / bound().timing().fps.value() : 0;  // the layer looks at the frame before
    std::vector<Diagnostic> problems = values_out_of_range(shot().limited_tracks, bound().timing(), time, lead_s);
    if (!problems.empty()) throw InputError(std::move(problems));
    return time;
}

ViewSpec PreviewSession::view(double time_s) {
    if (!view_.automatic) return view_at(view_, time_s);
    view_.exposure_stops = meter_exposure(shot(), loaded_.scene(), renderer_, frame(bound().timing().frames.front()));
    view_.automatic = false;
    return view_;
}

RenderedFrame PreviewSession::render(const BoundShot& shot, const FrameTime& time, const FilmLayers& layers,
                                     int frames_left) {
    RenderedFrame frame = renderer_.render(
        shot, time, {layers, view_at(view_, time.time_s()), [&](double fraction) { events_.frame_progress(time.number, fraction, frames_left); }, {}, {}});
    report_.samples += frame.statistics.pixel_samples;
    report_.sampling = frame.sampling;
    report_.dropped += frame.statistics.dropped_samples;
    report_.motion_error_px = std::max(report_.motion_error_px, frame.motion.largest_px());
    add(report_.device, frame.statistics);
    return frame;
}

Image PreviewSession::picture(const RenderedFrame& frame) { return apply_view(frame.image, view(frame.time_s), false); }

Image PreviewSession::picture(const FrameTime& time, int frames_left) {
    return picture(render(bound(), time, FilmLayers{}, frames_left));
}

FrameReport PreviewSession::report() const {
    FrameReport report = report_;
    report.seconds = watch_.seconds();
    return report;
}

Metadata PreviewSession::metadata(const std::string& kind, const std::vector<int>& frames) const {
    Metadata metadata = shot_metadata(shot(), device_name_);
    metadata["preview"] = kind;
    metadata["frames"] = fmt::format("{}", fmt::join(frames, ","));
    metadata["seconds"] = fmt::format("{:.3f}", watch_.seconds());
    return metadata;
}

void PreviewSession::write(const std::filesystem::path& file, const Image& picture, const Metadata& metadata) const {
    ViewSpec as_it_is;
    as_it_is.transform = ViewTransform::none;
    write_frame(file, picture, as_it_is, shot().output.png_bits, metadata);
}

}  // namespace kadr
