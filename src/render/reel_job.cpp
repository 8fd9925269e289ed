#include "render/reel_job.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/version.h"
#include "output/frame_writer.h"
#include "output/image_io.h"
#include "render/output_plan.h"
#include "render/reel_picture.h"
#include "render/reel_plan.h"
#include "render/stopwatch.h"

namespace kadr {
namespace {

void add(StageTimes& sum, const StageTimes& part) {
    sum.load += part.load;
    sum.scene += part.scene;
    sum.trace += part.trace;
    sum.write += part.write;
}

/// One call of render_reel.
class ReelJob {
public:
    ReelJob(const RenderOptions& options, const RenderEvents& events)
        : options_(options), events_(events), plan_(plan_reel(options.shot, options.overrides)) {}

    RenderSummary run() {
        open_image_io_in_background();
        for (const Diagnostic& warning : plan_.warnings) warn(warning);
        prepare_all_folders();
        summary_.times.load = total_.seconds();
        for (std::size_t i = 0; i < plan_.sources.size(); ++i) render_source(i);
        make_reel();
        finish();
        return std::move(summary_);
    }

private:
    void warn(const Diagnostic& warning) {
        events_.warning(warning);
        summary_.warnings.push_back(warning);
    }

    /// Before the first ray: the last shot's folder may be the one that cannot be written to.
    void prepare_all_folders() const {
        prepare_folders(output_folders(plan_.reel.output, plan_.frames));
        for (const ReelSource& source : plan_.sources) prepare_folders(output_folders(source.prepared.shot.output, source.prepared.shot.timing.frames));
    }

    int frames_after(std::size_t index) const {
        std::size_t frames = 0;
        for (std::size_t i = index + 1; i < plan_.sources.size(); ++i) frames += plan_.sources[i].prepared.shot.timing.frames.size();
        return static_cast<int>(frames);
    }

    void render_source(std::size_t index) {
        const PreparedShot& prepared = plan_.sources[index].prepared;
        const std::string& name = prepared.shot.name;
        const int frames = static_cast<int>(prepared.shot.timing.frames.size());
        if (frames == 0) return views_.push_back(prepared.shot.view);  // --frames needs none of it
        events_.shot_started({name, static_cast<int>(index) + 1, static_cast<int>(plan_.sources.size()), frames});
        RenderEvents events = events_;
        events.warning = [&](const Diagnostic& warning) {
            // The plan has said what the shot itself has to say.
            const auto same = [&](const Diagnostic& other) { return other.text() == warning.text(); };
            if (std::none_of(summary_.warnings.begin(), summary_.warnings.end(), same)) warn(warning);
        };
        const int left = frames_after(index);
        events.frame_progress = [&](int frame, double fraction, int more) { events_.frame_progress(frame, fraction, more + left); };
        events.frame_done = [&](FrameReport report) {
            report.shot = name;
            events_.frame_done(report);
        };
        RenderSummary done = render_prepared(prepared, options_, events);
        if (prepared.shot.view.exposure_keys) done.view = prepared.shot.view;  // not that of the last frame
        add(done);
    }

    void add(const RenderSummary& shot) {
        views_.push_back(shot.view);
        kadr::add(summary_.times, shot.times);
        summary_.frames += shot.frames;
        summary_.reused += shot.reused;
        summary_.pixel_samples += shot.pixel_samples;
        summary_.device = shot.device;
        summary_.device_why = shot.device_why;
        ++summary_.shots;
    }

    void make_reel() {
        if (!plan_.video && plan_.reel.output.frames.empty()) return;
        const Stopwatch watch;
        const int count = static_cast<int>(plan_.frames.size());
        events_.shot_started({plan_.reel.name, 0, summary_.shots, count});
        ReelPictures pictures(plan_, views_);
        std::optional<Encoder> encoder;
        if (plan_.video) encoder.emplace(*plan_.video);
        for (int i = 0; i < count; ++i) {
            if (interrupt_requested()) throw Interrupted();
            events_.frame_progress(plan_.frames[static_cast<std::size_t>(i)], 0, count - i - 1);
            make_frame(pictures, encoder, plan_.frames[static_cast<std::size_t>(i)]);
        }
        if (interrupt_requested()) throw Interrupted();
        if (encoder) encoder->finish();
        summary_.times.encode = watch.seconds();
    }

    void make_frame(ReelPictures& pictures, std::optional<Encoder>& encoder, int frame) {
        const Stopwatch watch;
        const std::vector<std::filesystem::path> files = frame_files(plan_.reel.output, frame);
        const std::string identity = files.empty() ? std::string() : pictures.identity(frame);
        const bool complete = !files.empty() && !options_.overwrite && stored_settings_hash(files.front()) == identity;
        if (complete && !encoder) return report(frame, files, true, watch.seconds());
        const Image picture = pictures.picture(frame);
        if (!files.empty() && !complete) write(files.front(), picture, frame, identity);
        if (!files.empty()) report(frame, files, complete, watch.seconds());
        if (encoder) push(*encoder, picture);
    }

    static void push(Encoder& encoder, const Image& picture) {
        try {
            encoder.push(picture);
        } catch (const RenderError&) {
            // Ctrl-C reaches ffmpeg, too; what it then complains about is not the reason why the run ends.
            if (interrupt_requested()) throw Interrupted();
            throw;
        }
    }

    void write(const std::filesystem::path& file, const Image& picture, int frame, const std::string& identity) const {
        ViewSpec as_it_is;
        as_it_is.transform = ViewTransform::none;
        write_frame(file, picture, as_it_is, plan_.reel.output.png_bits,
                    {{"reel", plan_.reel.name}, {"frame", std::to_string(frame)}, {"version", kVersion}, {"settings", identity}});
    }

    void report(int frame, const std::vector<std::filesystem::path>& files, bool reused, double seconds) const {
        FrameReport report;
        report.shot = plan_.reel.name;
        report.frame = frame;
        report.files = files;
        report.reused = reused;
        report.seconds = seconds;
        events_.frame_done(report);
    }

    void finish() {
        if (plan_.video) summary_.video = plan_.video->file;
        summary_.reel_frames = static_cast<int>(plan_.frames.size());
        summary_.reel_s = summary_.reel_frames / plan_.reel.fps.value();
        summary_.times.total = total_.seconds();
        if (summary_.times.trace > 0) summary_.samples_per_s = static_cast<double>(summary_.pixel_samples) / summary_.times.trace;
        summary_.peak_memory_bytes = peak_memory_bytes();
    }

    const RenderOptions& options_;
    const RenderEvents& events_;
    const Stopwatch total_;
    ReelPlan plan_;
    RenderSummary summary_;
    std::vector<ViewSpec> views_;   ///< [source]
};

}  // namespace

RenderSummary render_reel(const RenderOptions& options, const RenderEvents& events) { return ReelJob(options, events).run(); }

void refuse_reel_preview(const PreviewOptions& options) {
    const ReelPlan plan = plan_reel(options.render.shot, options.render.overrides);
    const int count = plan.edit.frame_count();
    const double at = options.time_s ? std::floor(*options.time_s * plan.reel.fps.value()) : options.frame.value_or(0);
    const std::string found = fmt::format("'{}' is a reel, and preview takes a shot", options.render.shot.string());
    if (!(at >= 0 && at < count)) throw InputError(found, fmt::format("the reel has frames 0 to {}", count - 1));
    std::string advice;
    for (const ReelFrame::Layer& layer : plan.edit.frame(static_cast<int>(at)).layers)
        advice += fmt::format("{}`kadr preview {} --frame {}`", advice.empty() ? "" : " and ",
                              plan.reel.entries[static_cast<std::size_t>(layer.cut)].shot.file.string(), layer.frame);
    throw InputError(found, fmt::format("frame {} of the reel shows {}; `kadr render {} --frames {} --video none` renders it",
                                        static_cast<int>(at), advice, options.render.shot.string(), static_cast<int>(at)));
}

}  // namespace kadr
