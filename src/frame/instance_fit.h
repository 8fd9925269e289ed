#pragma once

#include <span>
#include <vector>

#include "base/error.h"
#include "frame/camera_keys.h"
#include "frame/decompose.h"
#include "frame/frame_state.h"
#include "frame/instance_list.h"
#include "frame/reach.h"
#include "frame/render_space.h"

namespace kadr {

/// A part of the shutter, and what the camera does in it.
struct Interval {
    const BoundShot& shot;
    RenderSpace space;
    double open_s, close_s;
    double tolerance_px;
    int image_height;

    double time(double u) const { return open_s + u * (close_s - open_s); }
    /// Where the shot has a fixed number of motion frames; null: as many as the tolerance asks for.
    const FixedMotionFrames* fixed() const;
    /// The camera's view of points that are relative to the render origin.
    PixelScale scale_at(double u) const;
};

/// How near the motion frames of a part of the shutter come.
struct MotionFit {
    bool too_fast = false;          ///< something turns so fast that 129 frames are not enough: nothing was added
    bool missed = false;            ///< something strays beyond the motion tolerance although it has 129 frames
    double widest_step_rad = 0;     ///< between two frames, where their number is fixed
    Reach reach;                    ///< of all instances
    std::vector<double> corners_s;  ///< keys, beside every even grid, of what strays: good times to split the shutter at
};

/// The frames of some instances, evenly spaced over the interval; metres relative to the render origin.
struct InstanceFits {
    /// Of one instance: its frames lie in the list below.
    struct Fitted {
        std::uint32_t first = 0, count = 0;
        bool linear = false;  ///< linearly interpolated matrices would do
        bool hidden = false;  ///< it has no size, and no frames
        float error_px = 0;
    };
    std::vector<Fitted> fitted;          ///< parallel to the instances
    std::vector<Decomposition> frames;
    std::vector<Diagnostic> problems;    ///< transforms that are not finite, scales that pass through zero
    MotionFit quality;
};

/// As few frames as keep every instance within the motion tolerance, by doubling; or as many as the shot says.
InstanceFits fit_instances(const Interval& interval, std::span<const Instance> instances);

}  // namespace kadr
