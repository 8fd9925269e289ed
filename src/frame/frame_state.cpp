#include "frame/frame_state.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/bind_deformers.h"
#include "frame/bind_names.h"
#include "frame/bindings.h"
#include "frame/copy_limits.h"
#include "frame/problem.h"
#include "frame/scatter.h"

namespace kadr {

namespace {

std::vector<Diagnostic> limit_warnings(const Scene& scene, const std::vector<BoundScene>& scenes, const Sequence& sequence) {
    const std::vector<int>& frames = sequence.timing().frames;
    if (frames.empty()) return {};
    return warnings_of_limits(scene, scenes, sequence.frame(frames.front()).open_s, sequence.frame(frames.back()).close_s);
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
    BoundNames names = bind_names(shot, scene);
    const std::vector<BoundScene>& scenes = names.scenes;
    timing_ = std::move(names.timing);
    sequence_ = Sequence(timing_, shot.shutter);

    auto bindings = std::make_shared<Bindings>(
        Bindings{NodeRig(shot, scene, scenes), std::move(names.references), {}, {}, {}, {}, {}, {}, {}, names.camera_node, PropertyRig(scene, scenes), {}, {}, MorphRig(scene, scenes), {}});
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
