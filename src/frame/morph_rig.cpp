#include "frame/morph_rig.h"

#include <algorithm>

namespace kadr {

MorphRig::MorphRig(const Scene& scene, const std::vector<BoundScene>& scenes) : scene_(&scene) {
    for (const BoundScene& bound : scenes) layers_.insert(layers_.end(), bound.layers.begin(), bound.layers.end());
    for (std::size_t layer = 0; layer < layers_.size(); ++layer)
        for (const int clip : layers_[layer].clips)
            for (const NodeChannels& channels : scene.clips[static_cast<std::size_t>(clip)].channels) bind(channels, static_cast<int>(layer));
    for (auto& [node, weights] : animated_)
        for (LayeredTrack<double>& weight : weights) simplify(weight, layers_);
    const auto still = [](const LayeredTrack<double>& weight) { return weight.parts.empty(); };
    // A pose that a clip holds from the beginning to the end is no animation, but it is not the file's own either.
    std::erase_if(animated_, [&](const auto& entry) {
        const std::vector<double>& own = scene_->nodes[static_cast<std::size_t>(entry.first)].weights;
        bool same = std::all_of(entry.second.begin(), entry.second.end(), still);
        for (std::size_t i = 0; same && i < entry.second.size(); ++i) same = entry.second[i].rest == own[i];
        return same;
    });
}

void MorphRig::bind(const NodeChannels& channels, int layer) {
    if (channels.weights.empty()) return;
    const std::vector<double>& own = scene_->nodes[static_cast<std::size_t>(channels.node)].weights;
    Weights& weights = animated_[channels.node];
    weights.resize(std::max(own.size(), channels.weights.size()));
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i].rest = i < own.size() ? own[i] : 0;
        if (i < channels.weights.size()) add_part(weights[i], layer, channels.weights[i]);
    }
}

std::vector<double> MorphRig::weights(int node, double time_s, double clip_offset_s) const {
    const auto found = animated_.find(node);
    if (found == animated_.end()) return scene_->nodes[static_cast<std::size_t>(node)].weights;
    std::vector<double> weights;
    for (const LayeredTrack<double>& track : found->second) weights.push_back(evaluate(track, layers_, time_s, clip_offset_s));
    return weights;
}

std::vector<double> MorphRig::discontinuities(double begin_s, double end_s, double clip_offset_s) const {
    std::vector<double> times;
    if (animated_.empty()) return times;
    const std::vector<LayerWindow> windows = windows_of(layers_, begin_s, end_s, clip_offset_s);
    for (const auto& [node, weights] : animated_)
        for (const LayeredTrack<double>& weight : weights)
            for (const auto& part : weight.parts) {
                const LayerWindow& window = windows[static_cast<std::size_t>(part.layer)];
                add_steps(*part.track, window, times);
                if (!jumps_at_seam(*part.track, *window.layer)) continue;
                const std::vector<double> seams = seams_of(window);
                times.insert(times.end(), seams.begin(), seams.end());
            }
    return times;
}

std::vector<double> MorphRig::key_times_of(int node, double begin_s, double end_s, double clip_offset_s) const {
    const auto found = animated_.find(node);
    if (found == animated_.end()) return {};
    std::vector<double> times;
    const std::vector<LayerWindow> windows = windows_of(layers_, begin_s, end_s, clip_offset_s);
    for (const LayeredTrack<double>& weight : found->second) add_key_times(weight, windows, times);
    return times;
}

}  // namespace kadr
