#include "frame/frame_state.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/bindings.h"
#include "frame/bind_deformers.h"
#include "frame/copy_limits.h"
#include "frame/problem.h"
#include "frame/scatter.h"

namespace kadr {

namespace {

constexpr int kMostFrames = 1'000'000;

/// Runs a step and keeps what it complains about, so that all problems of a shot come at once.
template <class Step>
void collect(std::vector<Diagnostic>& problems, Step step) {
    try {
        step();
    } catch (const InputError& error) {
        problems.insert(problems.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
}

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

std::vector<Diagnostic> limit_warnings(const Scene& scene, const std::vector<BoundScene>& scenes, const Sequence& sequence) {
    const std::vector<int>& frames = sequence.timing().frames;
    if (frames.empty()) return {};
    return warnings_of_limits(scene, scenes, sequence.frame(frames.front()).open_s, sequence.frame(frames.back()).close_s);
}

void check_ranges(const Shot& shot, const Sequence& sequence, std::vector<Diagnostic>& problems) {
    // The motion layer looks at the frame before.
    const double lead_s = shot.output.has(Aov::motion) ? 1 / sequence.timing().fps.value() : 0;
    const std::vector<Diagnostic> found = values_out_of_range(shot.limited_tracks, sequence, lead_s);
    problems.insert(problems.end(), found.begin(), found.end());
}

std::vector<InstanceSeed> seeds_of(const Scene& scene, const NodeRig& rig, const MaterialRig& materials) {
    std::vector<InstanceSeed> seeds;
    for (std::size_t node = 0; node < scene.nodes.size(); ++node)
        for (const MeshPrimitive& primitive : scene.nodes[node].primitives) {
            if (!rig.reachable(static_cast<int>(node))) continue;
            const int material = materials.material_of(rig.file_of(static_cast<int>(node)), primitive);
            seeds.push_back({static_cast<int>(node), static_cast<std::uint32_t>(primitive.geometry), static_cast<std::uint32_t>(material), static_cast<int>(node)});
        }
    return seeds;
}

/// Copies of every file of the shot; empty lists for those that are not repeated.
std::vector<std::vector<Placement>> copies_of(const Shot& shot, const Scene& scene, const NodeRig& rig) {
    std::vector<Diagnostic> problems;
    std::vector<std::vector<Placement>> copies(scene.files.size());
    for (std::size_t f = 0; f < copies.size(); ++f) {
        const std::optional<InstancesSpec>& spec = shot.scenes.at(f).instances;
        if (!spec) continue;
        collect(problems, [&] { copies[f] = spec->scatter ? scatter_copies(*spec, static_cast<int>(f), scene, rig) : place_copies(*spec); });
    }
    if (!problems.empty()) throw InputError(std::move(problems));
    return copies;
}

std::vector<double> all_of(const ClipOffsets& entry_offsets_s) {
    std::vector<double> offsets{0};
    for (const std::vector<double>& of_entry : entry_offsets_s) offsets.insert(offsets.end(), of_entry.begin(), of_entry.end());
    std::sort(offsets.begin(), offsets.end());
    offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
    return offsets;
}

/// Whether the instances of a seed look and stand the same throughout the shot.
bool stands_still(const Bindings& bindings, const InstanceSeed& seed) {
    return !bindings.rig.moves(seed.node) && seed.deformer < 0 && !bindings.visibility.ever_hides(seed.mesh_node);
}

void divide_instances(Bindings& bindings) {
    bindings.still = bindings.instances.of_seeds([&](const InstanceSeed& seed) { return stands_still(bindings, seed); });
    bindings.changing = bindings.instances.of_seeds([&](const InstanceSeed& seed) { return !stands_still(bindings, seed); });
}

std::vector<LightSeed> lights_of(const Scene& scene, const NodeRig& rig, const InstanceList& instances) {
    std::vector<LightSeed> lights;
    for (std::size_t node = 0; node < scene.nodes.size(); ++node) {
        if (scene.nodes[node].light < 0 || !rig.reachable(static_cast<int>(node))) continue;
        const std::span<const Placement> copies = instances.copies_of(rig.file_of(static_cast<int>(node)));
        if (copies.empty()) lights.push_back({static_cast<int>(node), nullptr});
        for (const Placement& copy : copies) lights.push_back({static_cast<int>(node), &copy});
    }
    return lights;
}

bool any_emission(const Bindings& bindings) {
    return std::any_of(bindings.seeds.begin(), bindings.seeds.end(),
                       [&](const InstanceSeed& seed) { return bindings.materials.may_emit(seed.material); });
}

bool is_black(const EnvironmentSpec& environment) {
    if (environment.image) return false;
    const auto all_zero = [](const auto& track) {
        return std::all_of(track.keys.begin(), track.keys.end(), [](const auto& key) { return key.value == decltype(key.value){}; });
    };
    return all_zero(environment.color) || all_zero(environment.strength);
}

std::vector<Diagnostic> warnings_of(const Shot& shot, const Bindings& bindings) {
    std::vector<Diagnostic> warnings;
    const SourceLocation file{shot.file.string(), 0, 0};
    const bool lit = !shot.lights.empty() || !bindings.lights.empty();
    if (!lit && !shot.environment.given)
        warnings.push_back(warning_at(file, "there are no lights and no environment",
                                      shot.render.integrator == Integrator::direct
                                          ? "the sky of the default environment is only a background under integrator direct; add `lights`"
                                          : "lit by the default sky; add `lights` or `environment`"));
    if (!lit && shot.environment.given && is_black(shot.environment) && !any_emission(bindings))
        warnings.push_back(warning_at(file, "nothing shines: no lights, a black environment and no emissive material", "every frame will be black"));
    for (std::size_t f = 0; f < shot.scenes.size(); ++f) {
        const auto& spec = shot.scenes[f].instances;
        const std::size_t reached = bindings.instances.copies_of(static_cast<int>(f)).size();
        if (spec && spec->scatter && reached < static_cast<std::size_t>(spec->scatter->count))
            warnings.push_back(warning_at(spec->scatter->where,
                                          fmt::format("scatter: {} of {} copies fit on '{}' at a distance of {} m", reached, spec->scatter->count, spec->scatter->target,
                                                      format_number(spec->scatter->distance_m)),
                                          "give a smaller distance, or a smaller count"));
    }
    if (bindings.seeds.empty()) warnings.push_back(warning_at(file, "the scenes hold nothing to see", "no node of their default scenes has a mesh"));
    return warnings;
}

}  // namespace

glm::dmat4 Bindings::node_transform(int node, const Placement* copy, double time_s) const {
    if (!copy) return rig.node_transform(node, time_s);
    return rig.scene_transform(rig.file_of(node), time_s) * matrix_of(*copy) * rig.scene_from_node(node, time_s, copy->clip_offset_s);
}

glm::dvec3 Bindings::position_of(const NodeReference& reference, double time_s) const {
    const ResolvedReference& at = references.at(reference.text);
    if (at.node < 0) return glm::dvec3(rig.scene_transform(at.file, time_s)[3]);
    return glm::dvec3(node_transform(at.node, time_s)[3]);
}

glm::dmat4 Bindings::copied_from_geometry(const Scene& scene, const Instance& instance) const {
    const glm::dmat4 local = node_from_geometry(scene, *instance.seed);
    return instance.local ? matrix_of(*instance.local) * local : local;
}

std::uint32_t Bindings::bent_mesh_of(const Instance& instance) const {
    const Deformer& deformer = deformers[static_cast<std::size_t>(instance.seed->deformer)];
    const auto& offsets = deformer.clip_offsets_s;
    const auto at = std::lower_bound(offsets.begin(), offsets.end(), instance.clip_offset_s());
    return deformer.first_mesh + static_cast<std::uint32_t>(at - offsets.begin());
}

BentMesh Bindings::bent_mesh(std::uint32_t number) const {
    const auto after = std::upper_bound(deformers.begin(), deformers.end(), number, [](std::uint32_t n, const Deformer& deformer) { return n < deformer.first_mesh; });
    const Deformer& deformer = after[-1];
    return {&deformer, deformer.clip_offsets_s[number - deformer.first_mesh]};
}

glm::dmat4 Bindings::node_from_geometry(const Scene& scene, const InstanceSeed& seed) const {
    const GeometryData& geometry = scene.geometries[seed.geometry];
    const bool bends = seed.deformer >= 0;
    const Deformer* deformer = bends ? &deformers[static_cast<std::size_t>(seed.deformer)] : nullptr;
    glm::dmat4 m(bends ? deformer->scale : geometry.scale);
    m[3] = glm::dvec4(bends ? deformer->centre : geometry.centre, 1);
    return m;
}

BoundShot::BoundShot(const Shot& shot, const Scene& scene) : shot_(&shot), scene_(&scene), sequence_({}, {}) {
    std::vector<Diagnostic> problems;
    std::vector<BoundScene> scenes;
    std::map<std::string, ResolvedReference> references;
    int camera_node = -1;
    for (std::size_t f = 0; f < scene.files.size(); ++f) {
        scenes.push_back(bind_scene(scene, static_cast<int>(f), shot.scenes.at(f), problems));
        check_overrides(scene, static_cast<int>(f), scenes.back(), problems);
        collect(problems, [&] { check_morph_weights(scene, static_cast<int>(f), scenes.back()); });
    }
    for (std::size_t f = 0; f < scene.files.size(); ++f) collect(problems, [&] { check_appearance(scene, f, shot.scenes.at(f)); });
    for (const NodeReference& reference : references_of(shot))
        collect(problems, [&] { references[reference.text] = resolve(scene, reference); });
    if (shot.camera.gltf) collect(problems, [&] { camera_node = resolve_camera(scene, *shot.camera.gltf); });
    check_camera(shot, scene, scenes, camera_node, problems);
    check_integrator(shot, problems);
    check_lens(shot, problems);
    collect(problems, [&] {
        timing_ = with_frames(shot, longest_clip_s(scenes));
        sequence_ = Sequence(timing_, shot.shutter);
        check_ranges(shot, sequence_, problems);
    });
    drop_repeated(problems);
    if (!problems.empty()) throw InputError(std::move(problems));

    auto bindings = std::make_shared<Bindings>(
        Bindings{NodeRig(shot, scene, scenes), std::move(references), {}, {}, {}, {}, {}, {}, {}, camera_node, PropertyRig(scene, scenes), {}, {}, MorphRig(scene, scenes), {}});
    bindings->visibility = VisibilityRig(shot, scene, scenes, bindings->properties);
    std::vector<std::vector<Placement>> copies = copies_of(shot, scene, bindings->rig);
    bindings->entry_offsets_s = clip_offsets_of(copies);
    bindings->clip_offsets_s = all_of(bindings->entry_offsets_s);
    bindings->materials = MaterialRig(shot, scene, bindings->properties, bindings->entry_offsets_s);
    bindings->seeds = seeds_of(scene, bindings->rig, bindings->materials);
    bind_deformers(*this, copies, *bindings);
    bindings->instances = InstanceList(bindings->seeds, scene, std::move(copies));
    check_limits(shot, scene, *bindings);
    divide_instances(*bindings);
    if (shot.use_scene_lights) bindings->lights = lights_of(scene, bindings->rig, bindings->instances);
    for (std::size_t node = 0; node < scene.nodes.size(); ++node) fixed_.push_back(!bindings->rig.moves(static_cast<int>(node)));
    warnings_ = warnings_of(shot, *bindings);
    for (Diagnostic& warning : limit_warnings(scene, scenes, sequence_)) warnings_.push_back(std::move(warning));
    bindings_ = std::move(bindings);
}

std::vector<glm::dmat4> BoundShot::node_transforms(double time_s) const { return bindings_->rig.all_transforms(time_s); }

int BoundShot::node_of(const NodeReference& reference) const {
    if (shot_->camera.gltf && reference == *shot_->camera.gltf) return bindings_->camera_node;
    const auto known = bindings_->references.find(reference.text);
    return (known != bindings_->references.end() ? known->second : resolve(*scene_, reference)).node;
}

int BoundShot::scene_of(const NodeReference& reference) const { return resolve(*scene_, reference).file; }

}  // namespace kadr
