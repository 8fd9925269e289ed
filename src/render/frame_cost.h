#pragma once

#include <cstdint>

#include "device/device.h"
#include "render/loaded_shot.h"

namespace kadr {

/// What a frame will cost in time, from a small rendering of it.
struct FrameCost {
    int frame = 0;                     ///< that was rendered
    int width = 0, height = 0, samples = 0;  ///< how
    double load_s = 0;                 ///< structures of the whole shot and of the frame, as they were built
    double pixel_samples_per_s = 0;    ///< traced, on all threads
    double rays_per_sample = 0;
    double trace_s = 0;                ///< of a whole frame: its pixels times its samples at that rate
};

/// Loads the device with the shot and renders a frame twice, at most 160 pixels wide with at most 4 samples; the second
/// time counts.
/// @param shot  with its textures decoded
/// @throws InputError, RenderError, Interrupted
FrameCost measure_frame_cost(const LoadedShot& shot, Device& device, int frame);

}  // namespace kadr
