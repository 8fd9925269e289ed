#pragma once

#include <optional>

#include "frame/snapshot.h"
#include "scene/scene.h"

namespace kadr {

/// A frame in which nothing moves while it is sheared, which HIPRT 3.1 traces wrongly (its inverse of such frames mixes
/// coordinates of the world and of the object): what does becomes a mesh that bends, placed by a still transform. Its
/// vertices go by our own matrices, straight from key to key; keys are added until no corner of its box strays from its
/// way by more than kShearedMotionError_px.
/// @return nothing where there is no such motion
std::optional<SceneSnapshot> bend_sheared_motion(const SceneSnapshot& snapshot, const Scene& scene);

/// Half of the default motion tolerance.
inline constexpr double kShearedMotionError_px = 0.05;

}  // namespace kadr
