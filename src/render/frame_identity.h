#pragma once

#include <string>

#include "anim/timing.h"
#include "base/hash.h"
#include "output/image_io.h"
#include "render/frame_renderer.h"
#include "render/loaded_shot.h"

namespace kadr {

/// Hashes of all that affects one frame's pixels: shot values, assets, program version and the frame itself; not the
/// frame range, paths, threads or comments. A linear file (EXR) does not depend on the view.
struct FrameIdentity {
    std::string linear, display;
    const std::string& of(bool is_linear) const { return is_linear ? linear : display; }
};

/// Hashes what is common to all frames once (assets can be large), then one frame at a time.
class ShotIdentity {
public:
    /// @param metered_frame  the frame whose brightness an automatic exposure holds
    /// @throws InputError  when the environment image cannot be read
    ShotIdentity(const LoadedShot& shot, int metered_frame);
    FrameIdentity of(const FrameTime& frame) const;

private:
    std::string linear_, display_;
};

/// Whether files of this name hold linear values (no view applied).
bool is_linear_file(const std::filesystem::path& path);

/// What every picture of a shot says about itself: what was rendered, with what.
Metadata shot_metadata(const Shot& shot, const std::string& device_name);

/// What a frame's file says about itself, but for "settings".
Metadata frame_metadata(const Shot& shot, const FrameTime& time, const RenderedFrame& frame,
                        const std::string& device_name);

/// The relative mean square error that a frame's file says it has; 0 where it says nothing.
double stored_relmse(const std::filesystem::path& frame);

}  // namespace kadr
