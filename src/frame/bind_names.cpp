#include "frame/bind_names.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/material_rig.h"
#include "frame/morph_rig.h"
#include "frame/problem.h"

namespace kadr {

namespace {

constexpr int kMostFrames = 1'000'000;

/// Says what is wrong once, where the shot's reader took one key for two purposes: the middle of an orbit is also what
/// the camera looks at.
void drop_repeated(std::vector<Diagnostic>& problems) {
    std::vector<Diagnostic> once;
    for (Diagnostic& problem : problems) {
        const auto same = [&](const Diagnostic& known) { return known.where == problem.where && known.found == problem.found; };
        if (std::none_of(once.begin(), once.end(), same)) once.push_back(std::move(problem));
    }
    problems = std::move(once);
}

/// Every node reference of a shot but the authored camera's, which has rules of its own.
std::vector<NodeReference> references_of(const Shot& shot) {
    std::vector<NodeReference> all;
    const auto add = [&all](const auto& value) {
        if (const auto* reference = std::get_if<NodeReference>(&value)) all.push_back(*reference);
    };
    if (!shot.camera.gltf) add(shot.camera.look_at);
    if (shot.camera.around) all.push_back(*shot.camera.around);
    if (shot.camera.focus) add(*shot.camera.focus);
    for (const LightSpec& light : shot.lights)
        if (light.look_at) add(*light.look_at);
    return all;
}

/// What a light asks for that the analytic integrator does not have; empty when there is nothing.
std::string beyond_direct(const LightSpec& light) {
    if (light.kind == LightKind::area) return fmt::format("lights.{}.type is area", light.id);
    if (light.kind != LightKind::directional && varies(light.radius_m)) return fmt::format("lights.{}.radius is animated", light.id);
    if (light.kind != LightKind::directional && evaluate(light.radius_m, 0) > 0) return fmt::format("lights.{}.radius is above 0", light.id);
    if (light.kind == LightKind::directional && varies(light.angular_diameter_rad)) return fmt::format("lights.{}.angular_diameter is animated", light.id);
    if (light.kind == LightKind::directional && evaluate(light.angular_diameter_rad, 0) > 0) return fmt::format("lights.{}.angular_diameter is above 0", light.id);
    return {};
}

void check_integrator(const Shot& shot, std::vector<Diagnostic>& problems) {
    if (shot.render.integrator != Integrator::direct) return;
    for (const LightSpec& light : shot.lights)
        if (const std::string found = beyond_direct(light); !found.empty())
            problems.push_back(problem_at(light.where, found + ", which render.integrator direct does not have",
                                          "expected a directional, point or spot light without a size; use integrator: path"));
    if (shot.environment.image)
        problems.push_back(problem_at(shot.environment.where, "environment.image is given, which render.integrator direct does not have",
                                      "expected environment.color; use integrator: path"));
}

void check_lens(const Shot& shot, std::vector<Diagnostic>& problems) {
    const bool along = !shot.camera.gltf && shot.camera.position.turns_along();
    if (along && shot.camera.f_stop && !shot.camera.focus)
        problems.push_back(problem_at(shot.camera.where, "camera.f_stop is given without camera.focus",
                                      "expected a distance or a node in camera.focus: a camera that looks along its path has no look_at to focus on"));
    if (shot.camera.gltf && shot.camera.f_stop && !shot.camera.focus)
        problems.push_back(problem_at(shot.camera.where, "camera.f_stop is given without camera.focus",
                                      "expected a distance or a node in camera.focus: an authored camera has no look_at to focus on"));
}

/// What an entry of `scenes` means for its file. Each of its steps can fail without hiding what others find.
BoundScene bind_scene(const Scene& scene, int file, const SceneSpec& spec, std::vector<Diagnostic>& problems) {
    BoundScene bound;
    for (const ClipLayer& layer : spec.layers)
        collect(problems, [&] {
            std::vector<int> clips = playing_clips(scene, file, layer);
            if (!clips.empty()) bound.layers.push_back(make_layer(layer, std::move(clips), scene));
        });
    for (const NodeOverride& node : spec.nodes) collect(problems, [&] { bound.overrides.push_back({resolve_node(scene, file, {node.name, node.where}), &node}); });
    for (const NamedAt& name : spec.hide)
        collect(problems, [&] {
            const std::vector<int> nodes = resolve_nodes(scene, file, name);
            bound.hidden.insert(bound.hidden.end(), nodes.begin(), nodes.end());
        });
    return bound;
}

void check_overrides(const Scene& scene, int file, const BoundScene& bound, std::vector<Diagnostic>& problems) {
    std::map<int, const NodeOverride*> seen;
    for (const BoundScene::Override& node : bound.overrides)
        if (const auto [first, fresh] = seen.emplace(node.node, node.spec); !fresh)
            problems.push_back(problem_at(node.spec->where, fmt::format("'{}' and '{}' are the same node, {}", first->second->name, node.spec->name, node_path(scene, file, node.node)),
                                          "expected each node once"));
}

void check_camera(const Shot& shot, const Scene& scene, const std::vector<BoundScene>& scenes, int camera, std::vector<Diagnostic>& problems) {
    for (std::size_t f = 0; f < scenes.size(); ++f)
        for (int above = camera; above >= 0; above = scene.nodes[static_cast<std::size_t>(above)].parent)
            if (std::find(scenes[f].hidden.begin(), scenes[f].hidden.end(), above) != scenes[f].hidden.end()) {
                problems.push_back(problem_at(shot.camera.gltf->where, fmt::format("camera.gltf is '{}', which scenes.{}.hide leaves out", shot.camera.gltf->text, scene.files[f].id),
                                              fmt::format("expected a camera that is there; take '{}' out of the list", scene.nodes[static_cast<std::size_t>(above)].name)));
                return;
            }
}

/// Seconds of shot time at which the last clip has come to its end; 0 without clips.
double longest_clip_s(const std::vector<BoundScene>& scenes) {
    double longest = 0;
    for (const BoundScene& scene : scenes)
        for (const PlayingLayer& layer : scene.layers) longest = std::max(longest, layer.end_s());
    return longest;
}

Timing with_frames(const Shot& shot, double longest_s) {
    Timing timing = shot.timing;
    if (shot.frames_given) return timing;
    // Files hold times as floats: an end that is late by their rounding does not ask for one more frame.
    const double last = std::ceil(longest_s * timing.fps.value() - 1e-4);
    if (!(last < kMostFrames))
        throw InputError(problem_at({shot.file.string(), 0, 0}, fmt::format("the longest clip runs for {:.0f} s", longest_s),
                                    fmt::format("expected fewer than {} frames; give timing.frames", kMostFrames)));
    timing.frames.resize(static_cast<std::size_t>(last) + 1);
    std::iota(timing.frames.begin(), timing.frames.end(), timing.first);
    return timing;
}

void check_ranges(const Shot& shot, const Sequence& sequence, std::vector<Diagnostic>& problems) {
    // The motion layer looks at the frame before.
    const double lead_s = shot.output.has(Aov::motion) ? 1 / sequence.timing().fps.value() : 0;
    const std::vector<Diagnostic> found = values_out_of_range(shot.limited_tracks, sequence, lead_s);
    problems.insert(problems.end(), found.begin(), found.end());
}

}  // namespace

BoundNames bind_names(const Shot& shot, const Scene& scene) {
    std::vector<Diagnostic> problems;
    BoundNames names;
    for (std::size_t f = 0; f < scene.files.size(); ++f) {
        names.scenes.push_back(bind_scene(scene, static_cast<int>(f), shot.scenes.at(f), problems));
        check_overrides(scene, static_cast<int>(f), names.scenes.back(), problems);
        collect(problems, [&] { check_morph_weights(scene, static_cast<int>(f), names.scenes.back()); });
    }
    for (std::size_t f = 0; f < scene.files.size(); ++f) collect(problems, [&] { check_appearance(scene, f, shot.scenes.at(f)); });
    for (const NodeReference& reference : references_of(shot))
        collect(problems, [&] { names.references[reference.text] = resolve(scene, reference); });
    if (shot.camera.gltf) collect(problems, [&] { names.camera_node = resolve_camera(scene, *shot.camera.gltf); });
    check_camera(shot, scene, names.scenes, names.camera_node, problems);
    check_integrator(shot, problems);
    check_lens(shot, problems);
    collect(problems, [&] {
        names.timing = with_frames(shot, longest_clip_s(names.scenes));
        check_ranges(shot, Sequence(names.timing, shot.shutter), problems);
    });
    drop_repeated(problems);
    if (!problems.empty()) throw InputError(std::move(problems));
    return names;
}

}  // namespace kadr
