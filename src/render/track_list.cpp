#include "render/track_list.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

namespace kadr {
namespace {

const char* name_of(Interpolation interpolation) {
    constexpr const char* kNames[] = {"step", "linear", "smooth", "cubic"};
    return kNames[static_cast<int>(interpolation)];
}

template <class T>
std::string kind_of(const Track<T>& track) {
    const bool eased = std::any_of(track.keys.begin(), track.keys.end(), [](const Key<T>& key) { return key.ease; });
    return std::string(name_of(track.interpolation)) + (eased ? ", eased" : "");
}

std::string outside_of(Extrapolation before, Extrapolation after) {
    constexpr const char* kNames[] = {"hold", "repeat", "pingpong", "continue"};
    std::string text;
    if (before != Extrapolation::hold) text += std::string("before: ") + kNames[static_cast<int>(before)];
    if (after != Extrapolation::hold) text += std::string(text.empty() ? "" : ", ") + "after: " + kNames[static_cast<int>(after)];
    return text;
}

/// Takes the tracks of a shot one by one; each kind of value knows its own parts.
class TrackList {
public:
    template <class T>
    void add(const std::string& name, const Track<T>& track) {
        if (track.is_constant()) return;
        TrackInfo info{name, kind_of(track), outside_of(track.before, track.after), {}, {}, {}};
        for (const Key<T>& key : track.keys) info.keys_s.push_back(key.time_s);
        info.changes = [&track](double begin_s, double end_s) {
            return evaluate(track, begin_s) != evaluate(track, end_s);
        };
        info.jumps = [&track](double begin_s, double end_s) { return discontinuities(track, begin_s, end_s); };
        tracks_.push_back(std::move(info));
    }
    void add(const std::string& name, const RotationTrack& track) {
        if (track.axis_angle) return add(name + ".angle", track.axis_angle->angle_rad);
        add(name, track.orientation);
    }
    void add(const std::string& name, const PositionTrack& track) {
        if (track.path) return add(name + ".at", track.path->at);
        if (!track.orbit) return add(name, track.keyed);
        add(name + ".orbit.around", track.orbit->around);
        add(name + ".orbit.radius", track.orbit->radius_m);
        add(name + ".orbit.height", track.orbit->height_m);
        add(name + ".orbit.turns", track.orbit->turns);
    }
    void add(const std::string& name, const Shake& shake) {
        add(name + ".amplitude", shake.amplitude_m);
        add(name + ".angle", shake.angle_rad);
    }
    void add(const std::string& name, const TransformTrack& track) {
        add(name + ".translate", track.translate);
        add(name + ".rotate", track.rotate);
        add(name + ".scale", track.scale);
    }
    void add(const std::string&, const NodeReference&) {}
    template <class... Alternatives>
    void add(const std::string& name, const std::variant<Alternatives...>& value) {
        std::visit([&](const auto& alternative) { add(name, alternative); }, value);
    }
    template <class T>
    void add(const std::string& name, const std::optional<T>& value) {
        if (value) add(name, *value);
    }
    std::vector<TrackInfo> take() { return std::move(tracks_); }

private:
    std::vector<TrackInfo> tracks_;
};

void add_material(TrackList& list, const std::string& scene, const MaterialSpec& material) {
    const std::string name = scene + ".materials." + material.name;
    list.add(name + ".base_color", material.base_color);
    list.add(name + ".alpha", material.alpha);
    list.add(name + ".alpha_cutoff", material.alpha_cutoff);
    list.add(name + ".metallic", material.metallic);
    list.add(name + ".roughness", material.roughness);
    list.add(name + ".ior", material.ior);
    list.add(name + ".emissive", material.emissive);
    list.add(name + ".emissive_strength", material.emissive_strength);
    list.add(name + ".normal_scale", material.normal_scale);
}

void add_scene(TrackList& list, const SceneSpec& scene) {
    const std::string name = "scenes." + scene.id;
    list.add(name + ".transform", scene.transform);
    for (std::size_t i = 0; i < scene.layers.size(); ++i)
        list.add(name + ".animation." + (scene.layers.size() > 1 ? std::to_string(i) + "." : "") + "weight", scene.layers[i].weight);
    for (const NodeOverride& node : scene.nodes) {
        const std::string part = name + ".nodes." + node.name;
        list.add(part, node.transform);
        list.add(part + ".visible", node.visible);
        for (std::size_t i = 0; i < node.weights.size(); ++i) list.add(part + ".weights[" + std::to_string(i) + "]", node.weights[i]);
    }
    list.add(name + ".visible", scene.visible);
    for (const MaterialSpec& material : scene.materials) add_material(list, name, material);
}

void add_camera(TrackList& list, const CameraSpec& camera) {
    if (!camera.gltf) {
        list.add("camera.position", camera.position);
        list.add("camera.look_at", camera.look_at);
        list.add("camera.up", camera.up);
        list.add("camera.focal_length", camera.focal_length_mm);
        list.add("camera.vertical_fov", camera.vertical_fov_rad);
    }
    list.add("camera.dolly", camera.dolly_m);
    list.add("camera.shake", camera.shake);
    list.add("camera.f_stop", camera.f_stop);
    list.add("camera.focus", camera.focus);
}

const char* strength_key(LightKind kind) {
    switch (kind) {
        case LightKind::directional:
            return ".illuminance";
        case LightKind::area:
            return ".luminance";
        default:
            return ".intensity";
    }
}

void add_light(TrackList& list, const LightSpec& light) {
    const std::string name = "lights." + light.id;
    list.add(name + strength_key(light.kind), light.strength);
    list.add(name + ".color", light.color);
    list.add(name + ".position", light.position);
    list.add(name + ".look_at", light.look_at);
    list.add(name + ".direction", light.direction);
    list.add(name + ".inner", light.inner_rad);
    list.add(name + ".outer", light.outer_rad);
    list.add(name + ".radius", light.radius_m);
    list.add(name + ".size", light.size_m);
}

}  // namespace

std::vector<TrackInfo> tracks_of(const Shot& shot) {
    TrackList list;
    for (const SceneSpec& scene : shot.scenes) add_scene(list, scene);
    add_camera(list, shot.camera);
    for (const LightSpec& light : shot.lights) add_light(list, light);
    list.add("environment.color", shot.environment.color);
    list.add("environment.strength", shot.environment.strength);
    list.add("environment.rotate", shot.environment.rotate_rad);
    return list.take();
}

}  // namespace kadr
