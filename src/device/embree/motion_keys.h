#pragma once

#include <vector>

#include "device/embree/embree_api.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// The motion frames of one instance as Embree and the kernels take them.
struct MotionKeys {
    bool linear = true;  ///< one or two matrices; decomposed keys otherwise
    std::vector<kernels::Affine> matrices;
    std::vector<kernels::TransformKey> keys;
};

MotionKeys motion_keys(const MotionFrames& motion, std::size_t instance);

/// Embree's quaternion form of a key: translation * rotation * (scale with shear above the diagonal).
RTCQuaternionDecomposition to_embree(const kernels::TransformKey& key);

}  // namespace kadr
