#pragma once

#include <vector>

#include "frame/decompose.h"
#include "frame/instance_fit.h"
#include "frame/snapshot.h"

namespace kadr {

/// world_from_geometry (in the render space) of an instance at a time in [0, 1] of the shutter, as every device has it:
/// evenly spaced frames, T * R * S with shear linearly, rotation by slerp along the shorter arc; matrices linearly where the shot
/// asks for it.
/// Times outside [0, 1] clamp.
glm::dmat4 interpolate(const MotionFrames& motion, std::size_t instance, double time);

/// One frame of an instance in its parts.
Decomposition frame_parts(const MotionFrames& motion, std::size_t instance, std::size_t frame);

/// Frames in the layout of a device. The axis keeps to that of `previous` where there is one, so that angles run
/// through zero instead of jumping to the other side; angle in [-pi, pi].
kernels::FrameSrt to_srt(const Decomposition& parts, float time, const kernels::FrameSrt* previous);
kernels::FrameMatrix to_matrix(const Decomposition& parts, float time);

/// Fills snapshot.instances and snapshot.motion for the part [open_s, close_s] of the shutter. The snapshot's render
/// origin is set already.
/// @throws InputError  naming the nodes whose transform is not finite, or whose scale passes through zero
MotionFit add_motion_frames(const BoundShot& shot, double open_s, double close_s, SceneSnapshot& snapshot);

}  // namespace kadr
