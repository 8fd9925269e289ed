#include "frame/deformer.h"

#include "frame/bindings.h"
#include "frame/snapshot.h"

namespace kadr {

namespace {

/// The inverse of translate(centre) * scale(scale), times `m`.
glm::dmat4 normalised(glm::dmat4 m, const glm::dvec3& centre, double scale) {
    m[3] -= glm::dvec4(centre, 0);
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row) m[column][row] /= scale;
    return m;
}

glm::dmat4 mesh_from_geometry(const GeometryData& geometry) {
    glm::dmat4 m(geometry.scale);
    m[3] = glm::dvec4(geometry.centre, 1);
    return m;
}

}  // namespace

DeformationPose Deformer::pose(const Scene& scene, const Bindings& bindings, double time_s, double clip_offset_s) const {
    DeformationPose pose;
    const GeometryData& source = scene.geometries[geometry];
    const glm::dmat4 mesh = mesh_from_geometry(source);
    if (skeleton)
        pose.joints = skeleton->root_from_mesh(bindings.rig, time_s, clip_offset_s);
    else
        pose.joints.assign(1, glm::dmat4(1));
    for (glm::dmat4& joint : pose.joints) joint = normalised(joint * mesh, centre, scale);
    if (!source.targets.empty()) pose.weights = bindings.morphs.weights(mesh_node, time_s, clip_offset_s);
    return pose;
}

std::shared_ptr<const DeformedMesh> DeformedCache::find(std::uint32_t number, std::uint64_t version) const {
    const std::lock_guard lock(mutex_);
    const auto found = last_.find(number);
    return found != last_.end() && found->second->version == version ? found->second : nullptr;
}

void DeformedCache::keep(std::shared_ptr<const DeformedMesh> mesh) {
    const std::lock_guard lock(mutex_);
    const std::uint32_t number = mesh->number;
    last_[number] = std::move(mesh);
}

}  // namespace kadr
