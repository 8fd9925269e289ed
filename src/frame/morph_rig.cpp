#include "frame/morph_rig.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "frame/problem.h"
#include "frame/references.h"

namespace kadr {

namespace {

void append(std::vector<double>& all, const std::vector<double>& more) { all.insert(all.end(), more.begin(), more.end()); }

std::string numbers(std::size_t count) { return count == 1 ? "1 number" : fmt::format("{} numbers", count); }

}  // namespace

void check_morph_weights(const Scene& scene, int file, const BoundScene& bound) {
    std::vector<Diagnostic> problems;
    for (const BoundScene::Override& node : bound.overrides) {
        const std::size_t given = node.spec->weights.size(), targets = scene.nodes[static_cast<std::size_t>(node.node)].weights.size();
        if (given == 0 || given == targets) continue;
        const std::string path = node_path(scene, file, node.node);
        if (targets == 0)
            problems.push_back(problem_at(node.spec->weights_where, fmt::format("weights are given for node '{}', which has no morph targets", path),
                                          "expected a node whose mesh has some; remove the key"));
        else
            problems.push_back(problem_at(node.spec->weights_where, fmt::format("the weights of node '{}' are {}", path, numbers(given)),
                                          fmt::format("expected {}, one for each morph target of its mesh", targets)));
    }
    if (!problems.empty()) throw InputError(std::move(problems));
}

MorphRig::MorphRig(const Scene& scene, const std::vector<BoundScene>& scenes) : scene_(&scene) {
    for (const BoundScene& bound : scenes) layers_.insert(layers_.end(), bound.layers.begin(), bound.layers.end());
    for (std::size_t layer = 0; layer < layers_.size(); ++layer)
        for (const int clip : layers_[layer].clips)
            for (const NodeChannels& channels : scene.clips[static_cast<std::size_t>(clip)].channels) bind(channels, static_cast<int>(layer));
    for (auto& [node, weights] : animated_)
        for (LayeredTrack<double>& weight : weights.by_clip) simplify(weight, layers_);
    std::erase_if(animated_, [&](const auto& entry) { return stands_as_in_file(entry.first, entry.second); });
    for (const BoundScene& bound : scenes)
        for (const BoundScene::Override& node : bound.overrides)
            if (!node.spec->weights.empty()) animated_[node.node] = {{}, &node.spec->weights};
}

// A pose that a clip holds from the beginning to the end is no animation, but it is not the file's own either.
bool MorphRig::stands_as_in_file(int node, const Weights& weights) const {
    const std::vector<double>& own = scene_->nodes[static_cast<std::size_t>(node)].weights;
    bool same = std::all_of(weights.by_clip.begin(), weights.by_clip.end(), [](const LayeredTrack<double>& weight) { return weight.parts.empty(); });
    for (std::size_t i = 0; same && i < weights.by_clip.size(); ++i) same = weights.by_clip[i].rest == own[i];
    return same;
}

void MorphRig::bind(const NodeChannels& channels, int layer) {
    if (channels.weights.empty()) return;
    const std::vector<double>& own = scene_->nodes[static_cast<std::size_t>(channels.node)].weights;
    std::vector<LayeredTrack<double>>& weights = animated_[channels.node].by_clip;
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
    if (found->second.by_shot)
        for (const Track<double>& track : *found->second.by_shot) weights.push_back(evaluate(track, time_s));
    for (const LayeredTrack<double>& track : found->second.by_clip) weights.push_back(evaluate(track, layers_, time_s, clip_offset_s));
    return weights;
}

bool MorphRig::clips_jump() const {
    const auto jumps = [this](const auto& part) {
        return part.track->interpolation == Interpolation::step || jumps_at_seam(*part.track, layers_[static_cast<std::size_t>(part.layer)]);
    };
    for (const auto& [node, weights] : animated_)
        for (const LayeredTrack<double>& weight : weights.by_clip)
            if (std::any_of(weight.parts.begin(), weight.parts.end(), jumps)) return true;
    return false;
}

std::vector<double> MorphRig::discontinuities(double begin_s, double end_s, double clip_offset_s) const {
    std::vector<double> times;
    if (animated_.empty()) return times;
    const std::vector<LayerWindow> windows = windows_of(layers_, begin_s, end_s, clip_offset_s);
    for (const auto& [node, weights] : animated_) {
        if (weights.by_shot)
            for (const Track<double>& track : *weights.by_shot) append(times, kadr::discontinuities(track, begin_s, end_s));
        for (const LayeredTrack<double>& weight : weights.by_clip)
            for (const auto& part : weight.parts) {
                const LayerWindow& window = windows[static_cast<std::size_t>(part.layer)];
                add_steps(*part.track, window, times);
                if (jumps_at_seam(*part.track, *window.layer)) append(times, seams_of(window));
            }
    }
    return times;
}

std::vector<double> MorphRig::key_times_of(int node, double begin_s, double end_s, double clip_offset_s) const {
    const auto found = animated_.find(node);
    if (found == animated_.end()) return {};
    std::vector<double> times;
    const std::vector<LayerWindow> windows = windows_of(layers_, begin_s, end_s, clip_offset_s);
    if (found->second.by_shot)
        for (const Track<double>& track : *found->second.by_shot) append(times, key_times(track, begin_s, end_s));
    for (const LayeredTrack<double>& weight : found->second.by_clip) add_key_times(weight, windows, times);
    return times;
}

}  // namespace kadr
