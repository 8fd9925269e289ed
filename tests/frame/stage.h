#pragma once

// Shots and scenes made in memory: no YAML, no glTF.

#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "frame/camera_keys.h"
#include "frame/frame_state.h"
#include "frame/motion_frames.h"
#include "frame/snapshot.h"

namespace kadr::test {

inline constexpr double kPi = std::numbers::pi;

template <class T>
Key<T> key(double time_s, T value) {
    return {time_s, value, {}, {}, {}};
}

template <class T>
Track<T> track(std::vector<std::pair<double, T>> keys, Interpolation interpolation = Interpolation::linear) {
    Track<T> result;
    for (const auto& [time, value] : keys) result.keys.push_back(key(time, value));
    result.interpolation = interpolation;
    return result;
}

inline glm::dquat turn(double degrees, glm::dvec3 axis = {0, 0, 1}) { return glm::angleAxis(glm::radians(degrees), glm::normalize(axis)); }

/// One scene file "stage" and a shot around it: a camera at (0, 0, 5) that looks at the origin, 1 s shutter at 1 fps.
struct Stage {
    Shot shot;
    Scene scene;

    Stage() {
        shot.file = "stage.yaml";
        shot.name = "stage";
        shot.timing.fps = {1, 1};
        shot.frames_given = true;
        shot.shutter = {0, 1};
        shot.scenes.resize(1);
        shot.scenes[0].id = "stage";
        shot.scenes[0].gltf = "stage.glb";
        shot.scenes[0].where = {"stage.yaml", 3, 5};
        shot.scenes[0].layers[0].where = {"stage.yaml", 4, 7};
        shot.camera.where = {"stage.yaml", 9, 1};
        shot.environment.where = {"stage.yaml", 12, 1};
        SceneFile file;
        file.id = "stage";
        scene.files.push_back(file);
        scene.materials.resize(1);
        GeometryData geometry;
        geometry.name = "cube/0";
        scene.geometries.push_back(geometry);
    }

    int add_node(std::string name, int parent = -1, bool mesh = true) {
        Node node;
        node.name = std::move(name);
        node.parent = parent;
        if (mesh) node.primitives.push_back({0, 0});
        const int index = static_cast<int>(scene.nodes.size());
        scene.nodes.push_back(node);
        if (parent >= 0)
            scene.nodes[static_cast<std::size_t>(parent)].children.push_back(index);
        else
            scene.files[0].roots.push_back(index);
        ++scene.files[0].node_count;
        return index;
    }
    Node& node(int index) { return scene.nodes[static_cast<std::size_t>(index)]; }

    NodeChannels& animate(int node_index) {
        if (scene.clips.empty()) {
            scene.clips.push_back({"Clip", 0, 1000, {}, 1});
            scene.files[0].clip_count = 1;
        }
        scene.clips[0].channels.push_back({});
        scene.clips[0].channels.back().node = node_index;
        return scene.clips[0].channels.back();
    }

    /// Lets a clip, counted from 0, drive a property beside nodes' transforms. Clips that are missing are made.
    template <class T>
    void drive(int clip, Property property, int object, Track<T> values) {
        while (static_cast<int>(scene.clips.size()) <= clip) scene.clips.push_back({"clip " + std::to_string(scene.clips.size()), 0, 1000, {}, 1});
        scene.files[0].clip_count = static_cast<int>(scene.clips.size());
        PropertyChannel channel;
        channel.property = property;
        channel.index = object;
        channel.track = std::move(values);
        scene.clips[static_cast<std::size_t>(clip)].properties.push_back(channel);
    }
    /// A layer of one clip for each weight.
    void play(const std::vector<Track<double>>& weights) {
        shot.scenes[0].layers.clear();
        for (std::size_t i = 0; i < weights.size(); ++i) {
            ClipLayer layer;
            layer.clips = ClipLayer::Clips::one;
            layer.clip_index = static_cast<int>(i);
            layer.weight = weights[i];
            layer.where = {"stage.yaml", 4, 7};
            shot.scenes[0].layers.push_back(layer);
        }
    }
    ClipLayer& layer(std::size_t i) { return shot.scenes[0].layers[i]; }

    BoundShot bind() const { return BoundShot(shot, scene); }
    std::vector<SceneSnapshot> snapshots(int frame = 0) const {
        const BoundShot bound = bind();
        return make_snapshots(bound, bound.sequence().frame(frame));
    }
    SceneSnapshot snapshot(int frame = 0) const { return snapshots(frame).front(); }
};

/// What an InputError says, whole.
template <class Action>
std::string message_of(Action action) {
    try {
        action();
    } catch (const InputError& error) {
        std::string all;
        for (const Diagnostic& diagnostic : error.diagnostics()) all += (all.empty() ? "" : "\n") + diagnostic.text();
        return all;
    }
    return "no error";
}

/// Largest screen-space distance between the frames and the true path of an instance, over many times.
/// @param world_from_node  (time in s) -> the true place
template <class Path>
double worst_error_px(const Stage& stage, const SceneSnapshot& snapshot, std::size_t instance, Path world_from_node, int times) {
    const BoundShot bound = stage.bind();
    const GeometryData& geometry = stage.scene.geometries[snapshot.instances[instance].geometry];
    double worst = 0;
    for (int i = 0; i <= times; ++i) {
        const double u = static_cast<double>(i) / times, time = std::lerp(snapshot.open_s, snapshot.close_s, u);
        glm::dmat4 wanted = world_from_node(time) * glm::translate(glm::dmat4(1), geometry.centre) *
                            glm::scale(glm::dmat4(1), glm::dvec3(geometry.scale));
        wanted[3] -= glm::dvec4(snapshot.render_origin, 0);
        const glm::dmat4 is = interpolate(snapshot.motion, instance, u);
        CameraState camera = camera_at(bound, time);
        camera.position -= snapshot.render_origin;
        // Projected point by point, without the sequencer's own bound.
        const auto project = [&](const glm::dvec3& point) {
            const glm::dvec3 seen = glm::conjugate(camera.rotation) * (point - camera.position);
            return glm::dvec2(seen) / -seen.z * (0.5 * stage.shot.image.height / camera.tan_half_height);
        };
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec4 at(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1, 1);
            worst = std::max(worst, glm::distance(project(glm::dvec3(wanted * at)), project(glm::dvec3(is * at))));
        }
    }
    return worst;
}
inline double worst_error_px(const Stage& stage, const SceneSnapshot& snapshot, std::size_t instance, int node, int times = 500) {
    const BoundShot bound = stage.bind();
    return worst_error_px(stage, snapshot, instance, [&](double time) { return bound.node_transforms(time)[static_cast<std::size_t>(node)]; }, times);
}

}  // namespace kadr::test
