#include "cli/reporter.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/requirement_names.h"

namespace kadr {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr double kBarInterval_s = 0.1, kJsonInterval_s = 0.5;
constexpr int kBarWidth = 24;

std::string readable_bytes(std::size_t bytes) { return fmt::format("{:.0f} MiB", bytes / 1048576.0); }

std::string readable_time(double seconds) {
    if (seconds < 60) return fmt::format("{:.1f} s", seconds);
    const int whole = static_cast<int>(seconds);
    return whole < 3600 ? fmt::format("{}:{:02} min", whole / 60, whole % 60)
                        : fmt::format("{}:{:02}:{:02} h", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string frame_line(const FrameReport& report) {
    const std::string file = report.files.empty() ? std::string() : report.files.front().string();
    if (!report.preview.empty())
        return fmt::format("{} of {} frames: {} in {}", report.preview, report.frames.size(), file, readable_time(report.seconds));
    const std::string name = report.shot.empty() ? fmt::format("frame {}", report.frame) : fmt::format("{} frame {}", report.shot, report.frame);
    if (report.reused) return fmt::format("{}: reused {}", name, file);
    if (report.same_as) return fmt::format("{}: {} is the same as frame {}", name, file, *report.same_as);
    return fmt::format("{}: {} in {}", name, file, readable_time(report.seconds));
}

/// "0.06 px (instances 0.06, vertices 0, camera 0.002), 9 motion frames in 2 parts".
std::string motion_text(const MotionReport& motion) {
    return fmt::format("{:.3g} px (instances {:.3g}, vertices {:.3g}, camera {:.3g}){}, {} motion frame{} in {} part{}", motion.largest_px(),
                       motion.instances_px, motion.vertices_px, motion.camera_px, motion.met() ? "" : ", above the tolerance", motion.frames,
                       motion.frames == 1 ? "" : "s", motion.parts, motion.parts == 1 ? "" : "s");
}

/// "32 to 256 (mean 61.2), stopped by max_error; relMSE 0.0031 (0.0029 to 0.0033), 0.009 on the display".
std::string sampling_text(const SamplingReport& s) {
    std::string text = s.least == s.most ? fmt::format("{}", s.least) : fmt::format("{} to {} (mean {:.4g})", s.least, s.most, s.mean);
    text += fmt::format(", stopped by {}", name_of(s.stopped_by));
    if (s.error.known)
        text += fmt::format("; relMSE {:.3g} ({:.3g} to {:.3g}), error on the display {:.3g}", s.error.relmse, s.error.relmse_low, s.error.relmse_high, s.display_error);
    return text;
}

/// ", made ahead; memory was short: the film comes in parts".
std::string memory_text(const DeviceStatistics& device) {
    std::string text = device.staged > 0 ? ", made ahead" : "";
    if (!device.memory_steps.empty()) text += "; memory was short: " + device.memory_steps;
    return text;
}

/// "\n  bending 2 meshes, vertices by the device's kernels; blur by moving triangles, 3 keys in 1 part, 0.04 px off"; nothing
/// where no mesh bends.
std::string bending_text(const BendingCounts& bending, const MotionReport& motion) {
    if (bending.meshes == 0) return "";
    std::string text = fmt::format("\n  bending {} mesh{}, vertices ", bending.meshes, bending.meshes == 1 ? "" : "es");
    if (bending.by_kernels == 0)
        text += "by the host";
    else if (bending.by_kernels == bending.meshes)
        text += "by the device's kernels";
    else
        text += fmt::format("of {} by the device's kernels", bending.by_kernels);
    if (bending.blurred == 0) return text + "; no blur of their own";
    return text + fmt::format("; blur of {} by moving triangles, {} keys in {} part{} of the shutter, {:.3g} px off", bending.blurred, bending.keys, motion.parts,
                              motion.parts == 1 ? "" : "s", motion.vertices_px);
}

std::string stats_line(const FrameReport& report) {
    const DeviceStatistics& device = report.device;
    const std::string by = report.device_name.empty() ? "" : fmt::format("  {}{}\n", report.device_name, memory_text(device));
    return by +
           fmt::format("  kernel needs {}, compiled for {}\n"
                       "  rays {}, samples {}, dropped {}, set-up {:.3f} s, trace {:.3f} s, instances {} ({} moving), "
                       "flattened triangles {}, structures {} built, {} updated, {} kept, motion error {}{}\n  samples a pixel {}",
                       names_of_requirements(device.required), names_of_requirements(device.compiled), device.rays,
                       device.pixel_samples, device.dropped_samples, device.set_frame_s, device.render_s,
                       device.instances, device.moving_instances, device.flattened_triangles, device.structures.built,
                       device.structures.updated, device.structures.kept, motion_text(report.motion), bending_text(device.bending, report.motion), sampling_text(report.sampling));
}

/// "3 reused", "3 reused, 40 the same as another".
std::string shortcuts_text(const RenderSummary& summary) {
    std::string text = fmt::format("{} reused", summary.reused);
    if (summary.same > 0) text += fmt::format(", {} the same as another", summary.same);
    return text;
}

/// "max_error 40, at_most 8".
std::string stops_text(const RenderSummary& summary) {
    std::string text;
    for (const auto& [reason, frames] : summary.stopped_by) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", reason, frames);
    return text;
}

std::string summary_text(const RenderSummary& summary) {
    const StageTimes& times = summary.times;
    std::string text = fmt::format("{} frames ({}) in {}: load {:.2f} s, scene {:.2f} s, trace {:.2f} s, write {:.2f} s, "
                                   "encode {:.2f} s\n",
                                   summary.frames, shortcuts_text(summary), readable_time(times.total), times.load, times.scene,
                                   times.trace, times.write, times.encode);
    text += fmt::format("{:.2f} million samples/s, peak memory {}\n", summary.samples_per_s / 1e6,
                        readable_bytes(summary.peak_memory_bytes));
    if (summary.relmse) text += fmt::format("estimated relMSE {:.3g}; frames stopped by {}\n", *summary.relmse, stops_text(summary));
    if (summary.shots > 0) text += fmt::format("reel: {} shots, {} frames, {:.2f} s\n", summary.shots, summary.reel_frames, summary.reel_s);
    text += fmt::format("device: {}{}\n", summary.device, summary.device_why.empty() ? "" : "; " + summary.device_why);
    if (!summary.video.empty()) text += fmt::format("video: {}\n", summary.video.string());
    return text;
}

std::string shot_line(const ShotStart& shot) {
    if (shot.number == 0) return fmt::format("reel {}: {} frames from {} shots", shot.name, shot.frames, shot.count);
    return fmt::format("shot {} of {}: {}, {} frames", shot.number, shot.count, shot.name, shot.frames);
}

void print(std::FILE* stream, const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stream);
    std::fflush(stream);
}

/// One line a frame, for logs.
class PlainReporter : public Reporter {
public:
    explicit PlainReporter(bool stats) : stats_(stats) {}
    void warning(const Diagnostic& warning) override { print(stderr, warning.text() + "\n"); }
    void progress(int, double, int) override {}
    void compiling(double) override {
        if (!said_compiling_.exchange(true)) print(stdout, "compiling kernels\n");
    }
    void shot_started(const ShotStart& shot) override { print(stdout, shot_line(shot) + "\n"); }
    void frame_done(const FrameReport& report) override {
        print(stdout, frame_line(report) + "\n");
        if (stats_ && !report.reused && !report.same_as) print(stdout, stats_line(report) + "\n");
    }
    void summary(const RenderSummary& summary) override { print(stdout, summary_text(summary)); }

private:
    const bool stats_;
    std::atomic<bool> said_compiling_{false};
};

/// A bar that is drawn over itself on standard error.
class BarReporter : public PlainReporter {
public:
    explicit BarReporter(bool stats) : PlainReporter(stats), stats_(stats) {}
    ~BarReporter() override { clear(); }

    void warning(const Diagnostic& warning) override {
        clear();
        PlainReporter::warning(warning);
    }
    void progress(int frame, double fraction, int frames_left) override {
        const std::lock_guard lock(mutex_);
        const Clock::time_point now = Clock::now();
        if (now - drawn_ < std::chrono::duration<double>(kBarInterval_s)) return;
        drawn_ = now;
        draw(frame, fraction, frames_left);
    }
    void compiling(double seconds) override {
        const std::lock_guard lock(mutex_);
        print(stderr, fmt::format("\r\033[K{}compiling kernels, {:.0f} s", shot_, seconds));
        shown_ = true;
    }
    void shot_started(const ShotStart& shot) override {
        const std::lock_guard lock(mutex_);
        shot_ = shot.name + " ";
    }
    void frame_done(const FrameReport& report) override {
        if (stats_) {
            clear();
            PlainReporter::frame_done(report);
        }
    }
    void summary(const RenderSummary& summary) override {
        clear();
        PlainReporter::summary(summary);
    }
    void clear() override {
        const std::lock_guard lock(mutex_);
        if (shown_) print(stderr, "\r\033[K");
        shown_ = false;
    }

private:
    /// Seconds to go by the pace since the first rendered sample; reused frames do not count as work.
    double remaining_s(double fraction, int frames_left) {
        const double at = -frames_left + fraction;  // grows by one a frame
        if (!paced_) {
            paced_ = true;
            begin_ = drawn_;
            begin_at_ = at;
        }
        const double done = at - begin_at_;
        const double elapsed = std::chrono::duration<double>(drawn_ - begin_).count();
        return done > 0 ? elapsed / done * (1 - at) : -1;
    }
    void draw(int frame, double fraction, int frames_left) {
        const double left = remaining_s(fraction, frames_left);
        const int filled = static_cast<int>(fraction * kBarWidth);
        print(stderr, fmt::format("\r\033[K{}frame {} [{}{}] {:3.0f} %  {} left  ETA {}  {}", shot_, frame, std::string(filled, '#'),
                                  std::string(kBarWidth - filled, '.'), fraction * 100, frames_left,
                                  left < 0 ? "-" : readable_time(left), readable_bytes(current_memory_bytes())));
        shown_ = true;
    }

    const bool stats_;
    std::mutex mutex_;
    Clock::time_point drawn_{}, begin_{};
    double begin_at_ = 0;
    std::string shot_;   ///< "spin " in a reel
    bool paced_ = false, shown_ = false;
};

Json statistics_json(const DeviceStatistics& device) {
    return {{"kernel", {{"needs", names_of_requirements(device.required)}, {"compiled_for", names_of_requirements(device.compiled)}}},
            {"pixel_samples", device.pixel_samples}, {"rays", device.rays},
            {"dropped_samples", device.dropped_samples}, {"load_s", device.load_s},
            {"set_frame_s", device.set_frame_s}, {"render_s", device.render_s},
            {"instances", device.instances}, {"moving_instances", device.moving_instances},
            {"flattened_triangles", device.flattened_triangles},
            {"made_ahead", device.staged}, {"memory_steps", device.memory_steps},
            {"bending", {{"meshes", device.bending.meshes}, {"by_kernels", device.bending.by_kernels}, {"blurred", device.bending.blurred}, {"keys", device.bending.keys}}},
            {"structures",
             {{"built", device.structures.built}, {"updated", device.structures.updated}, {"kept", device.structures.kept}}}};
}

Json sampling_json(const SamplingReport& s) {
    Json json{{"least", s.least}, {"most", s.most}, {"mean", s.mean}, {"stopped_by", name_of(s.stopped_by)}};
    if (s.error.known) {
        json["relmse"] = s.error.relmse;
        json["relmse_95"] = {s.error.relmse_low, s.error.relmse_high};
        json["display_error"] = s.display_error;
    }
    return json;
}

Json frame_json(const FrameReport& report) {
    Json files = Json::array();
    for (const auto& file : report.files) files.push_back(file.string());
    if (!report.preview.empty())
        return {{"event", "preview"}, {"preview", report.preview}, {"frames", report.frames}, {"note", report.note},
                {"seconds", report.seconds}, {"samples", report.samples}, {"files", files}};
    return {{"event", "frame"}, {"frame", report.frame}, {"reused", report.reused},
            {"same_as", report.same_as ? Json(*report.same_as) : Json()}, {"seconds", report.seconds},
            {"samples", report.samples}, {"dropped", report.dropped}, {"clamped", report.clamped},
            {"motion_error_px", report.motion_error_px},
            {"motion", {{"instances_px", report.motion.instances_px}, {"vertices_px", report.motion.vertices_px}, {"camera_px", report.motion.camera_px},
                        {"frames", report.motion.frames}, {"parts", report.motion.parts}, {"met", report.motion.met()}}},
            {"sampling", sampling_json(report.sampling)}, {"files", files}};
}

Json summary_json(const RenderSummary& summary) {
    const StageTimes& times = summary.times;
    return {{"event", "summary"}, {"frames", summary.frames}, {"reused", summary.reused}, {"same", summary.same},
            {"seconds", {{"load", times.load}, {"scene", times.scene}, {"trace", times.trace}, {"write", times.write},
                         {"encode", times.encode}, {"total", times.total}}},
            {"relmse", summary.relmse ? Json(*summary.relmse) : Json()}, {"stopped_by", summary.stopped_by},
            {"pixel_samples", summary.pixel_samples}, {"samples_per_s", summary.samples_per_s},
            {"peak_memory_bytes", summary.peak_memory_bytes}, {"device", summary.device},
            {"device_why", summary.device_why}, {"video", summary.video.string()}};
}

/// One JSON object a line on standard output.
class JsonReporter : public Reporter {
public:
    explicit JsonReporter(bool stats) : stats_(stats) {}
    void warning(const Diagnostic& warning) override {
        line({{"event", "warning"}, {"file", warning.where.file}, {"line", warning.where.line},
              {"column", warning.where.column}, {"message", warning.text()}});
    }
    void progress(int frame, double fraction, int frames_left) override {
        if (!is_due()) return;
        line({{"event", "progress"}, {"frame", frame}, {"fraction", fraction}, {"frames_left", frames_left},
              {"memory_bytes", current_memory_bytes()}});
    }
    void compiling(double seconds) override {
        if (is_due()) line({{"event", "compiling"}, {"seconds", seconds}});
    }
    void shot_started(const ShotStart& shot) override {
        line({{"event", "shot"}, {"shot", shot.name}, {"number", shot.number}, {"count", shot.count}, {"frames", shot.frames}});
    }
    void frame_done(const FrameReport& report) override {
        Json frame = frame_json(report);
        if (!report.shot.empty()) frame["shot"] = report.shot;
        if (!report.device_name.empty()) frame["device_name"] = report.device_name;
        if (stats_) frame["device"] = statistics_json(report.device);
        line(frame);
    }
    void summary(const RenderSummary& summary) override {
        Json json = summary_json(summary);
        if (summary.shots > 0) json.update({{"shots", summary.shots}, {"reel_frames", summary.reel_frames}, {"reel_s", summary.reel_s}});
        line(json);
    }

private:
    bool is_due() {
        const std::lock_guard lock(mutex_);
        const Clock::time_point now = Clock::now();
        if (now - last_ < std::chrono::duration<double>(kJsonInterval_s)) return false;
        last_ = now;
        return true;
    }
    void line(const Json& value) {
        // Paths may hold any bytes; JSON holds UTF-8 alone.
        const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
        const std::lock_guard lock(mutex_);
        print(stdout, text);
    }

    const bool stats_;
    std::mutex mutex_;
    Clock::time_point last_ = Clock::now();
};

}  // namespace

RenderEvents Reporter::events() {
    RenderEvents events;
    events.warning = [this](const Diagnostic& diagnostic) { warning(diagnostic); };
    events.frame_progress = [this](int frame, double fraction, int left) { progress(frame, fraction, left); };
    events.compiling = [this](double seconds) { compiling(seconds); };
    events.shot_started = [this](const ShotStart& shot) { shot_started(shot); };
    events.frame_done = [this](const FrameReport& report) { frame_done(report); };
    return events;
}

std::unique_ptr<Reporter> make_reporter(bool json, bool stats) {
    if (json) return std::make_unique<JsonReporter>(stats);
    if (isatty(STDERR_FILENO)) return std::make_unique<BarReporter>(stats);
    return std::make_unique<PlainReporter>(stats);
}

}  // namespace kadr
