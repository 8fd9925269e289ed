#include "render/loaded_shot.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frame/precision.h"
#include "scene/scene_files.h"

namespace kadr {
namespace {

LoadOptions with_limits(LoadOptions options, const RenderSpec& render) {
    options.texture_limit_px = render.texture_limit_px;
    return options;
}

Scene load_needed(const Shot& shot, const LoadOptions& options, std::vector<Unread>& left_out) {
    SceneFiles files(scene_requests(shot));
    ShotNeeds needs = needs_of(shot, files.outline());
    left_out = std::move(needs.left_out);
    return std::move(files).load(needs.scene, options);
}

Scene load_everything(const Shot& shot, const LoadOptions& options) {
    std::vector<SceneFileRequest> requests = scene_requests(shot);
    for (SceneFileRequest& request : requests) request.clips = {};
    return load_scene(requests, options);
}

ClipChoice clips_of(const SceneSpec& scene) {
    ClipChoice choice{false, {}, {}};
    for (const ClipLayer& layer : scene.layers) {
        if (layer.clips == ClipLayer::Clips::all) choice.all = true;
        if (layer.clips != ClipLayer::Clips::one) continue;
        if (layer.clip_index >= 0) choice.numbers.push_back(layer.clip_index);
        else choice.names.push_back(layer.clip_name);
    }
    return choice;
}

}  // namespace

LoadedShot::LoadedShot(Shot shot, const LoadOptions& options, Reading reading)
    : shot_(std::move(shot)),
      scene_(reading == Reading::needed ? load_needed(shot_, with_limits(options, shot_.render), left_out_) : load_everything(shot_, with_limits(options, shot_.render))),
      bound_(shot_, scene_) {}

std::optional<Slipping> LoadedShot::slipping() const { return shot_.render.robust ? std::nullopt : find_slipping(bound_); }

BuildSettings LoadedShot::build_settings() const {
    using Robust = BuildSettings::Robust;
    if (shot_.render.robust) return {shot_.render.build, *shot_.render.robust ? Robust::required : Robust::no};
    return {shot_.render.build, slipping() ? Robust::wanted : Robust::no};
}

std::vector<Diagnostic> LoadedShot::warnings() const {
    std::vector<Diagnostic> all = shot_.warnings;
    all.insert(all.end(), scene_.warnings.begin(), scene_.warnings.end());
    all.insert(all.end(), bound_.warnings().begin(), bound_.warnings().end());
    const std::vector<Diagnostic> precision = precision_warnings(bound_);
    all.insert(all.end(), precision.begin(), precision.end());
    return all;
}

std::vector<SceneFileRequest> scene_requests(const Shot& shot) {
    std::vector<SceneFileRequest> requests;
    for (const SceneSpec& scene : shot.scenes) requests.push_back({scene.id, scene.gltf, scene.where, clips_of(scene)});
    return requests;
}

ImageSpec limited_width(ImageSpec image, int max_width) {
    const int longer = std::max(image.width, image.height);
    if (longer <= max_width) return image;
    const double scale = static_cast<double>(max_width) / longer;
    image.width = std::max(1, static_cast<int>(std::lround(image.width * scale)));
    image.height = std::max(1, static_cast<int>(std::lround(image.height * scale)));
    return image;
}

}  // namespace kadr
