#pragma once

#include <map>
#include <vector>

#include "frame/layered_track.h"
#include "frame/node_rig.h"
#include "scene/scene.h"

namespace kadr {

/// The weights of the morph targets of every node over time: what the shot says of them, else the mix
/// of the clips that play, else what the file says.
class MorphRig {
public:
    /// @param scenes  one per scene file; the shot's overrides are referred to, not copied
    /// @pre check_morph_weights has passed for each
    MorphRig(const Scene& scene, const std::vector<BoundScene>& scenes);

    bool moves(int node) const { return animated_.count(node) > 0; }
    std::vector<double> weights(int node, double time_s, double clip_offset_s = 0) const;  ///< [morph target]
    /// Whether clips jump somewhere, so that copies which play them at other times jump at other times.
    bool clips_jump() const;
    /// Times inside (begin, end) where a weight jumps.
    std::vector<double> discontinuities(double begin_s, double end_s, double clip_offset_s = 0) const;
    /// Keys inside (begin, end) of a node's weights.
    std::vector<double> key_times_of(int node, double begin_s, double end_s, double clip_offset_s = 0) const;

private:
    struct Weights {
        std::vector<LayeredTrack<double>> by_clip;               ///< [morph target]
        const std::vector<Track<double>>* by_shot = nullptr;     ///< [morph target]; wins
    };
    void bind(const NodeChannels& channels, int layer);
    bool stands_as_in_file(int node, const Weights& weights) const;

    const Scene* scene_;
    std::vector<PlayingLayer> layers_;  ///< of all files
    std::map<int, Weights> animated_;   ///< by node
};

/// Checks the morph weights that an entry's overrides give: the node's mesh has targets, and as many as there are numbers.
/// @throws InputError  with all that are wrong
void check_morph_weights(const Scene& scene, int file, const BoundScene& bound);

}  // namespace kadr
