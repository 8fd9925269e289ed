#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "frame/reach.h"
#include "frame/snapshot.h"

namespace kadr {

/// Instances of a snapshot with their frames. Parallel lists are those of SceneSnapshot and MotionFrames.
struct PlacedInstances {
    std::vector<SnapshotInstance> instances;
    std::vector<glm::dmat4> fixed_places;
    std::vector<kernels::TransformHeader> headers;
    std::vector<FrameType> types;
    std::vector<std::uint8_t> linear;
    std::vector<kernels::FrameSrt> srt;
    std::vector<kernels::FrameMatrix> matrices;
    Reach reach;
    std::uint64_t key = 0;  ///< hash of all lists
};

/// Hash of the lists of placed instances.
std::uint64_t key_of(const PlacedInstances& placed);

/// What stands still in a shot, in the last render spaces: snapshots of one space share one object.
class StillInstances {
public:
    /// Null: not known yet.
    std::shared_ptr<const PlacedInstances> find(const RenderSpace& space) const;
    /// @return what snapshots shall share: where another thread was quicker, its object
    std::shared_ptr<const PlacedInstances> keep(const RenderSpace& space, std::shared_ptr<const PlacedInstances> placed);

private:
    using Entry = std::pair<RenderSpace, std::shared_ptr<const PlacedInstances>>;
    mutable std::mutex mutex_;
    std::vector<Entry> latest_;  ///< the newest last
};

}  // namespace kadr
