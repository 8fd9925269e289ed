#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "device/device.h"
#include "frame/shot_needs.h"
#include "render/frame_cost.h"
#include "render/memory_forecast.h"
#include "render/requirements.h"
#include "shot/shot_parser.h"

namespace kadr {

/// The glTF extensions of a scene entry's file.
struct FileExtensions {
    std::string scene;  ///< the entry's id
    std::vector<std::string> followed, ignored;
};

/// A set of kernels that some frames are rendered with.
struct KernelUse {
    std::string name;        ///< what it is compiled for: "maps + emitters"
    std::vector<int> frames; ///< of those that were looked at
};

/// What a shot asks for, what is left out, and what that will take; but for the cost found without building or rendering
/// anything.
struct Explanation {
    std::string shot;
    int frames = 0, first_frame = 0, last_frame = 0;
    int width = 0, height = 0, samples = 0;
    std::string device, device_why;
    std::string integrator;
    RequirementSet needs;
    std::vector<Unread> left_out;
    std::vector<FileExtensions> extensions;
    std::vector<KernelUse> kernels;
    std::string robust;               ///< whether rays are robust, and why: "no; few would slip between triangles"
    MemoryForecast memory;
    std::uint64_t pixel_samples = 0;  ///< of a frame, at most
    std::optional<FrameCost> cost;    ///< where it was asked for
    std::vector<Diagnostic> warnings;
};

struct ExplainOptions {
    std::filesystem::path shot;
    ShotOverrides overrides;
    DeviceRequest device;
    bool measure = false;  ///< render a little of the middle frame, to say what a frame costs
};

/// Of images the headers are read alone, unless a frame is rendered.
/// @throws InputError; where a frame is rendered RenderError and Interrupted, too
Explanation explain_shot(const ExplainOptions& options);

}  // namespace kadr
