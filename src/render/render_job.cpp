#include "render/render_job.h"

#include <algorithm>
#include <exception>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/snapshot_key.h"
#include "output/encoder.h"
#include "output/frame_writer.h"
#include "output/image_io.h"
#include "render/delivery.h"
#include "render/denoising.h"
#include "render/environment_image.h"
#include "render/frame_cache.h"
#include "render/frame_identity.h"
#include "render/frame_renderer.h"
#include "render/loaded_shot.h"
#include "render/shot_budget.h"
#include "render/shot_pilot.h"
#include "render/output_plan.h"
#include "render/prepared_shot.h"
#include "render/stopwatch.h"
#include "shot/shot_parser.h"

namespace kadr {
namespace {

void replace_name(std::string& pattern, const std::string& name) {
    static const std::string kPlaceholder = "{name}";
    const std::size_t at = pattern.find(kPlaceholder);
    if (at != std::string::npos) pattern.replace(at, kPlaceholder.size(), name);
}

void add_default_video(Shot& shot, std::string file) {
    if (shot.output.video || file.empty()) return;
    replace_name(file, shot.name);
    shot.output.video.emplace();
    shot.output.video->file = std::filesystem::absolute(file);
}

/// The first frame of the shot itself, whatever part of it the command line renders.
int first_frame_of_shot(const RenderOptions& options, const LoadedShot& loaded) {
    if (options.overrides.frames.empty()) return loaded.bound().timing().frames.front();
    ShotOverrides whole = options.overrides;
    whole.frames.clear();
    const Shot shot = parse_shot(options.shot, whole);
    return BoundShot(shot, loaded.scene()).timing().frames.front();
}

/// One call of render_shot: members in the order in which they come to be.
class RenderJob {
public:
    RenderJob(PreparedShot prepared, const RenderOptions& options, const RenderEvents& events);
    RenderSummary run();

private:
    void warn(const std::vector<Diagnostic>& warnings);
    void open_output();
    void deliver(int frame, int frames_left);
    bool is_complete(const std::vector<std::filesystem::path>& files, const FrameIdentity& identity) const;
    Hash key_of(const std::vector<SceneSnapshot>& parts, const ViewSpec& view) const;
    FrameCache::Found find_or_render(const FrameTime& time, const ViewSpec& view, int frames_left);
    void render(DeliveryItem& item, const FrameTime& time, int frames_left);
    void load_device();
    void plan_budget();
    ViewSpec view_with_exposure(const FrameTime& time);
    void report_written();
    void warn_of_motion(const FrameReport& report);
    void finish();

    const RenderOptions& options_;
    const RenderEvents& events_;
    const bool view_wanted_;
    Stopwatch total_;
    RenderSummary summary_;
    std::optional<LoadedShot> loaded_;
    std::optional<VideoPlan> video_;
    std::optional<ShotIdentity> identity_;
    int metered_frame_ = 0;
    DeviceChoice device_;
    bool device_loaded_ = false;
    std::optional<FrameRenderer> renderer_;
    std::set<std::string> astray_;  ///< what has been warned of
    FrameCache cache_{kMostCachedBytes};
    double relmse_sum_ = 0;
    int relmse_frames_ = 0;
    ShotBudget budget_;
    std::optional<double> exposure_;
    std::optional<Delivery> delivery_;
};

RenderJob::RenderJob(PreparedShot prepared, const RenderOptions& options, const RenderEvents& events)
    : options_(options), events_(events), view_wanted_(prepared.view_wanted) {
    Shot& shot = prepared.shot;
    device_ = make_device(options.device);
    open_image_io_in_background();
    if (shot.output.video)
        video_ = plan_video(*shot.output.video, shot.image.width, shot.image.height, shot.timing.fps);
    loaded_.emplace(std::move(shot));
    denoiser_of(loaded_->shot().render);  // a missing one is known before anything is written
    if (loaded_->shot().view.automatic)
        metered_frame_ = prepared.metered_frame ? *prepared.metered_frame : first_frame_of_shot(options, *loaded_);
    identity_.emplace(*loaded_, metered_frame_);
    renderer_.emplace(*device_.device);
    budget_ = ShotBudget(loaded_->shot().render.time_budget_shot_s, [this] { return total_.seconds(); });
    summary_.device = device_.device->name();
    summary_.device_why = device_.why;
    summary_.times.load = total_.seconds();
}

void RenderJob::warn(const std::vector<Diagnostic>& warnings) {
    for (const Diagnostic& warning : warnings) {
        events_.warning(warning);
        summary_.warnings.push_back(warning);
    }
}

void RenderJob::open_output() {
    const Shot& shot = loaded_->shot();
    const std::vector<int>& frames = loaded_->bound().timing().frames;
    const std::vector<Diagnostic> problems = colliding_patterns(shot.output, frames);
    if (!problems.empty()) throw InputError(problems);
    prepare_folders(output_folders(shot.output, frames));
    delivery_.emplace(shot.output.png_bits, video_);
}

bool RenderJob::is_complete(const std::vector<std::filesystem::path>& files, const FrameIdentity& identity) const {
    return std::all_of(files.begin(), files.end(), [&](const std::filesystem::path& file) {
        std::error_code ignored;
        return std::filesystem::exists(file, ignored) &&
               stored_settings_hash(file) == identity.of(is_linear_file(file));
    });
}

/// On the first frame that has to be rendered: a run that finds every frame complete builds nothing.
void RenderJob::load_device() {
    if (device_loaded_) return;
    const Stopwatch watch;
    kadr::load_device(*device_.device, *loaded_);
    summary_.times.scene += watch.seconds();
    device_loaded_ = true;
}

/// Of a shot that has one: looks ahead at what its frames take.
void RenderJob::plan_budget() {
    if (!budget_.limited()) return;
    const auto there = [&](const FrameTime& time) {
        return !options_.overwrite && is_complete(frame_files(loaded_->shot().output, time.number), identity_->of(time));
    };
    const std::vector<int>& frames = loaded_->bound().timing().frames;
    const Sequence& sequence = loaded_->bound().sequence();
    if (std::all_of(frames.begin(), frames.end(), [&](int frame) { return there(sequence.frame(frame)); })) return;
    load_device();
    DeviceStatistics taken;
    budget_.plan(pilot_frames({loaded_->bound(), frames, there, film_layers(loaded_->shot().output.aovs), budget_.remaining_s(), [this] { return total_.seconds(); }},
                              *renderer_, taken));
    summary_.pixel_samples += taken.pixel_samples;
    summary_.times.scene += taken.set_frame_s;
    summary_.times.trace += taken.render_s;
}

ViewSpec RenderJob::view_with_exposure(const FrameTime& time) {
    ViewSpec view = view_at(loaded_->shot().view, time.time_s());
    if (!view.automatic) return view;
    if (!exposure_) {
        load_device();
        const FrameTime first = loaded_->bound().sequence().frame(metered_frame_);
        exposure_ = meter_exposure(loaded_->shot(), loaded_->scene(), *renderer_, first);
    }
    view.exposure_stops = *exposure_;
    view.automatic = false;
    return view;
}

/// Of all that a frame's samples depend on. Where they are dealt until the noise on the display is small enough, the exposure
/// is a part of that: two stops more show four times the noise.
Hash RenderJob::key_of(const std::vector<SceneSnapshot>& parts, const ViewSpec& view) const {
    const Hash content = content_key(parts);
    if (!loaded_->shot().render.max_error) return content;
    Hasher hasher;
    hasher.add(content.hex());
    hasher.add(view.exposure_stops);
    return hasher.finish();
}

/// A frame whose inputs are those of an earlier one over the whole shutter is that frame again, else it is rendered.
FrameCache::Found RenderJob::find_or_render(const FrameTime& time, const ViewSpec& view, int frames_left) {
    const Stopwatch watch;
    const std::vector<SceneSnapshot> parts = make_snapshots(loaded_->bound(), time);
    const Hash key = key_of(parts, view);
    if (const auto same = cache_.find(key)) return *same;
    RenderedFrame frame =
        renderer_->render(loaded_->bound(), parts,
                          {film_layers(loaded_->shot().output.aovs), view,
                           [&](double fraction) { events_.frame_progress(time.number, fraction, frames_left); },
                           budget_.begin(time.number)});
    budget_.end(frame.sampling.error.relmse);
    frame.seconds = watch.seconds();
    summary_.pixel_samples += frame.statistics.pixel_samples;
    summary_.times.scene += frame.statistics.set_frame_s;
    summary_.times.trace += frame.statistics.render_s;
    ++summary_.stopped_by[name_of(frame.sampling.stopped_by)];
    if (frame.sampling.error.known) {
        relmse_sum_ += frame.sampling.error.relmse;
        summary_.relmse = relmse_sum_ / ++relmse_frames_;
    }
    const auto kept = std::make_shared<const RenderedFrame>(std::move(frame));
    cache_.keep(key, time.number, kept);
    return {time.number, kept};
}

void RenderJob::render(DeliveryItem& item, const FrameTime& time, int frames_left) {
    load_device();
    item.view = view_with_exposure(time);
    const Stopwatch watch;
    const auto [number, frame] = find_or_render(time, item.view, frames_left);
    if (number != time.number) item.report.same_as = number;
    item.metadata = frame_metadata(loaded_->shot(), time, *frame, summary_.device);
    if (item.report.same_as) item.metadata["same_as"] = std::to_string(number);
    item.report.seconds = watch.seconds();
    item.report.samples = frame->statistics.pixel_samples;
    item.report.dropped = frame->statistics.dropped_samples;
    item.report.motion_error_px = frame->motion.largest_px();
    item.report.motion = frame->motion;
    item.report.sampling = frame->sampling;
    if (!item.report.same_as) item.report.device = frame->statistics;
    item.image = std::shared_ptr<const Image>(frame, &frame->image);
    summary_.same += item.report.same_as.has_value();
}

void RenderJob::deliver(int frame, int frames_left) {
    if (interrupt_requested()) throw Interrupted();
    const FrameTime time = loaded_->bound().sequence().frame(frame);
    DeliveryItem item;
    item.report.frame = frame;
    item.report.files = frame_files(loaded_->shot().output, frame);
    item.identity = identity_->of(time);
    item.report.reused = !options_.overwrite && is_complete(item.report.files, item.identity);
    if (!item.report.reused)
        render(item, time, frames_left);
    else if ((video_ || view_wanted_) && is_linear_file(video_source(item.report.files)))
        item.view = view_with_exposure(time);
    summary_.view = item.view;
    ++summary_.frames;
    summary_.reused += item.report.reused;
    delivery_->push(std::move(item));
}

void RenderJob::report_written() {
    for (const FrameReport& report : delivery_->take_written()) {
        if (report.dropped > 0) {
            Diagnostic dropped;
            dropped.warning = true;
            dropped.found = fmt::format("frame {}: {} of {} samples were not finite and were dropped", report.frame,
                                        report.dropped, report.samples);
            warn({dropped});
        }
        if (report.clamped > 0) {
            Diagnostic clamped;
            clamped.warning = true;
            clamped.found = fmt::format("frame {}: {} values above 65504 were clamped to fit a half float", report.frame,
                                        report.clamped);
            warn({clamped});
        }
        warn_of_motion(report);
        events_.frame_done(report);
    }
}

/// Once for every node: the next frames would say the same.
void RenderJob::warn_of_motion(const FrameReport& report) {
    if (report.reused || report.motion.met() || !astray_.insert(report.motion.worst).second) return;
    Diagnostic astray;
    astray.warning = true;
    astray.found = fmt::format("frame {}: {} strays {:.3g} px from its true path, more than render.motion_tolerance, {} px", report.frame,
                               report.motion.worst, report.motion.largest_px(), format_number(report.motion.tolerance_px));
    if (const auto& fixed = loaded_->shot().render.motion_frames; fixed && report.motion.largest_px() > report.motion.camera_px)
        astray.expected = fmt::format("render.motion_frames is {}; take more, or `motion_frames: auto` for as many as the tolerance asks for", fixed->count);
    else
        astray.expected = fmt::format("129 motion frames in each of {} part{} of the shutter are not enough for it; close the shutter earlier, raise the tolerance, "
                                      "or render.samples: no part gets less than one",
                                      report.motion.parts, report.motion.parts == 1 ? "" : "s");
    warn({astray});
}

void RenderJob::finish() {
    delivery_->finish();
    report_written();
    if (video_) summary_.video = video_->file;
    summary_.times.write = delivery_->write_s();
    summary_.times.encode = delivery_->encode_s();
    summary_.times.total = total_.seconds();
    if (summary_.times.trace > 0) summary_.samples_per_s = summary_.pixel_samples / summary_.times.trace;
    summary_.peak_memory_bytes = peak_memory_bytes();
}

RenderSummary RenderJob::run() {
    warn(loaded_->warnings());
    open_output();
    int left = static_cast<int>(loaded_->bound().timing().frames.size());
    try {
        plan_budget();
        for (const int frame : loaded_->bound().timing().frames) {
            deliver(frame, --left);
            report_written();
        }
        finish();
    } catch (...) {
        // Complete frames stay: those that are rendered are written, and reported, before the run ends.
        delivery_->abandon();
        report_written();
        // Ctrl-C reaches ffmpeg, too; what it then complains about is not the reason why the run ends.
        if (interrupt_requested()) throw Interrupted();
        throw;
    }
    return summary_;
}

}  // namespace

RenderSummary render_shot(const RenderOptions& options, const RenderEvents& events) {
    PreparedShot prepared;
    prepared.shot = parse_shot(options.shot, options.overrides);
    add_default_video(prepared.shot, options.default_video);
    return render_prepared(std::move(prepared), options, events);
}

RenderSummary render_prepared(PreparedShot shot, const RenderOptions& options, const RenderEvents& events) {
    return RenderJob(std::move(shot), options, events).run();
}

}  // namespace kadr
