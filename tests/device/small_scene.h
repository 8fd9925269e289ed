#pragma once

// Scenes made in memory: a few meshes, instances, lights and a camera, without a glTF or a shot file.

#include <cmath>
#include <memory>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "device/device.h"

namespace kadr::test {

inline constexpr double kPi = 3.14159265358979323846;

/// A latitude-longitude sphere of radius 1 with exact normals.
inline GeometryData unit_sphere(int rings = 64) {
    GeometryData g;
    g.name = "sphere";
    const int columns = 2 * rings;
    for (int r = 0; r <= rings; ++r)
        for (int c = 0; c <= columns; ++c) {
            const double theta = kPi * r / rings, phi = 2 * kPi * c / columns;
            const kernels::Vec3f p{static_cast<float>(std::sin(theta) * std::cos(phi)),
                                   static_cast<float>(std::cos(theta)),
                                   static_cast<float>(std::sin(theta) * std::sin(phi))};
            g.positions.push_back(p);
            g.normals.push_back(p);
        }
    for (int r = 0; r < rings; ++r)
        for (int c = 0; c < columns; ++c) {
            const unsigned a = static_cast<unsigned>(r * (columns + 1) + c), b = a + static_cast<unsigned>(columns) + 1;
            for (unsigned i : {a, a + 1, b, a + 1, b + 1, b}) g.indices.push_back(i);
        }
    return g;
}

/// The square [-1, 1]^2 in z = 0, facing +z.
inline GeometryData unit_square() {
    GeometryData g;
    g.name = "square";
    g.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    g.indices = {0, 1, 2, 0, 2, 3};
    g.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    return g;
}

inline kernels::Material material(kernels::Vec3f color, float metallic, float roughness) {
    kernels::Material m;
    m.base_color = color;
    m.metallic = metallic;
    m.roughness = roughness;
    return m;
}

/// A scene and the snapshot of its one frame.
struct SmallScene {
    Scene scene;
    SceneSnapshot snapshot;

    SmallScene() {
        snapshot.settings.width = snapshot.settings.height = 32;
        snapshot.settings.filter = kernels::FilterKind::box;
        snapshot.settings.filter_radius = 0.5f;
        camera({0, 0, 5}, {0, 0, 0}, 0.3);
    }

    /// @param half_size  half of the image's height and width at unit distance
    void camera(glm::dvec3 position, glm::dvec3 target, double half_size) {
        const glm::dvec3 back = glm::normalize(position - target);
        const glm::dvec3 up = std::abs(back.y) > 0.99 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
        const glm::dvec3 right = glm::normalize(glm::cross(up, back));
        const glm::dquat q = glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back));
        const glm::dvec3 p = position - snapshot.render_origin;
        kernels::CameraKey key{};
        key.position = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
        key.rotation[0] = static_cast<float>(q.x);
        key.rotation[1] = static_cast<float>(q.y);
        key.rotation[2] = static_cast<float>(q.z);
        key.rotation[3] = static_cast<float>(q.w);
        key.tan_half_width = key.tan_half_height = static_cast<float>(half_size);
        key.focus_distance = 1;
        snapshot.camera_keys = {key};
        snapshot.camera = {};
        snapshot.camera.key_count = 1;
        snapshot.camera.far_clip = INFINITY;
    }

    unsigned add_mesh(GeometryData g) {
        scene.geometries.push_back(std::move(g));
        return static_cast<unsigned>(scene.geometries.size() - 1);
    }

    /// A still instance. `fixed`: may be flattened; otherwise it stays an instance.
    void add_instance(unsigned geometry, const kernels::Material& m, const glm::dmat4& world_from_geometry,
                      bool fixed = true) {
        add_moving(geometry, m, {world_from_geometry}, fixed);
    }

    /// An instance with matrix frames over the shutter.
    void add_moving(unsigned geometry, const kernels::Material& m, const std::vector<glm::dmat4>& frames,
                    bool fixed = false) {
        scene.materials.push_back(m);
        SnapshotInstance instance;
        instance.geometry = geometry;
        instance.material = static_cast<unsigned>(scene.materials.size() - 1);
        instance.id = static_cast<unsigned>(snapshot.instances.size());
        if (fixed) {
            instance.fixed_place = static_cast<int>(snapshot.fixed_places.size());
            snapshot.fixed_places.push_back(frames[0]);
        }
        snapshot.instances.push_back(instance);
        MotionFrames& motion = snapshot.motion;
        motion.types.push_back(FrameType::matrix);
        motion.headers.push_back({static_cast<unsigned>(motion.matrices.size()), static_cast<unsigned>(frames.size())});
        motion.linear.push_back(0);
        for (std::size_t k = 0; k < frames.size(); ++k) {
            kernels::FrameMatrix frame{};
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 4; ++column)
                    frame.matrix[row][column] =
                        static_cast<float>(frames[k][column][row] - (column == 3 ? snapshot.render_origin[row] : 0.0));
            frame.time = frames.size() > 1 ? static_cast<float>(k) / static_cast<float>(frames.size() - 1) : 0.0f;
            motion.matrices.push_back(frame);
        }
    }

    void add_light(const kernels::Light& light) {
        snapshot.lights.push_back({static_cast<unsigned>(snapshot.light_keys.size()), 1});
        snapshot.light_keys.push_back(light);
    }

    struct Result {
        Image image;
        DeviceStatistics statistics;
        double mean(int channel = 1) const {
            double sum = 0;
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x) sum += image.at(x, y, channel);
            return sum / (image.width * image.height);
        }
    };

    Result render(int samples, int threads = 2, int width = 0, FilmLayers layers = {},
                  KernelChoice kernels = KernelChoice::needed) {
        DeviceRequest request;
        request.name = "cpu";
        request.threads = threads;
        request.width = width;
        request.kernels = kernels;
        const DeviceChoice choice = make_device(request);
        snapshot.geometry_key = 1;
        choice.device->load(scene, environment.width > 0 ? &environment : nullptr);
        choice.device->set_frame(snapshot);
        Film film(snapshot.settings.width, snapshot.settings.height, layers);
        Pass pass;
        pass.sample_count = pass.total_samples = samples;
        choice.device->render(pass, film);
        return {film.develop(), choice.device->statistics()};
    }

    Image environment;
};

inline glm::dmat4 place(glm::dvec3 position, double scale = 1) {
    return glm::scale(glm::translate(glm::dmat4(1), position), glm::dvec3(scale));
}

}  // namespace kadr::test
