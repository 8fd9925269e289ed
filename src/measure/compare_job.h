#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "anim/timing.h"
#include "measure/frame_difference.h"
#include "measure/frame_sequence.h"
#include "render/render_job.h"

namespace kadr {

/// What two images can be compared by.
enum class Metric { flip, rmse, relmse, psnr, ssim };
/// "flip", "rmse", "relmse", "psnr", "ssim"
std::string name_of(Metric metric);
double value_of(const FrameDifference& difference, Metric metric);
/// PSNR and SSIM are large where images are alike.
constexpr bool more_is_better(Metric metric) { return metric == Metric::psnr || metric == Metric::ssim; }

/// What no frame may pass: an upper bound, or a lower one of what is better when large.
struct Limit {
    Metric metric = Metric::flip;
    double value = 0;
};
/// "0.05" (FLIP), "flip=0.05,psnr=30". @throws InputError
std::vector<Limit> parse_limits(const std::string& text);

struct CompareOptions {
    std::string reference, test;  ///< an image, a folder, a pattern or a shot, each
    std::vector<int> frames;      ///< those to compare; empty: all
    DifferenceOptions difference;
    std::filesystem::path maps;   ///< folder for the error maps; empty: none
    std::filesystem::path video;  ///< reference, test and error map side by side; empty: none
    Rational fps{24, 1};          ///< of the video
    std::vector<Limit> limits;
    DeviceRequest device;  ///< what shots are rendered on
};

/// One frame, compared.
struct ComparedFrame {
    FramePair pair;
    FrameDifference difference;
    std::filesystem::path map;          ///< empty: none
    std::vector<std::string> failures;  ///< "flip 0.0713 is above 0.05"
};

struct CompareSummary {
    std::vector<ComparedFrame> frames;
    FrameDifference mean;   ///< of the figures over the frames; its largest difference is that of all
    std::size_t worst = 0;  ///< index of the frame with the largest FLIP
    std::filesystem::path video;
    bool failed = false;  ///< a frame passes a limit, or holds NaN while there is a limit
};

struct CompareEvents {
    RenderEvents render;  ///< of shots whose frames are missing
    std::function<void(const ComparedFrame&)> frame_done = [](const ComparedFrame&) {};
};

/// Compares two frames or two sequences. Frames of a shot that are missing or old are rendered first, as `kadr render`
/// does; no video is made of them.
/// @throws InputError, RenderError, Interrupted
CompareSummary compare(const CompareOptions& options, const CompareEvents& events);

}  // namespace kadr
