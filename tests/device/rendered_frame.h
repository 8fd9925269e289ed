#pragma once

// Frames of a shot in memory as the program renders them: snapshots of the sequencer, samples dealt to the parts of the
// shutter, one device.

#include "device/device.h"
#include "frame/stage.h"

namespace kadr::test {

/// A stage whose nodes show the square [-1, 1]^2, lit by nothing, glowing with radiance 1: what a pixel receives is how
/// long and how much the square covers it.
struct GlowingStage : Stage {
    GlowingStage() {
        GeometryData& square = scene.geometries[0];
        square.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
        square.indices = {0, 1, 2, 0, 2, 3};
        scene.materials[0].emission = {1, 1, 1};
        scene.materials[0].base_color = {0, 0, 0};
        shot.render.bounces = {0, 0, 0, 0};
        shot.render.filter = FilterKind::box;
        shot.render.filter_width_px = 1;
        shot.environment.given = true;
        shot.environment.visible = false;
        shot.timing.fps = {24, 1};
        shot.shutter = {0, 1};
        size(64, 64, 2);
    }
    /// @param half_width_m  what the image shows to the left and to the right of the origin, in the plane z = 0
    void size(int width, int height, double half_width_m) {
        shot.image.width = width;
        shot.image.height = height;
        shot.camera.sensor_mm = {20, 20};
        shot.camera.fit = CameraSpec::Fit::horizontal;
        shot.camera.focal_length_mm = Track<double>(5 * 10 / half_width_m);  // the camera stands 5 m away
    }
    double pixels_a_metre() const { return 0.5 * shot.image.width / (5 * 10 / shot.camera.focal_length_mm->keys[0].value); }
};

/// @param share  samples for every part of the shutter: as many as its share of the light, at least one
inline Image render_frame(const Stage& stage, int samples, int frame = 0, FilmLayers layers = {}) {
    DeviceRequest request;
    request.name = "cpu";
    request.threads = 2;
    const DeviceChoice choice = make_device(request);
    choice.device->load(stage.scene, nullptr);
    Film film(stage.shot.image.width, stage.shot.image.height, layers);
    film.clear(true);
    const std::vector<SceneSnapshot> parts = stage.snapshots(frame);
    std::vector<int> counts;
    int total = 0;
    for (const SceneSnapshot& part : parts) {
        counts.push_back(part.weight > 0 ? std::max(1, static_cast<int>(std::lround(part.weight * samples))) : 0);
        total += counts.back();
    }
    Pass pass;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (counts[i] == 0) continue;
        choice.device->set_frame(parts[i]);
        pass.sample_count = counts[i];
        pass.total_samples = total;
        pass.dealt_share = static_cast<double>(counts[i]) / total;
        choice.device->render(pass, film);
        pass.first_sample += counts[i];
    }
    return film.develop();
}

}  // namespace kadr::test
