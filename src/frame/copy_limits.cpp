#include "frame/copy_limits.h"

#include <algorithm>

#include <fmt/format.h>

#include "frame/problem.h"

namespace kadr {

namespace {

void check_count(const Shot& shot, const InstanceList& instances) {
    if (instances.size() <= static_cast<std::size_t>(kMostInstances)) return;
    throw InputError(problem_at({shot.file.string(), 0, 0}, fmt::format("the shot has {} instances", instances.size()),
                                fmt::format("expected at most {}: fewer copies, or fewer parts in what is copied", kMostInstances)));
}

void check_lights(const Shot& shot, const Scene& scene, const Bindings& bindings) {
    for (std::size_t node = 0; node < scene.nodes.size(); ++node) {
        if (scene.nodes[node].light < 0 || !bindings.rig.reachable(static_cast<int>(node))) continue;
        const int file = bindings.rig.file_of(static_cast<int>(node));
        const std::size_t copies = bindings.instances.copies_of(file).size();
        if (copies <= kMostLightCopies) continue;
        throw InputError(problem_at(shot.scenes.at(static_cast<std::size_t>(file)).instances->where,
                                    fmt::format("{} copies repeat the light of node '{}'", copies, node_path(scene, file, static_cast<int>(node))),
                                    fmt::format("expected at most {} copies of a light; leave it out with hide, or all with use_scene_lights: false", kMostLightCopies)));
    }
}

/// How often an instance seed is repeated, by copies of its file and by its node's own places.
std::size_t repeats_of(const Scene& scene, const Bindings& bindings, const InstanceSeed& seed) {
    const int set = scene.nodes[static_cast<std::size_t>(seed.mesh_node)].placement_set;
    const std::size_t copies = bindings.instances.copies_of(bindings.rig.file_of(seed.mesh_node)).size();
    const std::size_t places = set < 0 ? 0 : scene.placement_sets[static_cast<std::size_t>(set)].size();
    return std::max<std::size_t>(copies, 1) * std::max<std::size_t>(places, 1);
}

/// What shines and is not repeated may be as fine as the file has it: it is in memory already.
void check_shining(const Shot& shot, const Scene& scene, const Bindings& bindings) {
    std::size_t total = 0, most = 0;
    const InstanceSeed* worst = nullptr;
    for (const InstanceSeed& seed : bindings.seeds) {
        const std::size_t repeats = repeats_of(scene, bindings, seed);
        if (repeats < 2 || !bindings.materials.may_light(seed.material)) continue;
        const std::size_t triangles = repeats * (scene.geometries[seed.geometry].indices.size() / 3);
        total += triangles;
        if (triangles > most) most = triangles, worst = &seed;
    }
    if (total <= kMostShiningTriangles) return;
    const int file = bindings.rig.file_of(worst->mesh_node);
    const SceneSpec& spec = shot.scenes.at(static_cast<std::size_t>(file));
    throw InputError(problem_at(spec.instances ? spec.instances->where : spec.where,
                                fmt::format("{} copies of the mesh of node '{}' shine with {} triangles each: as lights, all shining copies take about {:.1f} GB",
                                            repeats_of(scene, bindings, *worst), node_path(scene, file, worst->mesh_node), scene.geometries[worst->geometry].indices.size() / 3,
                                            128e-9 * static_cast<double>(total)),
                                fmt::format("expected at most {} million shining triangles in copies: fewer copies, a coarser mesh, or no emission (materials: emissive: [0, 0, 0])",
                                            kMostShiningTriangles / 1'000'000)));
}

}  // namespace

void check_limits(const Shot& shot, const Scene& scene, const Bindings& bindings) {
    check_count(shot, bindings.instances);
    if (shot.use_scene_lights) check_lights(shot, scene, bindings);
    check_shining(shot, scene, bindings);
}

}  // namespace kadr
