#include "device/embree/embree_scene.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "device/embree/alpha_filter.h"
#include "device/embree/flatten.h"
#include "device/tables/kernel_needs.h"
#include "device/tables/motion_keys.h"

namespace kadr {
namespace {

void check(RTCDevice device, const char* action) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw RenderError(fmt::format("cannot {}: out of memory", action));
    throw RenderError(fmt::format("cannot {}: Embree reports error {}", action, static_cast<int>(error)));
}

const glm::dmat4& fixed_place(const SceneSnapshot& snapshot, const SnapshotInstance& instance) {
    return snapshot.fixed_places[static_cast<std::size_t>(instance.fixed_place)];
}

}  // namespace

EmbreeScene::EmbreeScene(RTCDevice device, const Scene& scene, const Image* environment, const BuildSettings& build)
    : device_(device), scene_(scene), build_(build), materials_(scene), upper_(device, build), deforming_(device, scene, build) {
    geometries_.resize(scene.geometries.size());  // filled in when an instance needs one
    packed_.resize(scene.geometries.size());
    for (const TextureData& t : scene.textures) textures_.push_back(t.view());
    view_.materials = materials_.data();
    view_.textures = textures_.data();
    if (environment) environment_ = EnvironmentTables(*environment);
}

EmbreeScene::~EmbreeScene() = default;

void EmbreeScene::set_frame(const SceneSnapshot& snapshot) {
    view_.settings = snapshot.settings;
    int* const limits[] = {&view_.settings.max_bounces, &view_.settings.max_diffuse, &view_.settings.max_glossy};
    for (int* limit : limits) *limit = std::min(*limit, 250);  // a path counts its bounces in eight bits
    cull_backfaces_ = snapshot.settings.cull_backfaces;
    camera_keys_ = snapshot.camera_keys;
    view_.camera = snapshot.camera;
    view_.camera.keys = camera_keys_.data();
    view_.camera.key_count = static_cast<int>(camera_keys_.size());
    const bool same_emission = materials_.set(snapshot);
    view_.materials = materials_.data();
    const bool same_geometry =
        have_frame_ && snapshot.geometry_key == geometry_key_ && snapshot.space() == flat_space_;
    structures_ = {};
    structures_.kept = mesh_scenes_.size() + (same_geometry ? 2 : 0);
    if (!same_geometry) {
        const std::vector<bool> flattened = choose_flattened(scene_, snapshot);
        std::vector<std::uint32_t> flat_ids;
        for (std::size_t i = 0; i < flattened.size(); ++i)
            if (flattened[i]) flat_ids.push_back(snapshot.instances[i].id);
        const bool same_flat = have_frame_ && flattened == flattened_ && flat_ids == flat_ids_ && snapshot.space() == flat_space_;
        if (!same_flat) build_flat(snapshot, flattened);
        ++(same_flat ? structures_.kept : structures_.built);
        geometries_.resize(rigid_geometries_);
        deforming_.set_frame(snapshot, view_, cull_backfaces_, geometries_);
        structures_.built += deforming_.built();
        structures_.updated += deforming_.refitted();
        check(device_, "build the acceleration structure of a bending mesh");
        const bool same_still = have_frame_ && flattened == flattened_ && snapshot.instances.shared() == still_.list;
        build_instances(snapshot, flattened, same_still ? snapshot.instances.shared_size() : 0);
        if (!same_still) previous_matrices_.clear();
        still_.list = snapshot.instances.shared();
        flattened_ = flattened;
        flat_ids_ = std::move(flat_ids);
        flat_space_ = snapshot.space();
        geometry_key_ = snapshot.geometry_key;
        have_frame_ = true;
    }
    view_.geometries = geometries_.data();
    view_.instances = instances_.data();
    view_.motions = motions_.data();
    view_.matrices = matrices_.data();
    view_.keys = keys_.data();
    if (!same_geometry || !same_emission) emitters_.set(snapshot, view_);
    emitters_.fill(view_.lights);
    if (!same_geometry) materials_.note_shown(snapshot, instances_, geometries_);
    lights_.set(snapshot.light_keys, snapshot.lights);
    lights_.fill(view_.lights);
    fill_environment(snapshot.environment, environment_, view_.lights);
    set_previous(snapshot);
    set_requirements();
}

void EmbreeScene::set_previous(const SceneSnapshot& snapshot) {
    view_.previous_matrices = nullptr;
    deforming_.set_previous(snapshot, geometries_);
    if (!snapshot.previous) return;
    const std::size_t shared = snapshot.instances.shared_size(), known = std::min(previous_matrices_.size(), shared);
    previous_matrices_.resize(snapshot.instances.size());
    for (std::size_t i = known; i < shared; ++i) previous_matrices_[i] = matrices_[motions_[i].first];
    for (std::size_t i = shared; i < previous_matrices_.size(); ++i) {
        // Flattened vertices are relative to the render origin already, and have not moved.
        const glm::dmat4 m = motions_[i].identity ? glm::dmat4(1) : snapshot.previous->space_from_geometry[i - shared];
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) previous_matrices_[i].m[row][column] = static_cast<float>(m[column][row]);
    }
    previous_camera_key_ = snapshot.previous->camera;
    view_.previous_matrices = previous_matrices_.data();
    view_.previous_camera = snapshot.camera;
    view_.previous_camera.keys = &previous_camera_key_;
    view_.previous_camera.key_count = 1;
}

EmbreeGeometryHandle EmbreeScene::make_triangles(const kernels::Geometry& geometry, unsigned material) {
    EmbreeGeometryHandle handle(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE));
    if (needs_filter(view_.materials[material], cull_backfaces_)) {
        rtcSetGeometryIntersectFilterFunction(handle.get(), alpha_filter);
        rtcSetGeometryOccludedFilterFunction(handle.get(), alpha_filter);
    }
    rtcSetSharedGeometryBuffer(handle.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, geometry.indices, 0, 12,
                               geometry.triangle_count);
    rtcSetSharedGeometryBuffer(handle.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, geometry.vertices, 0,
                               sizeof(kernels::Vertex), geometry.vertex_count);
    return handle;
}

void EmbreeScene::build_flat(const SceneSnapshot& snapshot, const std::vector<bool>& flattened) {
    flat_ = new_structure(device_, build_);
    baked_.clear();
    flat_users_.clear();
    flat_triangles_ = 0;
    baked_.resize(flattened.size());
    geometries_.resize(scene_.geometries.size());
    tbb::parallel_for(std::size_t{0}, flattened.size(), [&](std::size_t i) {
        if (!flattened[i] || snapshot.instances[i].mask == 0) return;
        const SnapshotInstance& instance = snapshot.instances[i];
        baked_[i] = std::make_unique<PackedGeometry>(scene_.geometries[instance.geometry], fixed_place(snapshot, instance),
                                                     snapshot.space());
    });
    for (std::size_t i = 0; i < baked_.size(); ++i) {
        if (!baked_[i]) continue;
        const SnapshotInstance& instance = snapshot.instances[i];
        const unsigned index = static_cast<unsigned>(geometries_.size());
        geometries_.push_back(baked_[i]->view(scene_.geometries[instance.geometry]));
        const kernels::Geometry& geometry = geometries_.back();
        if (geometry.triangle_count == 0) continue;
        EmbreeGeometryHandle handle = make_triangles(geometry, instance.material);
        flat_users_.push_back(
            std::make_unique<GeometryUser>(GeometryUser{&view_, index, instance.material, cull_backfaces_}));
        rtcSetGeometryUserData(handle.get(), flat_users_.back().get());
        rtcCommitGeometry(handle.get());
        rtcAttachGeometryByID(flat_.get(), handle.get(), static_cast<unsigned>(i));
        flat_triangles_ += geometry.triangle_count;
    }
    rigid_geometries_ = geometries_.size();
    rtcCommitScene(flat_.get());
    check(device_, "build the acceleration structure");
}

RTCScene EmbreeScene::mesh_scene(unsigned geometry_index, unsigned material) {
    EmbreeSceneHandle& handle = mesh_scenes_[{geometry_index, material}];
    if (handle) return handle.get();
    handle = new_structure(device_, build_);
    ++structures_.built;
    if (!packed_[geometry_index]) {
        packed_[geometry_index] = std::make_unique<PackedGeometry>(scene_.geometries[geometry_index]);
        geometries_[geometry_index] = packed_[geometry_index]->view(scene_.geometries[geometry_index]);
    }
    const kernels::Geometry& geometry = geometries_[geometry_index];
    if (geometry.triangle_count > 0) {
        EmbreeGeometryHandle triangles = make_triangles(geometry, material);
        users_.push_back(
            std::make_unique<GeometryUser>(GeometryUser{&view_, geometry_index, material, cull_backfaces_}));
        rtcSetGeometryUserData(triangles.get(), users_.back().get());
        rtcCommitGeometry(triangles.get());
        rtcAttachGeometry(handle.get(), triangles.get());
    }
    rtcCommitScene(handle.get());
    check(device_, "build the acceleration structure of a mesh");
    return handle.get();
}

/// @param first  instances before it are those of the frame before, with the same meshes in the same places
void EmbreeScene::build_instances(const SceneSnapshot& snapshot, const std::vector<bool>& flattened, std::size_t first) {
    const std::size_t count = snapshot.instances.size(), shared = snapshot.instances.shared_size();
    std::vector<RTCScene> meshes(count - first);  // null: nothing to see, or flattened
    for (std::size_t i = first; i < count; ++i) {
        const SnapshotInstance& source = snapshot.instances[i];
        if (flattened[i] || source.mask == 0 || scene_.geometries[source.geometry].indices.empty()) continue;
        meshes[i - first] = source.deformed >= 0 ? deforming_.structure(source) : mesh_scene(source.geometry, source.material);
    }
    lay_out_motions(snapshot, flattened, first);
    instance_count_ = first > 0 ? still_.shown : 0;
    moving_count_ = 0;
    for (std::size_t i = first; i < count; ++i) {
        if (i == shared) still_.shown = instance_count_;
        instance_count_ += meshes[i - first] ? 1 : 0;
        moving_count_ += meshes[i - first] && motions_[i].count > 1 ? 1 : 0;
    }
    if (shared == count) still_.shown = instance_count_;
    upper_.resize(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, count, 1024), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) set_instance(snapshot, i, meshes[i - first]);
    });
    upper_.commit();
    ++structures_.built;
    check(device_, "build the acceleration structure of the instances");
}

/// Gives every instance from `first` on its entries in the tables of matrices and keys.
void EmbreeScene::lay_out_motions(const SceneSnapshot& snapshot, const std::vector<bool>& flattened, std::size_t first) {
    using Kind = kernels::InstanceMotion::Kind;
    const std::size_t count = snapshot.instances.size(), shared = snapshot.instances.shared_size();
    instances_.resize(count);
    motions_.resize(count);
    // The first matrix is that of everything flattened.
    TableSizes next = first > 0 ? still_.tables : TableSizes{1, 0, static_cast<unsigned>(scene_.geometries.size())};
    for (std::size_t i = first; i < count; ++i) {
        if (i == shared) still_.tables = next;
        const SnapshotInstance& source = snapshot.instances[i];
        instances_[i] = {source.geometry, source.material, source.id};
        if (source.deformed >= 0 && source.mask != 0) instances_[i].geometry = deforming_.geometry(source);
        motions_[i] = {0, 1, Kind::still, true};
        if (flattened[i]) {
            if (baked_[i]) instances_[i].geometry = next.geometries++;
            continue;
        }
        const unsigned frames = snapshot.motion.headers[i].frame_count;
        const bool linear = is_linear(snapshot.motion, i);
        unsigned& table = linear ? next.matrices : next.keys;
        motions_[i] = {table, frames, !linear ? Kind::keys : frames == 1 ? Kind::still : Kind::linear, false};
        table += frames;
    }
    if (shared == count) still_.tables = next;
    matrices_.resize(next.matrices);
    matrices_[0] = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    keys_.resize(next.keys);
}

/// Fills an instance's matrices or keys in and shows its mesh there. @param mesh  null: nothing to show
void EmbreeScene::set_instance(const SceneSnapshot& snapshot, std::size_t index, RTCScene mesh) {
    const kernels::InstanceMotion& motion = motions_[index];
    if (!motion.identity) {
        for (unsigned k = 0; k < motion.count; ++k) {
            if (motion.kind == kernels::InstanceMotion::Kind::keys)
                keys_[motion.first + k] = key_at(snapshot.motion, index, k);
            else
                matrices_[motion.first + k] = matrix_at(snapshot.motion, index, k);
        }
    }
    if (!mesh) return upper_.hide(index);
    if (motion.kind == kernels::InstanceMotion::Kind::keys)
        upper_.show(index, mesh, std::span(keys_).subspan(motion.first, motion.count));
    else
        upper_.show(index, mesh, std::span(matrices_).subspan(motion.first, motion.count));
}

void EmbreeScene::set_requirements() { requirements_ = kernel_requirements_of(materials_, instance_count_ > 0, deforming_.bends(), view_.lights); }

}  // namespace kadr
