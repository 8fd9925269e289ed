#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "anim/timing.h"
#include "film/film.h"
#include "output/sound_plan.h"
#include "shot/shot.h"

namespace kadr {

/// A video setting with everything filled in: codec by extension, pixel format by codec.
struct VideoPlan {
    std::filesystem::path file;
    VideoCodec codec = VideoCodec::h264;
    std::string encoder;        ///< ffmpeg's name: "libx264"
    std::string pixel_format;   ///< "yuv420p"
    std::optional<int> crf;     ///< filled in for the codecs that have one
    int width = 0, height = 0;
    Rational fps;
    std::filesystem::path ffmpeg;   ///< the program
    std::optional<SoundPlan> sound; ///< filled in by plan_sound
};

/// How messages call the keys that the size and the rate come from: those of a shot, or of a reel.
struct VideoKeys {
    const char* size = "image.size";
    const char* fps = "timing.fps";
};

/// Checks all that can be known before the first frame: ffmpeg's presence, the encoder, the pixel format, even sizes for
/// 4:2:0, the extension. ffmpeg's probe is cached (KADR_CACHE, else XDG_CACHE_HOME, else ~/.cache, folder kadr).
/// @throws InputError  with the remedy
VideoPlan plan_video(const VideoSpec& spec, int width, int height, Rational fps, const VideoKeys& keys = {});

/// ffmpeg as a child process that is fed raw frames.
class Encoder {
public:
    /// Starts ffmpeg writing to a temporary name beside the file. @throws RenderError
    explicit Encoder(const VideoPlan& plan);
    ~Encoder();   ///< not finished: ends ffmpeg and removes the temporary file
    Encoder(const Encoder&) = delete;
    Encoder& operator=(const Encoder&) = delete;
    /// Appends one display-referred frame (R, G, B in [0, 1] as written; 8 or 16 bits by the pixel format).
    /// @throws RenderError  with ffmpeg's own last lines
    void push(const Image& display);
    /// Ends the file, verifies that it has as many frames as were pushed, renames. @throws RenderError
    void finish();

private:
    struct Process;
    std::unique_ptr<Process> process_;
};

}  // namespace kadr
