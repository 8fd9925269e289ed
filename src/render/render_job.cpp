#include "render/render_job.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <future>
#include <mutex>
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
#include "render/frame_cache.h"
#include "render/frame_farm.h"
#include "render/frame_identity.h"
#include "render/frame_schedule.h"
#include "render/loaded_shot.h"
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

/// One call of render_shot: members in the order in which they come to be. Frames are evaluated by one thread and rendered
/// by one for each device; this one delivers them in their order.
class RenderJob {
public:
    RenderJob(PreparedShot prepared, const RenderOptions& options, const RenderEvents& events);
    RenderSummary run();

private:
    using Rendered = FrameTask::Rendered;

    void warn(const std::vector<Diagnostic>& warnings);
    void open_output();
    bool is_complete(const std::vector<std::filesystem::path>& files, const FrameIdentity& identity) const;
    Hash key_of(const std::vector<SceneSnapshot>& parts, const FrameTime& time) const;
    FrameSchedule::Task evaluate(std::size_t index);
    void find_same(const FrameSchedule::Task& task);
    void keep(const FrameTask& task, const Rendered& frame);
    Rendered wait_for(const FrameTask& task) const;
    void deliver(const FrameTask& task);
    void describe(DeliveryItem& item, const FrameTask& task, const Rendered& frame);
    void plan_budget();
    void deliver_all();
    void deliver_finished() noexcept;
    void report_written();
    void warn_of_motion(const FrameReport& report);
    void finish();

    const RenderOptions& options_;
    const RenderEvents& events_;
    const bool view_wanted_;
    Stopwatch total_;
    RenderSummary summary_;
    std::vector<DeviceChoice> devices_;   ///< until the farm has them
    std::optional<LoadedShot> loaded_;
    std::optional<VideoPlan> video_;
    std::optional<ShotIdentity> identity_;
    std::set<std::string> astray_;  ///< what has been warned of
    std::mutex cache_mutex_;
    FrameCache cache_{kMostCachedBytes};
    std::vector<FrameSchedule::Task> under_way_;   ///< evaluated, not yet in the cache
    double relmse_sum_ = 0;
    int relmse_frames_ = 0;
    std::optional<Delivery> delivery_;
    std::optional<FrameSchedule> schedule_;
    std::optional<FrameFarm> farm_;
};

RenderJob::RenderJob(PreparedShot prepared, const RenderOptions& options, const RenderEvents& events)
    : options_(options), events_(events), view_wanted_(prepared.view_wanted) {
    Shot& shot = prepared.shot;
    devices_ = make_devices(options.device);
    for (const DeviceChoice& choice : devices_) {
        if (choice.warning.empty()) continue;
        Diagnostic doubtful;
        doubtful.found = choice.warning;
        doubtful.warning = true;
        warn({doubtful});
    }
    open_image_io_in_background();
    if (shot.output.video)
        video_ = plan_video(*shot.output.video, shot.image.width, shot.image.height, shot.timing.fps);
    loaded_.emplace(std::move(shot));
    denoiser_of(loaded_->shot().render);  // a missing one is known before anything is written
    FrameFarm::Settings settings;
    if (loaded_->shot().view.automatic)
        settings.metered_frame = prepared.metered_frame ? *prepared.metered_frame : first_frame_of_shot(options, *loaded_);
    identity_.emplace(*loaded_, settings.metered_frame);
    settings.frames = loaded_->bound().timing().frames.size();
    settings.clock = [this] { return total_.seconds(); };
    settings.progress = events_.frame_progress;
    settings.compiling = events_.compiling;
    settings.rendered = [this](const FrameTask& task, const Rendered& frame) { keep(task, frame); };
    farm_.emplace(*loaded_, std::move(devices_), std::move(settings));
    summary_.device = farm_->names();
    summary_.device_why = farm_->why();
    if (const std::optional<Slipping> slipping = loaded_->slipping(); slipping && farm_->has_robust_rays()) summary_.device_why += "; robust rays: " + slipping->text();
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

/// Of a shot that has one: looks ahead at what its frames take.
void RenderJob::plan_budget() {
    if (!loaded_->shot().render.time_budget_shot_s) return;
    const auto there = [&](const FrameTime& time) -> std::optional<double> {
        const std::vector<std::filesystem::path> files = frame_files(loaded_->shot().output, time.number);
        if (options_.overwrite || !is_complete(files, identity_->of(time))) return std::nullopt;
        return stored_relmse(files.front());
    };
    const std::vector<int>& frames = loaded_->bound().timing().frames;
    const Sequence& sequence = loaded_->bound().sequence();
    if (std::all_of(frames.begin(), frames.end(), [&](int frame) { return there(sequence.frame(frame)); })) return;
    const DeviceStatistics taken = farm_->plan_budget(frames, there);
    summary_.pixel_samples += taken.pixel_samples;
    summary_.times.scene += taken.set_frame_s;
    summary_.times.trace += taken.render_s;
}

/// Of all that a frame's samples depend on. Where they are dealt until the noise on the display is small enough, the exposure
/// is a part of that: two stops more show four times the noise. An automatic one is the same for all frames.
Hash RenderJob::key_of(const std::vector<SceneSnapshot>& parts, const FrameTime& time) const {
    const Hash content = content_key(parts);
    if (!loaded_->shot().render.max_error) return content;
    Hasher hasher;
    hasher.add(content.hex());
    hasher.add(view_at(loaded_->shot().view, time.time_s()).exposure_stops);
    return hasher.finish();
}

/// All that is known of a frame without a device, by the thread of the schedule.
FrameSchedule::Task RenderJob::evaluate(std::size_t index) {
    const int frame = loaded_->bound().timing().frames[index];
    auto task = std::make_shared<FrameTask>();
    task->index = index;
    task->time = loaded_->bound().sequence().frame(frame);
    task->files = frame_files(loaded_->shot().output, frame);
    task->identity = identity_->of(task->time);
    task->reused = !options_.overwrite && is_complete(task->files, task->identity);
    if (task->reused) return task;
    task->parts = std::make_shared<const std::vector<SceneSnapshot>>(make_snapshots(loaded_->bound(), task->time));
    task->key = key_of(*task->parts, task->time);
    find_same(task);
    return task;
}

/// A frame whose inputs are those of an earlier one over the whole shutter is that frame again, though it may not be rendered
/// yet.
void RenderJob::find_same(const FrameSchedule::Task& task) {
    const std::lock_guard lock(cache_mutex_);
    if (const auto known = cache_.find(task->key)) {
        task->same_as = known->number;
        task->promise.set_value(known->frame);
        task->parts.reset();
        return;
    }
    const auto same = std::find_if(under_way_.begin(), under_way_.end(), [&](const auto& other) { return other->key == task->key; });
    if (same == under_way_.end()) return under_way_.push_back(task);
    task->same_as = (*same)->time.number;
    task->rendered = (*same)->rendered;
    task->parts.reset();
}

void RenderJob::keep(const FrameTask& task, const Rendered& frame) {
    const std::lock_guard lock(cache_mutex_);
    cache_.keep(task.key, task.time.number, frame);
    std::erase_if(under_way_, [&](const auto& other) { return other.get() == &task; });
}

RenderJob::Rendered RenderJob::wait_for(const FrameTask& task) const {
    // What a device does when it is interrupted comes by the future, too; but it may be long in coming.
    constexpr std::chrono::milliseconds kLookForInterrupts{20};
    while (task.rendered.wait_for(kLookForInterrupts) != std::future_status::ready)
        if (interrupt_requested()) throw Interrupted();
    return task.rendered.get();
}

void RenderJob::describe(DeliveryItem& item, const FrameTask& task, const Rendered& frame) {
    item.metadata = frame_metadata(loaded_->shot(), task.time, *frame, frame->device);
    if (task.same_as) item.metadata["same_as"] = std::to_string(*task.same_as);
    item.report.same_as = task.same_as;
    item.report.samples = frame->statistics.pixel_samples;
    item.report.dropped = frame->statistics.dropped_samples;
    item.report.motion_error_px = frame->motion.largest_px();
    item.report.motion = frame->motion;
    item.report.sampling = frame->sampling;
    item.image = std::shared_ptr<const Image>(frame, &frame->image);
    summary_.same += task.same_as.has_value();
    if (task.same_as) return;
    item.report.device = frame->statistics;
    item.report.device_name = frame->device;
    summary_.pixel_samples += frame->statistics.pixel_samples;
    summary_.times.scene += frame->statistics.set_frame_s;
    summary_.times.trace += frame->statistics.render_s;
    ++summary_.stopped_by[name_of(frame->sampling.stopped_by)];
    if (!frame->sampling.error.known) return;
    relmse_sum_ += frame->sampling.error.relmse;
    summary_.relmse = relmse_sum_ / ++relmse_frames_;
}

void RenderJob::deliver(const FrameTask& task) {
    const Stopwatch watch;
    DeliveryItem item;
    item.report.frame = task.time.number;
    item.report.files = task.files;
    item.report.reused = task.reused;
    item.identity = task.identity;
    if (!task.reused) {
        const Rendered frame = wait_for(task);
        item.report.seconds = task.same_as ? watch.seconds() : frame->seconds;
        describe(item, task, frame);
        item.view = farm_->view_of(task.time);
    } else if ((video_ || view_wanted_) && is_linear_file(video_source(item.report.files)))
        item.view = farm_->view_of(task.time);
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
    summary_.times.scene += farm_->load_s();
    summary_.times.write = delivery_->write_s();
    summary_.times.encode = delivery_->encode_s();
    summary_.times.total = total_.seconds();
    if (summary_.times.trace > 0) summary_.samples_per_s = summary_.pixel_samples / summary_.times.trace;
    summary_.peak_memory_bytes = peak_memory_bytes();
}

void RenderJob::deliver_all() {
    const std::size_t frames = loaded_->bound().timing().frames.size();
    schedule_.emplace(frames, farm_->size(), [this](std::size_t index) { return evaluate(index); });
    farm_->start(*schedule_);
    for (std::size_t index = 0; index < frames; ++index) {
        if (interrupt_requested()) throw Interrupted();
        deliver(*schedule_->at(index));
        schedule_->delivered();
        report_written();
    }
    farm_->join();
}

/// What other devices have finished when the run ends early is written, too: frames are dear.
void RenderJob::deliver_finished() noexcept {
    if (!schedule_) return;
    schedule_->stop(std::make_exception_ptr(Interrupted()));
    farm_->join();
    for (const FrameSchedule::Task& task : schedule_->left()) try {
            if (!task->reused && task->rendered.wait_for(std::chrono::seconds(0)) == std::future_status::ready) deliver(*task);
        } catch (...) {  // why the run ends is known
        }
}

RenderSummary RenderJob::run() {
    warn(loaded_->warnings());
    open_output();
    try {
        plan_budget();
        deliver_all();
        finish();
    } catch (...) {
        // Complete frames stay: those that are rendered are written, and reported, before the run ends.
        deliver_finished();
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
