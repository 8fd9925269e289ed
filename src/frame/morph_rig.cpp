#include "frame/morph_rig.h"

#include <algorithm>

namespace kadr {

MorphRig::MorphRig(const Shot& shot, const Scene& scene, const std::vector<std::vector<int>>& clips) : scene_(&scene) {
    for (std::size_t file = 0; file < clips.size(); ++file)
        for (const int clip : clips[file])
            for (const NodeChannels& channels : scene.clips[static_cast<std::size_t>(clip)].channels)
                if (!channels.weights.empty()) animated_[channels.node] = {&channels.weights, shot.scenes[file].clip_start_s, shot.scenes[file].clip_speed};
}

std::vector<double> MorphRig::weights(int node, double time_s, double clip_offset_s) const {
    const auto found = animated_.find(node);
    if (found == animated_.end()) return scene_->nodes[static_cast<std::size_t>(node)].weights;
    std::vector<double> weights;
    for (const Track<double>& track : *found->second.tracks) weights.push_back(evaluate(track, found->second.clip_time(time_s, clip_offset_s)));
    return weights;
}

template <class Ask>
std::vector<double> MorphRig::ask(const Animated& node, double begin_s, double end_s, double offset_s, Ask ask) const {
    std::vector<double> times;
    if (node.speed == 0) return times;
    const double from = node.clip_time(begin_s, offset_s), to = node.clip_time(end_s, offset_s);
    for (const Track<double>& track : *node.tracks)
        for (const double time : ask(track, std::min(from, to), std::max(from, to))) times.push_back(node.shot_time(time, offset_s));
    return times;
}

std::vector<double> MorphRig::discontinuities(double begin_s, double end_s, double clip_offset_s) const {
    std::vector<double> times;
    for (const auto& [node, animated] : animated_) {
        const auto more = ask(animated, begin_s, end_s, clip_offset_s, [](const Track<double>& track, double from, double to) { return kadr::discontinuities(track, from, to); });
        times.insert(times.end(), more.begin(), more.end());
    }
    return times;
}

std::vector<double> MorphRig::key_times_of(int node, double begin_s, double end_s, double clip_offset_s) const {
    const auto found = animated_.find(node);
    if (found == animated_.end()) return {};
    return ask(found->second, begin_s, end_s, clip_offset_s, [](const Track<double>& track, double from, double to) { return key_times(track, from, to); });
}

}  // namespace kadr
