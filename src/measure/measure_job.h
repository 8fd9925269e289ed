#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "measure/frame_error.h"
#include "measure/sweep.h"
#include "render/render_job.h"

namespace kadr {

struct MeasureOptions {
    RenderOptions render;            ///< the shot, what the command line lays over it, the device
    std::filesystem::path output;    ///< folder of the report and its images; empty: NAME.measure in the working folder
    bool quick = false;              ///< smaller, fewer frames and values: under a minute for a shot of the samples' kind
    std::vector<std::string> axes;   ///< empty: all
};

/// A variant in one frame.
struct MeasuredFrame {
    int frame = 0;
    double seconds = 0;              ///< wall time of the frame, the less of both images
    FrameError error;
    std::optional<double> flicker;   ///< towards the next frame, where that was measured too
    std::filesystem::path a, b;      ///< the images
};

/// A variant over its frames.
struct MeasuredVariant {
    Variant variant;
    std::vector<MeasuredFrame> frames;
    double seconds = 0;              ///< means over the frames
    FrameError error;
    std::optional<double> flicker;
    bool on_front = false;           ///< nothing measured is both faster and closer to the truth by FLIP
    std::filesystem::path picture, map;  ///< display-referred PNG of the first frame, and its FLIP error map
};

/// Where the error of the shot's own settings comes from: relative mean squares.
struct ErrorShares {
    double noise = 0, bounces = 0, motion = 0, clamp = 0, denoise = 0, texture = 0, other = 0;
};

/// What the figures say to do.
struct Recommendation {
    std::string text;                                          ///< a few sentences
    std::vector<std::pair<std::string, std::string>> render;   ///< keys of the render section and their values
    MeasuredVariant measured;                                  ///< those settings, rendered and measured
    /// "render: { samples: 64, bounces: 2 }"
    std::string yaml() const;
};

struct Measurement {
    std::string shot;
    std::filesystem::path folder;    ///< of the report
    int width = 0, height = 0, shot_width = 0, shot_height = 0;
    std::vector<int> frames;
    std::string device;
    int samples = 0;                 ///< of every variant but those of the sweep of samples
    int reference_samples = 0;
    double reference_noise = 0;      ///< relative mean square of the noise that is left in the reference
    std::vector<std::filesystem::path> references;   ///< [frame] r1, then r2
    std::filesystem::path reference_picture;
    std::vector<MeasuredVariant> variants;           ///< the shot's own settings first
    std::vector<LeftOut> left_out;
    ErrorShares shares;
    Recommendation recommendation;
};

struct MeasureEvents {
    RenderEvents render;
    std::function<void(const MeasuredVariant&, int done, int count)> variant_done = [](const MeasuredVariant&, int, int) {};
};

/// Renders the shot in many ways and says what each costs and errs. Images that are complete are kept, references (in the
/// cache folder) by what they were made of: a run that was stopped goes on.
/// @throws InputError, RenderError, Interrupted
Measurement measure(const MeasureOptions& options, const MeasureEvents& events);

/// The advice that measured variants give, but for its own measurement. @pre the shot's own settings are first
Recommendation recommend(const std::vector<MeasuredVariant>& variants, const RenderSpec& render, int samples);
ErrorShares shares_of(const std::vector<MeasuredVariant>& variants);
/// Sets on_front.
void mark_front(std::vector<MeasuredVariant>& variants);

/// Writes measure.json and measure.csv, then the page measure.html, which python3 with matplotlib draws.
/// @return the page  @throws RenderError  also where the page cannot be drawn; the other two are there then
std::filesystem::path write_report(const Measurement& measurement);

}  // namespace kadr
