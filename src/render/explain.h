#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "device/device.h"
#include "frame/shot_needs.h"
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

/// What a shot asks for, what is left out, and what that will take; found without building or rendering anything.
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
    std::uint64_t pixel_samples = 0;  ///< of a frame, at most
    std::vector<Diagnostic> warnings;
};

/// Of images the headers are read alone.
/// @throws InputError
Explanation explain_shot(const std::filesystem::path& shot, const ShotOverrides& overrides, const DeviceRequest& device);

}  // namespace kadr
