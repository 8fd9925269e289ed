#include "extremes/trial.h"

#include <cmath>

#include "device/device.h"
#include "output/view.h"
#include "render/environment_image.h"
#include "render/frame_renderer.h"

namespace kadr::test {

namespace {

constexpr int kWidth = 4, kHeight = 3;

std::string flaws_of(const Image& image, const char* what) {
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        if (!std::isfinite(image.pixels[i])) return std::string(what) + " has a value of " + std::to_string(image.pixels[i]);
    return {};
}

}  // namespace

std::string flaws_of(Shot shot, const Scene& scene) {
    shot.image.width = kWidth;
    shot.image.height = kHeight;
    shot.render.fix_samples(1);
    const BoundShot bound(shot, scene);
    const FrameTime time = bound.sequence().frame(bound.timing().frames.front());
    DeviceRequest request;
    request.name = "cpu";
    request.threads = 1;
    const DeviceChoice choice = make_device(request);
    const std::optional<Image> environment = read_environment(shot.environment);
    choice.device->load(scene, environment ? &*environment : nullptr, {shot.render.build, shot.render.robust.value_or(false) ? BuildSettings::Robust::required : BuildSettings::Robust::no});
    const Image image = FrameRenderer(*choice.device).render(bound, time, {}).image;
    ViewSpec view = view_at(shot.view, time.time_s());
    if (view.automatic) view.exposure_stops = metered_exposure(image);
    const std::string flaws = flaws_of(image, "the picture");
    return flaws.empty() ? flaws_of(apply_view(image, view, false), "the view of the picture") : flaws;
}

}  // namespace kadr::test
