#include "render/loaded_shot.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kadr {
namespace {

LoadOptions with_limits(LoadOptions options, const RenderSpec& render) {
    options.texture_limit_px = render.texture_limit_px;
    return options;
}

}  // namespace

LoadedShot::LoadedShot(Shot shot, const LoadOptions& options)
    : shot_(std::move(shot)), scene_(load_scene(scene_requests(shot_), with_limits(options, shot_.render))), bound_(shot_, scene_) {}

std::vector<Diagnostic> LoadedShot::warnings() const {
    std::vector<Diagnostic> all = shot_.warnings;
    all.insert(all.end(), scene_.warnings.begin(), scene_.warnings.end());
    all.insert(all.end(), bound_.warnings().begin(), bound_.warnings().end());
    return all;
}

std::vector<SceneFileRequest> scene_requests(const Shot& shot) {
    std::vector<SceneFileRequest> requests;
    for (const SceneSpec& scene : shot.scenes) requests.push_back({scene.id, scene.gltf, scene.where});
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
