#pragma once

#include <functional>

#include "device/device.h"

namespace kadr {

/// What the fake device does; set by a test before it renders.
struct FakeDeviceScript {
    BuildSettings build;                              ///< of the last load()
    int renders = 0;                                  ///< calls of render() so far
    int set_frames = 0;                               ///< calls of set_frame() so far
    int staged = 0;                                   ///< of them, with what was staged
    std::vector<Pass> passes;                         ///< as they came
    std::function<void(int render)> before_render;    ///< called with the count so far
    std::function<void(int device, int frame)> on_frame;   ///< called by that device's thread when it begins a pass
    int devices = 1;                                  ///< that make_devices gives
    float scale = 1;                                  ///< times the gradient
    float noise = 0;                                  ///< added in one half and taken off the other, once more in each frame
};
FakeDeviceScript& fake_device();

}  // namespace kadr
