#pragma once

#include <string>
#include <vector>

#include "frame/snapshot.h"
#include "render/loaded_shot.h"

namespace kadr {

/// What one part of a render takes in memory at the moment when all together take the most.
struct MemoryPart {
    std::string name;   ///< "textures"
    double bytes = 0;
    std::string of;     ///< what it is made of: "7 images, the largest 2048 x 2048"
};

struct MemoryForecast {
    std::vector<MemoryPart> parts;
    std::string moment;  ///< when: "the frame's structures are built"
    double total() const;
};

/// What has to be known of a render beside its shot.
struct RenderExtent {
    double program_bytes = 0;   ///< of the program before it reads anything, with its libraries
    int threads = 1;
    int frames = 1;             ///< that are rendered one after another
};

/// Peak memory of rendering on the CPU. Within a tenth of what was measured (tests/cli/explain_test.py); what a denoiser
/// and ffmpeg take comes on top.
/// @param parts  snapshots of a frame that takes as much as any
MemoryForecast forecast_memory(const LoadedShot& shot, const std::vector<SceneSnapshot>& parts, const RenderExtent& extent);

}  // namespace kadr
