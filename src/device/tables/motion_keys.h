#pragma once

#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

// The motion frames of the snapshot as the kernels take them: matrices, or decomposed keys.

/// Whether the instance is at rest, or between linearly interpolated matrices.
bool is_linear(const MotionFrames& motion, std::size_t instance);
kernels::Affine matrix_at(const MotionFrames& motion, std::size_t instance, std::size_t frame);
kernels::TransformKey key_at(const MotionFrames& motion, std::size_t instance, std::size_t frame);

}  // namespace kadr
