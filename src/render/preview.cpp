#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "frame/camera_keys.h"
#include "output/frame_writer.h"
#include "render/frame_identity.h"
#include "render/loaded_shot.h"
#include "render/onion.h"
#include "render/output_plan.h"
#include "render/overview.h"
#include "render/path_overlay.h"
#include "render/preview_session.h"
#include "render/sheet.h"

namespace kadr {
namespace {

constexpr int kPreviewWidth = 640;

std::string lower_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return extension;
}

/// What is wrong with --output is said before the first ray.
void check_output(const PreviewOptions& options) {
    if (options.output.empty()) return;
    const std::string extension = lower_extension(options.output);
    const bool is_display = extension == ".png" || extension == ".jpg" || extension == ".jpeg";
    const bool is_still = options.kind == PreviewKind::still;
    if (is_display || (is_still && extension == ".exr")) return;
    throw InputError(fmt::format("--output is '{}'", options.output.string()),
                     is_still
                         ? "expected a name that ends in .png, .jpg or .exr"
                         : "expected a name that ends in .png or .jpg: it is a picture for people, not linear light");
}

std::filesystem::path file_of(const PreviewOptions& options, const std::string& default_name, int frame) {
    const std::filesystem::path file =
        options.output.empty() ? std::filesystem::path(default_name) : frame_path(options.output.string(), frame);
    prepare_folders({std::filesystem::absolute(file).parent_path()});
    return file;
}

const std::vector<int>& frames_of(const PreviewOptions& options, const PreviewSession& session) {
    return options.frames ? *options.frames : session.bound().timing().frames;
}

FrameTime time_of(const PreviewOptions& options, const PreviewSession& session) {
    if (options.time_s) return session.at_time(*options.time_s);
    return session.frame(options.frame.value_or(frames_of(options, session).front()));
}

std::function<void(Shot&)> limit_width(const PreviewOptions& options) {
    return [&options](Shot& shot) {
        if (options.render.overrides.width == 0) shot.image = limited_width(shot.image, kPreviewWidth);
    };
}

FrameReport preview_still(const PreviewOptions& options, const RenderEvents& events) {
    PreviewSession session(options.render, events, limit_width(options));
    const FrameTime time = time_of(options, session);
    const std::filesystem::path file =
        file_of(options, fmt::format("{}.{:04}.preview.png", session.shot().name, time.number), time.number);
    const FilmLayers layers = is_linear_file(file) ? film_layers(session.shot().output.aovs) : FilmLayers{};
    const RenderedFrame frame = session.render(session.bound(), time, layers);
    // No settings hash: a preview never passes for a frame of the shot.
    write_frame(file, frame.image, session.view(frame.time_s), session.shot().output.png_bits,
                frame_metadata(session.shot(), time, frame, session.device_name()));
    FrameReport report = session.report();
    report.frame = time.number;
    report.files = {file};
    return report;
}

/// Writes a picture that shows several frames, and says so.
FrameReport deliver(const PreviewSession& session, const std::filesystem::path& file, const Image& picture,
                    const std::string& kind, const std::vector<int>& frames) {
    session.write(file, picture, session.metadata(kind, frames));
    FrameReport report = session.report();
    report.preview = kind;
    report.frame = frames.front();
    report.frames = frames;
    report.files = {file};
    return report;
}

FrameReport preview_sheet(const PreviewOptions& options, const RenderEvents& events) {
    SheetLayout layout;
    PreviewSession session(options.render, events, [&](Shot& shot) {
        layout = sheet_layout(options.columns, options.rows, shot.image);
        if (options.render.overrides.width > 0) {
            layout.tile_width = shot.image.width;
            layout.tile_height = shot.image.height;
        }
        check_sheet_size(layout);
        shot.image.width = layout.tile_width;
        shot.image.height = layout.tile_height;
    });
    const std::vector<int> frames = spread(frames_of(options, session), layout.tiles());
    const std::filesystem::path file = file_of(options, session.shot().name + ".sheet.png", frames.front());
    Image sheet = empty_sheet(layout);
    std::vector<FrameTime> times;
    for (const int frame : frames) {
        const int tile = static_cast<int>(times.size());
        times.push_back(session.frame(frame));
        place_tile(sheet, layout, tile, session.picture(times.back(), static_cast<int>(frames.size()) - tile - 1));
    }
    label_tiles(sheet, layout, times);
    return deliver(session, file, sheet, "sheet", frames);
}

/// Whether the picture's frame of reference is the same at all of these times, their shutters included.
bool camera_stands_still(const BoundShot& shot, const std::vector<FrameTime>& times) {
    const CameraState first = camera_at(shot, times.front().open_s);
    return std::all_of(times.begin(), times.end(), [&](const FrameTime& time) {
        return camera_at(shot, time.open_s) == first && camera_at(shot, 0.5 * (time.open_s + time.close_s)) == first &&
               camera_at(shot, time.close_s) == first;
    });
}

/// The frames that were asked for, or seven of the shot's.
std::vector<int> onion_frames(const PreviewOptions& options, const PreviewSession& session) {
    constexpr int kGhosts = 7;
    constexpr std::size_t kMostGhosts = 32;
    if (!options.frames) return spread(session.bound().timing().frames, kGhosts);
    if (options.frames->size() <= kMostGhosts) return *options.frames;
    throw InputError(fmt::format("--frames gives {} frames to --onion", options.frames->size()),
                     fmt::format("expected at most {}: take every nth, as in --frames 0-40x5", kMostGhosts));
}

FrameReport preview_onion(const PreviewOptions& options, const RenderEvents& events) {
    PreviewSession session(options.render, events, [&](Shot& shot) {
        limit_width(options)(shot);
        shot.render.seed_animated = false;  // the same noise where nothing changes
    });
    const std::vector<int> frames = onion_frames(options, session);
    const std::filesystem::path file = file_of(options, session.shot().name + ".onion.png", frames.front());
    std::vector<FrameTime> times;
    for (const int frame : frames) times.push_back(session.frame(frame));
    std::vector<Image> pictures;
    for (const FrameTime& time : times)
        pictures.push_back(session.picture(time, static_cast<int>(times.size() - pictures.size()) - 1));
    const bool still = camera_stands_still(session.bound(), times);
    Image onion = overlay_frames(pictures, still);
    label_ghosts(onion, times, still);
    FrameReport report = deliver(session, file, onion, "onion", frames);
    if (!still) report.note = "the camera moves: this is the plain mean of the frames; see --path for its way";
    return report;
}

/// The layer of metres along the view axis of a frame.
std::vector<float> depth_of(const Image& image) {
    const auto channel = std::find(image.channels.begin(), image.channels.end(), "depth.Z");
    const std::size_t stride = image.channels.size();
    std::vector<float> depth;
    for (std::size_t at = static_cast<std::size_t>(channel - image.channels.begin()); at < image.pixels.size();
         at += stride)
        depth.push_back(image.pixels[at]);
    return depth;
}

/// A picture of what moves, seen by the shot's camera or by a second one.
class PathPreview {
public:
    PathPreview(const PreviewOptions& options, PreviewSession& session)
        : options_(options),
          session_(session),
          time_(time_of(options, session)),
          times_(path_times(session.bound(), frames_of(options, session))),
          paths_(motion_paths(session.bound(), times_, time_.time_s())) {}

    Image draw() {
        if (options_.from == Viewpoint::camera) return draw_from(session_.bound());
        const Shot second = overview_shot(session_.bound(), paths_, times_, options_.from, time_.time_s());
        return draw_from(BoundShot(second, session_.loaded().scene()));
    }
    const FrameTime& time() const { return time_; }
    std::string note() const;

private:
    Image draw_from(const BoundShot& shot);

    const PreviewOptions& options_;
    PreviewSession& session_;
    const FrameTime time_;
    const PathTimes times_;
    const std::vector<MotionPath> paths_;
    int left_out_ = 0;
    bool nothing_shows_ = false;
};

Image PathPreview::draw_from(const BoundShot& shot) {
    constexpr int kMostObjects = 6;  // and lights
    FilmLayers layers;
    layers.depth = true;
    const RenderedFrame frame = session_.render(shot, time_, layers);
    Image picture = session_.picture(frame);
    const ScreenCamera camera(camera_at(shot, time_.time_s()), picture.width, picture.height);
    std::vector<ScreenPath> seen;
    for (const MotionPath& path : paths_) seen.push_back(project(path, times_, camera));
    left_out_ = keep_most_prominent(seen, kMostObjects);
    nothing_shows_ = seen.empty();
    draw_paths(picture, seen, time_.number, depth_of(frame.image));
    if (options_.from != Viewpoint::camera) draw_frustum(picture, camera, camera_at(session_.bound(), time_.time_s()));
    return picture;
}

std::string PathPreview::note() const {
    if (paths_.empty()) return "nothing moves during these frames";
    if (nothing_shows_) return "nothing that moves is in the picture; try --from iso";
    return left_out_ == 0 ? "" : fmt::format("{} more things move; those with the longest paths are drawn", left_out_);
}

constexpr const char* kViewpointNames[] = {"path", "path-side", "path-top", "path-iso"};

FrameReport preview_path(const PreviewOptions& options, const RenderEvents& events) {
    PreviewSession session(options.render, events, limit_width(options));
    PathPreview path(options, session);
    const int frame = path.time().number;
    const char* name = kViewpointNames[static_cast<std::size_t>(options.from)];
    const std::filesystem::path file =
        file_of(options, fmt::format("{}.{:04}.{}.png", session.shot().name, frame, name), frame);
    const Image picture = path.draw();
    FrameReport report = deliver(session, file, picture, "path", {frame});
    report.note = path.note();
    return report;
}

using Preview = FrameReport (*)(const PreviewOptions&, const RenderEvents&);
/// [PreviewKind]
constexpr std::array<Preview, 4> kPreviews{preview_still, preview_sheet, preview_onion, preview_path};

}  // namespace

FrameReport render_preview(const PreviewOptions& options, const RenderEvents& events) {
    check_output(options);
    FrameReport report = kPreviews[static_cast<std::size_t>(options.kind)](options, events);
    events.frame_done(report);
    return report;
}

}  // namespace kadr
