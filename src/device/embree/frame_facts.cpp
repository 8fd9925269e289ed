#include "device/embree/frame_facts.h"

#include <algorithm>
#include <utility>

#include "device/embree/flatten.h"
#include "device/tables/material_table.h"
#include "kernels/light/light.h"

namespace kadr {
namespace {

constexpr std::pair<unsigned, const char*> kNames[] = {{kernels::requirement::kMaps, "maps"},
                                                       {kernels::requirement::kTransforms, "transforms"},
                                                       {kernels::requirement::kEmitters, "emitters"},
                                                       {kernels::requirement::kDeformation, "deformation"}};

bool shows_maps(const Scene& scene, const SceneSnapshot& snapshot, MaterialTable& materials) {
    std::vector<kernels::Geometry> geometries(scene.geometries.size(), kernels::Geometry{});
    for (std::size_t i = 0; i < geometries.size(); ++i)
        if (!scene.geometries[i].colors.empty()) geometries[i].colors = scene.geometries[i].colors.data();
    std::vector<kernels::Instance> instances;
    for (const SnapshotInstance& instance : snapshot.instances) instances.push_back({instance.geometry, instance.material, instance.id});
    materials.note_shown(snapshot, instances, geometries);
    return materials.shows_maps();
}

bool shows_emitters(const SceneSnapshot& snapshot, const MaterialTable& materials) {
    const auto emits = [&](const SnapshotInstance& instance) {
        const kernels::Material& material = materials.data()[instance.material];
        return instance.mask != 0 && !material.unlit && kernels::luminance(material.emission) > 0;
    };
    const auto has_surface = [&](const LightKeys& light) { return !kernels::is_delta(snapshot.light_keys[light.first]); };
    return snapshot.environment.image || std::any_of(snapshot.lights.begin(), snapshot.lights.end(), has_surface) ||
           std::any_of(snapshot.instances.begin(), snapshot.instances.end(), emits);
}

bool shows_instances(const Scene& scene, const SceneSnapshot& snapshot) {
    const std::vector<bool> flattened = choose_flattened(scene, snapshot);
    for (std::size_t i = 0; i < flattened.size(); ++i)
        if (!flattened[i] && snapshot.instances[i].mask != 0) return true;
    return false;
}

}  // namespace

unsigned requirements_of(const Scene& scene, const SceneSnapshot& snapshot) {
    MaterialTable materials(scene);
    materials.set(snapshot);
    unsigned requirements = 0;
    if (shows_maps(scene, snapshot, materials)) requirements |= kernels::requirement::kMaps;
    if (shows_instances(scene, snapshot)) requirements |= kernels::requirement::kTransforms;
    if (std::any_of(snapshot.deformed.begin(), snapshot.deformed.end(), [](const auto& mesh) { return mesh->key_count > 1; }))
        requirements |= kernels::requirement::kDeformation;
    if (shows_emitters(snapshot, materials)) requirements |= kernels::requirement::kEmitters;
    return requirements;
}

std::string name_of_requirements(unsigned requirements) {
    std::string name;
    for (const auto& [bit, word] : kNames)
        if ((requirements & bit) != 0) name += (name.empty() ? "" : " + ") + std::string(word);
    return name.empty() ? "plain" : name;
}

}  // namespace kadr
