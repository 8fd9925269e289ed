#include "render/frame_cost.h"

#include <algorithm>

#include "render/environment_image.h"
#include "render/frame_renderer.h"

namespace kadr {
namespace {

constexpr int kWidth = 160, kSamples = 4;

Shot small_shot(Shot shot) {
    shot.image = limited_width(shot.image, kWidth);
    shot.render.fix_samples(std::min(shot.render.samples, kSamples));
    shot.render.denoise = DenoiserKind::none;
    return shot;
}

}  // namespace

FrameCost measure_frame_cost(const LoadedShot& shot, Device& device, int frame) {
    const Shot small = small_shot(shot.shot());
    const BoundShot bound(small, shot.scene());
    load_device(device, shot);
    FrameRenderer renderer(device);
    const FrameTime time = bound.sequence().frame(frame);
    const DeviceStatistics first = renderer.render(bound, time, {}).statistics;  // cold caches
    const DeviceStatistics second = renderer.render(bound, time, {}).statistics;
    FrameCost cost{frame, small.image.width, small.image.height, small.render.samples};
    cost.load_s = first.load_s + first.set_frame_s;
    const auto pixel_samples = static_cast<double>(second.pixel_samples);
    cost.pixel_samples_per_s = pixel_samples / std::max(second.render_s, 1e-9);
    cost.rays_per_sample = static_cast<double>(second.rays) / std::max(pixel_samples, 1.0);
    const ImageSpec& image = shot.shot().image;
    cost.trace_s = static_cast<double>(image.width) * image.height * shot.shot().render.samples / cost.pixel_samples_per_s;
    return cost;
}

}  // namespace kadr
