#pragma once

// Devices that are wrong on purpose: what is to find errors has to find these.

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "device/device.h"

namespace kadr::test {

/// Renders another scene or another frame than it was given.
class BrokenDevice final : public Device {
public:
    explicit BrokenDevice(std::unique_ptr<Device> device) : device_(std::move(device)) {}

    std::function<void(Scene&)> break_scene = [](Scene&) {};
    std::function<void(SceneSnapshot&)> break_frame = [](SceneSnapshot&) {};

    std::string name() const override { return "broken " + device_->name(); }
    void load(const Scene& scene, const Image* environment, const BuildSettings& build) override {
        auto broken = std::make_unique<Scene>(scene);
        break_scene(*broken);
        device_->load(*broken, environment, build);
        scene_ = std::move(broken);
    }
    void set_frame(const SceneSnapshot& snapshot) override {
        SceneSnapshot broken = snapshot;
        break_frame(broken);
        device_->set_frame(broken);
    }
    void begin_film(Film& film) override { device_->begin_film(film); }
    void render(const Pass& pass, Film& film) override { device_->render(pass, film); }
    void read_film(Film& film) override { device_->read_film(film); }
    DeviceStatistics statistics() const override { return device_->statistics(); }
    Probe* probe() override { return device_->probe(); }

private:
    std::unique_ptr<Scene> scene_;  ///< outlives the device
    std::unique_ptr<Device> device_;
};

/// A copy of a list that shares nothing, to change any entry of.
template <class T>
SharedList<T> own_copy(const SharedList<T>& list) {
    return {nullptr, std::vector<T>(list.begin(), list.end())};
}

/// Moves an instance by so much along x, in the units of the render space.
inline void move_instance(SceneSnapshot& snapshot, std::size_t instance, float by) {
    snapshot.instances = own_copy(snapshot.instances);
    snapshot.motion.headers = own_copy(snapshot.motion.headers);
    snapshot.motion.types = own_copy(snapshot.motion.types);
    snapshot.motion.linear = own_copy(snapshot.motion.linear);
    snapshot.motion.srt = own_copy(snapshot.motion.srt);
    snapshot.motion.matrices = own_copy(snapshot.motion.matrices);
    snapshot.instances.edit(instance).fixed_place = -1;
    const kernels::TransformHeader header = snapshot.motion.headers[instance];
    for (unsigned k = header.first_frame; k < header.first_frame + header.frame_count; ++k)
        if (snapshot.motion.types[instance] == FrameType::srt)
            snapshot.motion.srt.edit(k).translation[0] += by;
        else
            snapshot.motion.matrices.edit(k).matrix[0][3] += by;
    ++snapshot.geometry_key;
    ++snapshot.still_key;
}

inline void scale_lights(SceneSnapshot& snapshot, float by) {
    for (kernels::Light& light : snapshot.light_keys) light.radiance = light.radiance * by;
    snapshot.environment.radiance = snapshot.environment.radiance * by;
}

/// Makes a triangle of a mesh empty.
inline void drop_triangle(Scene& scene, std::size_t geometry, std::size_t triangle) {
    auto& indices = scene.geometries[geometry].indices;
    indices[3 * triangle + 1] = indices[3 * triangle + 2] = indices[3 * triangle];
}

}  // namespace kadr::test
