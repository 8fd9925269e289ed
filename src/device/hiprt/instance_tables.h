#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "device/hiprt/hiprt_abi.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// Where the instances of a frame are, as the kernels and as HIPRT take it.
struct InstanceTables {
    // [instance of the snapshot]
    std::vector<kernels::Instance> instances;
    std::vector<kernels::InstanceMotion> motions;  ///< one matrix where it is still, keys where it moves
    std::vector<kernels::Affine> matrices;
    std::vector<kernels::TransformKey> keys;

    // [instance of HIPRT]: what is shown and has triangles
    std::vector<hiprt::Instance> shown;
    std::vector<std::uint32_t> masks;
    std::vector<unsigned> instance_of;  ///< index into the snapshot's instances
    std::vector<kernels::TransformHeader> headers;
    /// HIPRT has one type of frames a scene: matrices where anything shown is sheared. The other list is empty.
    hiprt::FrameType frame_type = hiprt::FrameType::srt;
    std::vector<kernels::FrameSrt> srt;
    std::vector<kernels::FrameMatrix> frame_matrices;

    std::uint64_t moving = 0;  ///< of those shown
    std::size_t frame_count() const { return frame_type == hiprt::FrameType::srt ? srt.size() : frame_matrices.size(); }
};

/// What an instance shows.
struct ShownMesh {
    unsigned geometry = 0;                ///< among the kernels' geometries
    hiprt::Geometry structure = nullptr;  ///< null: nothing to see
};

/// @param mesh_of  of an instance of the snapshot
/// @pre nothing moves while it is sheared (sheared_motion.h)
/// @throws InputError  for more instances than HIPRT counts
InstanceTables make_instance_tables(const SceneSnapshot& snapshot,
                                    const std::function<ShownMesh(std::size_t instance)>& mesh_of);

}  // namespace kadr
