#include "device/embree/frame_facts.h"

#include <algorithm>

#include "device/embree/flatten.h"
#include "device/tables/kernel_needs.h"
#include "device/tables/light_tables.h"
#include "kernels/light/light.h"

namespace kadr {
namespace {

void note_shown(const Scene& scene, const SceneSnapshot& snapshot, MaterialTable& materials) {
    std::vector<kernels::Geometry> geometries(scene.geometries.size(), kernels::Geometry{});
    for (std::size_t i = 0; i < geometries.size(); ++i) {
        geometries[i].triangle_count = static_cast<unsigned>(scene.geometries[i].indices.size() / 3);
        if (!scene.geometries[i].colors.empty()) geometries[i].colors = scene.geometries[i].colors.data();
        if (!scene.geometries[i].uv[1].empty()) geometries[i].uv1 = scene.geometries[i].uv[1].data();
    }
    std::vector<kernels::Instance> instances;
    for (const SnapshotInstance& instance : snapshot.instances) instances.push_back({instance.geometry, instance.material, instance.id});
    materials.note_shown(snapshot, instances, geometries);
}

bool shines(const SceneSnapshot& snapshot, const MaterialTable& materials) {
    return std::any_of(snapshot.instances.begin(), snapshot.instances.end(), [&](const SnapshotInstance& instance) {
        const kernels::Material& material = materials.data()[instance.material];
        return instance.mask != 0 && !material.unlit && kernels::luminance(material.emission) > 0;
    });
}

/// As far as it decides anything: an image of the environment is one white pixel, all that shines one triangle.
kernels::LightSet lights_of(const SceneSnapshot& snapshot, const MaterialTable& materials) {
    const Image white{1, 1, {"R", "G", "B"}, {1, 1, 1}};
    kernels::LightSet lights{};
    LightTables tables;
    tables.set(snapshot.light_keys, snapshot.lights);
    tables.fill(lights);
    fill_environment(snapshot.environment, snapshot.environment.image ? EnvironmentTables(white) : EnvironmentTables(), lights);
    lights.triangle_count = shines(snapshot, materials) ? 1 : 0;
    return lights;
}

bool shows_instances(const Scene& scene, const SceneSnapshot& snapshot) {
    const std::vector<bool> flattened = choose_flattened(scene, snapshot);
    for (std::size_t i = 0; i < flattened.size(); ++i)
        if (!flattened[i] && snapshot.instances[i].mask != 0) return true;
    return false;
}

}  // namespace

unsigned kernel_requirements_of(const Scene& scene, const SceneSnapshot& snapshot) {
    MaterialTable materials(scene);
    materials.set(snapshot);
    note_shown(scene, snapshot, materials);
    const bool bends = std::any_of(snapshot.deformed.begin(), snapshot.deformed.end(), [](const auto& mesh) { return mesh->key_count > 1; });
    return kernel_requirements_of(materials, shows_instances(scene, snapshot), bends, lights_of(snapshot, materials));
}

}  // namespace kadr
