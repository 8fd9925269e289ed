#pragma once

#include <map>
#include <vector>

#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

/// The weights of the morph targets of every node over time: the clips that play, else what the file says.
class MorphRig {
public:
    /// @param clips  indices into Scene::clips that play, one list per scene file
    MorphRig(const Shot& shot, const Scene& scene, const std::vector<std::vector<int>>& clips);

    bool moves(int node) const { return animated_.count(node) > 0; }
    std::vector<double> weights(int node, double time_s, double clip_offset_s = 0) const;  ///< [morph target]
    /// Times inside (begin, end) where a weight jumps.
    std::vector<double> discontinuities(double begin_s, double end_s, double clip_offset_s = 0) const;
    /// Keys inside (begin, end) of a node's weights.
    std::vector<double> key_times_of(int node, double begin_s, double end_s, double clip_offset_s = 0) const;

private:
    struct Animated {
        const std::vector<Track<double>>* tracks = nullptr;
        double start_s = 0, speed = 1;
        double clip_time(double time_s, double offset_s) const { return start_s + speed * (time_s + offset_s); }
        double shot_time(double clip_s, double offset_s) const { return (clip_s - start_s) / speed - offset_s; }
    };
    template <class Ask>
    std::vector<double> ask(const Animated& node, double begin_s, double end_s, double offset_s, Ask ask) const;

    const Scene* scene_;
    std::map<int, Animated> animated_;
};

}  // namespace kadr
