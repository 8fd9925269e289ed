#pragma once

#include <map>
#include <vector>

#include "frame/layered_track.h"
#include "frame/node_rig.h"
#include "scene/scene.h"

namespace kadr {

/// The weights of the morph targets of every node over time: the mix of the clips that play, else what the file says.
class MorphRig {
public:
    /// @param scenes  one per scene file
    MorphRig(const Scene& scene, const std::vector<BoundScene>& scenes);

    bool moves(int node) const { return animated_.count(node) > 0; }
    std::vector<double> weights(int node, double time_s, double clip_offset_s = 0) const;  ///< [morph target]
    /// Times inside (begin, end) where a weight jumps.
    std::vector<double> discontinuities(double begin_s, double end_s, double clip_offset_s = 0) const;
    /// Keys inside (begin, end) of a node's weights.
    std::vector<double> key_times_of(int node, double begin_s, double end_s, double clip_offset_s = 0) const;

private:
    using Weights = std::vector<LayeredTrack<double>>;  ///< [morph target]
    void bind(const NodeChannels& channels, int layer);

    const Scene* scene_;
    std::vector<PlayingLayer> layers_;  ///< of all files
    std::map<int, Weights> animated_;   ///< by node
};

}  // namespace kadr
