#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "device/embree/structure.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// The upper level of a scene: an Embree instance for each of the snapshot's that is shown as one.
///
/// Making an instance anew costs more than moving it: each stays from frame to frame with its place in the snapshot, and
/// a new frame sets its mesh and transforms and builds the level over them. 16 bytes an instance beside Embree's own.
class InstanceLevel {
public:
    explicit InstanceLevel(RTCDevice device, const BuildSettings& build = {}) : device_(device), level_(new_structure(device, build)) {}

    /// How many instances the frame has, shown or not. Those beyond are dropped.
    void resize(std::size_t count);

    // What is at an index in this frame. Different indices may be set at the same time; commit() follows.
    void hide(std::size_t index);
    /// @param frames  world_from_object, evenly spaced over the shutter; one to 129
    void show(std::size_t index, RTCScene mesh, std::span<const kernels::Affine> frames);
    /// The same with frames between which rotations go by slerp; two to 129.
    void show(std::size_t index, RTCScene mesh, std::span<const kernels::TransformKey> frames);

    /// Builds the level over all that is shown. The caller asks the device for errors.
    void commit();
    RTCScene scene() const { return level_.get(); }

private:
    struct Slot {
        EmbreeGeometryHandle geometry;
        unsigned frame_count = 0;
        bool slerps = false, shown = false;
        bool fresh = false, attached = false;  ///< made for this frame; known to the level
    };
    static_assert(sizeof(Slot) == 16);
    RTCGeometry prepare(std::size_t index, RTCScene mesh, std::size_t frame_count, bool slerps);

    RTCDevice device_;
    EmbreeSceneHandle level_;
    std::vector<Slot> slots_;
};

}  // namespace kadr
