#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "device/device.h"
#include "frame/motion_report.h"
#include "render/sample_steering.h"
#include "shot/shot_parser.h"

namespace kadr {

struct RenderOptions {
    std::filesystem::path shot;
    ShotOverrides overrides;
    DeviceRequest device;
    bool overwrite = false;
    /// Video file where neither the shot nor the overrides name one; "{name}" is the shot's name. Empty: none.
    std::string default_video;
};

/// Seconds of wall time by stage (stages overlap, so they need not add up to the total).
struct StageTimes { double load = 0, scene = 0, trace = 0, write = 0, encode = 0, total = 0; };

struct FrameReport {
    std::string shot;                ///< whose frame it is, in a reel
    int frame = 0;
    bool reused = false;             ///< complete on disk, made from the same inputs
    std::optional<int> same_as;      ///< number of the frame of this run whose pixels these are: nothing differs over the shutter
    double seconds = 0;
    std::uint64_t samples = 0, dropped = 0;
    std::uint64_t clamped = 0;       ///< half-float values above 65504
    double motion_error_px = 0;      ///< the largest of `motion`
    MotionReport motion;
    SamplingReport sampling;
    std::vector<std::filesystem::path> files;
    DeviceStatistics device;
    std::string device_name;         ///< that rendered it; empty where none did
    std::string preview;             ///< "sheet", "onion" or "path": a picture that is no frame of the shot
    std::vector<int> frames;         ///< those that such a picture shows
    std::string note;                ///< what else a person should know of it; may be empty
};

struct RenderSummary {
    int frames = 0, reused = 0;
    int same = 0;                    ///< frames that repeat one rendered before in this run
    StageTimes times;
    std::uint64_t pixel_samples = 0;
    double samples_per_s = 0;
    std::optional<double> relmse;    ///< mean of the estimates of the frames that were rendered
    std::map<std::string, int> stopped_by;   ///< frames by what stopped their sampling
    std::size_t peak_memory_bytes = 0;
    std::string device, device_why;
    std::filesystem::path video;
    ViewSpec view;                   ///< of the last frame, its exposure filled in
    int shots = 0;                   ///< of a reel; 0: a shot was rendered
    int reel_frames = 0;
    double reel_s = 0;               ///< seconds that the reel lasts
    std::vector<Diagnostic> warnings;
};

/// A shot of a reel, or the reel itself, whose frames come next.
struct ShotStart {
    std::string name;
    int number = 1, count = 1;       ///< the how many-eth of how many shots; 0: the reel itself
    int frames = 0;
};

/// Who watches: a progress bar, plain lines or JSON lines. Called from the thread that called render_shot, but for
/// frame_progress and compiling.
struct RenderEvents {
    std::function<void(const Diagnostic&)> warning = [](const Diagnostic&) {};
    std::function<void(int frame, double fraction, int frames_left)> frame_progress = [](int, double, int) {};
    /// A frame waits for the kernels of a GPU, for so long already. From any thread.
    std::function<void(double seconds)> compiling = [](double) {};
    std::function<void(const ShotStart&)> shot_started = [](const ShotStart&) {};   ///< of reels alone
    std::function<void(const FrameReport&)> frame_done = [](const FrameReport&) {};
};

/// Renders every frame of the shot, then the video.
/// @throws InputError, RenderError, Interrupted
RenderSummary render_shot(const RenderOptions& options, const RenderEvents& events);

enum class PreviewKind { still, sheet, onion, path };
enum class Viewpoint { camera, side, top, iso };
struct PreviewOptions {
    RenderOptions render;
    PreviewKind kind = PreviewKind::still;
    std::optional<int> frame;               ///< still, path
    std::optional<double> time_s;           ///< still, path
    std::optional<std::vector<int>> frames; ///< sheet, onion, path: those to show; absent: the shot's
    int columns = 4, rows = 3;              ///< sheet
    Viewpoint from = Viewpoint::camera;     ///< path
    std::filesystem::path output;           ///< empty: NAME.FRAME.preview.png, NAME.sheet.png, ... in the working folder
};
/// One picture that shows what the shot will look like or how it moves, quickly.
/// @throws InputError, RenderError, Interrupted
FrameReport render_preview(const PreviewOptions& options, const RenderEvents& events);

/// What is known of a shot before it is rendered.
struct CheckReport {
    std::vector<Diagnostic> warnings;
    std::string details;   ///< the timeline and what else `kadr check --verbose` prints; empty without `verbose`
};
/// Everything that can be known before rendering; writes nothing. @throws InputError with all problems
CheckReport check_shot(const std::filesystem::path& shot, const ShotOverrides& overrides, bool verbose = false);

/// Bytes that this process holds now, and the most it has held.
std::size_t current_memory_bytes();
std::size_t peak_memory_bytes();

/// Set by SIGINT and SIGTERM; render functions stop at the next opportunity and throw Interrupted.
std::atomic<bool>& interrupt_requested();
/// Installs the handlers: the first signal sets the flag, the second ends the process at once.
void install_interrupt_handlers();

}  // namespace kadr
