#pragma once

#include "device/embree/embree_api.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

// The motion frames of the snapshot as Embree and the kernels take them. An instance has one or two matrices where they
// are interpolated linearly, decomposed keys otherwise.

bool is_linear(const MotionFrames& motion, std::size_t instance);
kernels::Affine matrix_at(const MotionFrames& motion, std::size_t instance, std::size_t frame);
kernels::TransformKey key_at(const MotionFrames& motion, std::size_t instance, std::size_t frame);

/// Embree's quaternion form of a key: translation * rotation * (scale with shear above the diagonal).
RTCQuaternionDecomposition to_embree(const kernels::TransformKey& key);

}  // namespace kadr
