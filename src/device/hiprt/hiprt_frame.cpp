#include "device/hiprt/hiprt_frame.h"

#include <algorithm>
#include <set>

#include "device/hiprt/sheared_motion.h"
#include "device/tables/kernel_needs.h"

namespace kadr {

HiprtFrame::HiprtFrame(SharedTables& shared)
    : shared_(shared),
      scene_(shared.scene),
      builder_(shared.builder),
      uploads_(shared.uploads),
      memory_(shared.builder.memory()),
      rigid_(shared.rigid),
      bending_(shared.scene, shared.builder, shared.uploads, shared.bending_kernel),
      materials_(shared.scene) {}

void HiprtFrame::set(const SceneSnapshot& given) {
    const std::optional<SceneSnapshot> bent = bend_sheared_motion(given, scene_);
    const SceneSnapshot& snapshot = bent ? *bent : given;
    const bool same_geometry = have_frame_ && snapshot.geometry_key == geometry_key_ &&
                               snapshot.space() == space_ && snapshot.settings.cull_backfaces == cull_backfaces_;
    // Until all is done there is no frame: whatever fails, the next call starts anew.
    have_frame_ = false;
    cull_backfaces_ = snapshot.settings.cull_backfaces;
    view_.settings = snapshot.settings;
    int* const limits[] = {&view_.settings.max_bounces, &view_.settings.max_diffuse, &view_.settings.max_glossy};
    for (int* limit : limits) *limit = std::min(*limit, 250);  // a path counts its bounces in eight bits
    const bool same_emission = materials_.set(snapshot);
    structures_ = {};
    structures_.kept = same_geometry ? rigid_.kept() + rigid_.built() + snapshot.deformed.size() + 1 : 0;
    if (!same_geometry) build_geometry(snapshot);
    if (!same_geometry || !same_emission) emitters_.set(snapshot, host_view());
    set_previous(snapshot);
    set_shared(snapshot);
    set_lights(snapshot);
    set_camera(snapshot);
    set_requirements();
    geometry_key_ = snapshot.geometry_key;
    space_ = snapshot.space();
    have_frame_ = true;
}

void HiprtFrame::forget() {
    top_ = {};
    have_frame_ = false;
}

bool HiprtFrame::is_filtered(const SnapshotInstance& instance) const {
    return needs_filter(materials_.data()[instance.material], cull_backfaces_);
}

void HiprtFrame::require_meshes(const SceneSnapshot& snapshot) {
    filtered_mesh_.assign(scene_.geometries.size(), false);
    filtered_bend_.assign(snapshot.deformed.size(), false);
    const auto mark = [](std::vector<bool>& list, std::size_t i) { list[i] = true; };
    for (const SnapshotInstance& instance : snapshot.instances)
        if (is_filtered(instance)) {
            if (instance.deformed >= 0)
                mark(filtered_bend_, static_cast<std::size_t>(instance.deformed));
            else
                mark(filtered_mesh_, instance.geometry);
        }
    std::set<MeshUse> uses;
    for (const SnapshotInstance& instance : snapshot.instances)
        if (instance.deformed < 0 && instance.mask != 0 && !scene_.geometries[instance.geometry].indices.empty())
            uses.insert({instance.geometry, filtered_mesh_[instance.geometry]});
    rigid_.require(uses);
    bending_.set_frame(snapshot, filtered_bend_);
    asks_functions_ = std::any_of(uses.begin(), uses.end(), [](const MeshUse& use) { return use.second; }) ||
                      std::find(filtered_bend_.begin(), filtered_bend_.end(), true) != filtered_bend_.end() ||
                      bending_.blurs();
}

void HiprtFrame::build_geometry(const SceneSnapshot& snapshot) {
    // Before the structures that it shows change. Those of rigid meshes stay, and so does the memory of this one, which is
    // built anew in its place: giving memory back would wait for all launches.
    if (!snapshot.deformed.empty() || !bending_.empty()) top_ = {};
    bending_.forget(snapshot);
    require_meshes(snapshot);
    tables_ = make_instance_tables(snapshot, [&](std::size_t i) { return mesh_of(snapshot, i); });
    host_geometries_ = list_geometries(snapshot, true);
    materials_.note_shown(snapshot, tables_.instances, host_geometries_);
    instances_.set(memory_, uploads_, tables_.instances);
    motions_.set(memory_, uploads_, tables_.motions);
    matrices_.set(memory_, uploads_, tables_.matrices);
    keys_.set(memory_, uploads_, tables_.keys);
    if (!tables_.shown.empty())
        build_top_level();
    else
        top_ = {};
    structures_.built = rigid_.built() + bending_.built() + (tables_.shown.empty() ? 0 : 1);
    structures_.updated = bending_.updated();
    structures_.kept = rigid_.kept() + bending_.kept();
}

/// Rigid meshes at their places in the scene, bending ones behind them.
std::vector<kernels::Geometry> HiprtFrame::list_geometries(const SceneSnapshot& snapshot, bool on_host) const {
    std::vector<kernels::Geometry> list;
    for (unsigned i = 0; i < rigid_.count(); ++i) list.push_back(on_host ? rigid_.host(i) : rigid_.device(i));
    for (std::size_t i = 0; i < snapshot.deformed.size(); ++i) {
        const int mesh = static_cast<int>(i);
        const bool empty = scene_.geometries[snapshot.deformed[i]->geometry].indices.empty();
        list.push_back(empty     ? kernels::Geometry{}
                       : on_host ? bending_.host(snapshot, mesh)
                                 : bending_.device(snapshot, mesh));
    }
    return list;
}

ShownMesh HiprtFrame::mesh_of(const SceneSnapshot& snapshot, std::size_t index) const {
    const SnapshotInstance& instance = snapshot.instances[index];
    ShownMesh mesh{instance.geometry, nullptr};
    if (instance.deformed >= 0)
        mesh.geometry = static_cast<unsigned>(rigid_.count()) + static_cast<unsigned>(instance.deformed);
    if (instance.mask == 0 || scene_.geometries[instance.geometry].indices.empty()) return mesh;
    mesh.structure = instance.deformed >= 0 ? bending_.structure(snapshot, instance.deformed)
                                            : rigid_.structure({instance.geometry, filtered_mesh_[instance.geometry]});
    return mesh;
}

void HiprtFrame::build_top_level() {
    hiprt_instances_.set(memory_, uploads_, tables_.shown);
    masks_.set(memory_, uploads_, tables_.masks);
    instance_of_.set(memory_, uploads_, tables_.instance_of);
    headers_.set(memory_, uploads_, tables_.headers);
    srt_.set(memory_, uploads_, tables_.srt);
    frame_matrices_.set(memory_, uploads_, tables_.frame_matrices);
    hiprt::SceneBuildInput input;
    input.instances = hiprt_instances_.pointer();
    input.headers = headers_.pointer();
    input.frames = tables_.frame_type == hiprt::FrameType::srt ? srt_.pointer() : frame_matrices_.pointer();
    input.masks = masks_.pointer();
    input.instance_count = static_cast<std::uint32_t>(tables_.shown.size());
    input.frame_count = static_cast<std::uint32_t>(tables_.frame_count());
    input.frame_type = tables_.frame_type;
    // Built for every frame, so fast; how much slower rays are in it no GPU has shown yet.
    builder_.build_top_level(top_, input, build_options(StructureQuality::fast, false));
}

/// What the emitters are made from: the tables of the host.
kernels::SceneView HiprtFrame::host_view() const {
    kernels::SceneView view{};
    view.geometries = host_geometries_.data();
    view.instances = tables_.instances.data();
    view.motions = tables_.motions.data();
    view.matrices = tables_.matrices.data();
    view.keys = tables_.keys.data();
    view.materials = materials_.data();
    view.textures = shared_.host_textures.data();
    return view;
}

void HiprtFrame::set_shared(const SceneSnapshot& snapshot) {
    geometries_.set(memory_, uploads_, list_geometries(snapshot, false));
    material_table_.set(memory_, uploads_, {materials_.data(), materials_.count()});
    view_.geometries = geometries_.data();
    view_.instances = instances_.data();
    view_.motions = motions_.data();
    view_.matrices = matrices_.data();
    view_.keys = keys_.data();
    view_.materials = material_table_.data();
    view_.textures = shared_.textures.data();
}

void HiprtFrame::set_lights(const SceneSnapshot& snapshot) {
    lights_.set(snapshot.light_keys, snapshot.lights);
    lights_.fill(view_.lights);
    emitters_.fill(view_.lights);
    fill_environment(snapshot.environment, shared_.environment, view_.lights);
    light_keys_.set(memory_, uploads_, lights_.keys());
    light_first_.set(memory_, uploads_, lights_.first());
    light_key_count_.set(memory_, uploads_, lights_.key_count());
    emissive_triangles_.set(memory_, uploads_, emitters_.triangles());
    emissive_cdf_.set(memory_, uploads_, emitters_.cdf());
    instance_density_.set(memory_, uploads_, emitters_.instance_density());
    kernels::LightSet& set = view_.lights;
    set.keys = light_keys_.data();
    set.first = light_first_.data();
    set.key_count = light_key_count_.data();
    set.triangles = emissive_triangles_.data();
    set.triangle_cdf = emissive_cdf_.data();
    set.instance_density = instance_density_.data();
    set.map.texels = shared_.environment_texels.data();
    set.map.marginal = shared_.environment_marginal.data();
    set.map.conditional = shared_.environment_conditional.data();
}

void HiprtFrame::set_camera(const SceneSnapshot& snapshot) {
    camera_keys_.set(memory_, uploads_, snapshot.camera_keys);
    view_.camera = snapshot.camera;
    view_.camera.keys = camera_keys_.data();
    view_.camera.key_count = static_cast<int>(snapshot.camera_keys.size());
    view_.previous_camera = snapshot.camera;
    view_.previous_camera.key_count = 1;
    if (snapshot.previous) previous_camera_.set(memory_, uploads_, {&snapshot.previous->camera, 1});
    view_.previous_camera.keys = previous_camera_.data();
}

void HiprtFrame::set_previous(const SceneSnapshot& snapshot) {
    bending_.set_previous(snapshot);
    view_.previous_matrices = nullptr;
    if (!snapshot.previous) return;
    const std::size_t shared = snapshot.instances.shared_size();
    std::vector<kernels::Affine> matrices(snapshot.instances.size());
    for (std::size_t i = 0; i < shared; ++i) matrices[i] = tables_.matrices[tables_.motions[i].first];  // stands still
    for (std::size_t i = shared; i < matrices.size(); ++i) {
        const glm::dmat4& m = snapshot.previous->space_from_geometry[i - shared];
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) matrices[i].m[row][column] = static_cast<float>(m[column][row]);
    }
    previous_matrices_.set(memory_, uploads_, matrices);
    view_.previous_matrices = previous_matrices_.data();
}

void HiprtFrame::set_requirements() { requirements_ = kernel_requirements_of(materials_, !tables_.shown.empty(), bending_.blurs(), view_.lights); }

}  // namespace kadr
