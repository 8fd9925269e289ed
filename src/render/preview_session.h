#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "output/image_io.h"
#include "render/frame_renderer.h"
#include "render/loaded_shot.h"
#include "render/render_job.h"
#include "render/stopwatch.h"

namespace kadr {

/// A shot on a device at preview quality: what stills, sheets, onions and paths share.
class PreviewSession {
public:
    /// Loads the shot with few samples; `adjust` has the last word, before anything is loaded.
    /// @throws InputError
    PreviewSession(const RenderOptions& options, const RenderEvents& events, const std::function<void(Shot&)>& adjust);

    const LoadedShot& loaded() const { return loaded_; }
    const Shot& shot() const { return loaded_.shot(); }
    const BoundShot& bound() const { return loaded_.bound(); }
    /// A frame, or what would be one at a time: inside the shot's range or not.
    /// @throws InputError  where a track has left its range then, which was looked at over the shot's frames alone
    FrameTime frame(int number) const { return checked(bound().sequence().frame(number)); }
    FrameTime at_time(double time_s) const { return checked(bound().sequence().at_time(time_s)); }
    /// The shot's view at a time, with its exposure metered where it is automatic.
    ViewSpec view(double time_s);

    /// @param frames_left  for the progress bar
    RenderedFrame render(const BoundShot& shot, const FrameTime& time, const FilmLayers& layers, int frames_left = 0);
    /// A frame as it looks on a display: R, G, B over black.
    Image picture(const FrameTime& time, int frames_left = 0);
    Image picture(const RenderedFrame& frame);

    /// What all frames so far took; `seconds` since the session began.
    FrameReport report() const;
    /// Says what a picture is without passing for a frame of the shot: no settings hash, no frame number.
    Metadata metadata(const std::string& kind, const std::vector<int>& frames) const;
    /// Writes a display-referred picture. @throws RenderError
    void write(const std::filesystem::path& file, const Image& picture, const Metadata& metadata) const;
    const std::string& device_name() const { return device_name_; }

private:
    FrameTime checked(const FrameTime& time) const;

    Stopwatch watch_;
    const RenderEvents& events_;
    DeviceChoice choice_;
    std::string device_name_;
    LoadedShot loaded_;
    FrameRenderer renderer_;
    ViewSpec view_;
    FrameReport report_;
};

}  // namespace kadr
