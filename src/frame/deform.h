#pragma once

#include "frame/deformer.h"
#include "frame/snapshot.h"

namespace kadr {

/// @throws InputError  naming the node whose joints or weights are not finite
DeformationPose finite_pose(const BoundShot& shot, const Bindings& bindings, const Deformer& deformer, double time_s, double clip_offset_s);

/// Fills snapshot.deformed for the part [open_s, close_s] of the shutter and points the instances at it; raises
/// snapshot.motion.max_error_px to what keys of places and of vertices make together. Follows add_motion_frames.
///
/// Keys are evenly spaced, as few as keep the linear way between them within the motion tolerance at every vertex; one
/// where nothing bends within the part. For linear skinning the deviation is bounded joint by joint: a vertex lies among
/// the places where its joints would carry it, so it strays no farther than the corner of a joint's box that strays
/// farthest. Dual quaternions are compared vertex by vertex.
/// @throws InputError  naming the node whose joints or weights are not finite
void add_deformed(const BoundShot& shot, double open_s, double close_s, SceneSnapshot& snapshot);

/// Positions of the snapshot's deformed meshes at one time: [deformed mesh][vertex].
std::vector<std::vector<kernels::Vec3f>> deformed_positions(const BoundShot& shot, const SceneSnapshot& snapshot, double time_s);

}  // namespace kadr
