#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "measure/frame_difference.h"
#include "measure/ray_agreement.h"
#include "measure/z_test.h"
#include "render/loaded_shot.h"
#include "render/render_job.h"

namespace kadr {

/// Makes a device by its name in the report, for a shot.
using DeviceMaker = std::function<std::unique_ptr<Device>(const std::string& name, const LoadedShot& shot)>;

struct DeviceComparisonOptions {
    RenderOptions render;  ///< the shot, what the command line lays over it, threads of the CPU
    std::pair<std::string, std::string> devices{"cpu", "hiprt"};
    int samples = 16;              ///< of a pixel in each replicate
    int replicates = 8;            ///< at least two
    std::filesystem::path output;  ///< folder of pictures, maps and the JSON; empty: none
    DeviceMaker make;              ///< empty: make_compared_device
};

/// "cpu,hiprt:1" @throws InputError  unless it is two names of compared devices
std::pair<std::string, std::string> parse_device_pair(const std::string& text);

/// cpu; cpu:1 and cpu:8, the processor at so many lanes; hiprt and hiprt:N; exact, the reference in double precision.
/// @throws InputError  for a device that this machine does not have, with the reason
std::unique_ptr<Device> make_compared_device(const std::string& name, const LoadedShot& shot, int threads);

struct DeviceTimes {
    double load_s = 0;       ///< of the shot, once
    double set_frame_s = 0;  ///< of the frame's parts, the first time
    double render_s = 0;     ///< of all replicates
    std::uint64_t rays = 0;  ///< of all replicates
    double rays_per_s() const { return render_s > 0 ? static_cast<double>(rays) / render_s : 0; }
};

/// One frame on both devices.
struct ComparedDeviceFrame {
    int frame = 0;
    RayAgreement rays;
    ZTest noise;
    FrameDifference pictures;     ///< of the means of all replicates
    FrameDifference noise_alone;  ///< of two means of half the replicates, of the first device: what noise would show
    DeviceTimes times[2];
    std::uint64_t dropped[2] = {0, 0};
    std::vector<std::filesystem::path> files;
    bool differs() const { return rays.wrong() > 0 || noise.differs(); }
};

struct DeviceComparison {
    std::string shot;
    std::string names[2];    ///< as they were asked for
    std::string devices[2];  ///< as they call themselves
    int width = 0, height = 0, samples = 0, replicates = 0;
    std::vector<ComparedDeviceFrame> frames;
    std::filesystem::path json;  ///< empty: none was written
    bool differs() const;
    /// "cpu and hiprt render the same, as far as 3 frames show", or what does not agree.
    std::string verdict() const;
};

/// Renders frames on two devices (the first, the middle and the last where the shot's range is not narrowed) and says
/// whether they show the same.
/// @throws InputError  bad input; a device that is missing, with the reason
/// @throws RenderError, Interrupted
DeviceComparison compare_devices(const DeviceComparisonOptions& options,
                                 const std::function<void(const ComparedDeviceFrame&)>& frame_done);

/// The report as a JSON object.
std::string json_of(const DeviceComparison& comparison);

}  // namespace kadr
