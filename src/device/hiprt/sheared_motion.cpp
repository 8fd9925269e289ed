#include "device/hiprt/sheared_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "base/hash.h"
#include "frame/decompose.h"
#include "frame/motion_frames.h"
#include "frame/skinning.h"

namespace kadr {
namespace {

/// Steps of a shutter beyond which no keys are added.
constexpr unsigned kMostSteps = 256;
/// Numbers of meshes of our own begin here; those of the shot's deformers are counted from 0.
constexpr std::uint32_t kFirstNumber = 0x80000000u;

bool is_sheared_motion(const MotionFrames& motion, std::size_t instance) {
    const unsigned count = motion.headers[instance].frame_count;
    if (count == 1 || motion.types[instance] != FrameType::matrix) return false;
    for (unsigned k = 0; k < count; ++k)
        if (is_sheared(frame_parts(motion, instance, k))) return true;
    return false;
}

using Corners = std::array<glm::dvec3, 8>;

/// Of the box around some positions.
template <class Positions, class PositionOf>
Corners corners_of(const Positions& positions, const PositionOf& position_of) {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const auto& each : positions) {
        const kernels::Vec3f p = position_of(each);
        low = glm::min(low, glm::dvec3(p.x, p.y, p.z));
        high = glm::max(high, glm::dvec3(p.x, p.y, p.z));
    }
    Corners corners;
    for (int i = 0; i < 8; ++i)
        for (int axis = 0; axis < 3; ++axis) corners[static_cast<std::size_t>(i)][axis] = (i >> axis & 1) != 0 ? high[axis] : low[axis];
    return corners;
}

/// The way of one instance over the shutter.
class Way {
public:
    Way(const SceneSnapshot& snapshot, const Scene& scene, std::size_t instance)
        : snapshot_(snapshot), scene_(scene), instance_(instance), source_(snapshot.instances[instance]) {
        const glm::dmat4 first = interpolate(snapshot.motion, instance, 0);
        scale_ = std::max({glm::length(glm::dvec3(first[0])), glm::length(glm::dvec3(first[1])), glm::length(glm::dvec3(first[2]))});
        place_ = glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(first[3])), glm::dvec3(scale_));
    }

    /// Where the bent mesh stands: what it moves by keeps coordinates of order 1.
    const glm::dmat4& place() const { return place_; }

    std::shared_ptr<const DeformedMesh> bend() const {
        auto mesh = std::make_shared<DeformedMesh>();
        mesh->geometry = source_.geometry;
        mesh->number = kFirstNumber + source_.id;
        const unsigned steps = count_steps();
        mesh->key_count = steps + 1;
        auto poses = std::make_shared<std::vector<VertexPose>>();
        for (unsigned k = 0; k <= steps; ++k) {
            const double time = static_cast<double>(k) / steps;
            poses->emplace_back(DeformationPose{{glm::inverse(place_) * interpolate(snapshot_.motion, instance_, time)}, {}}, Skinning::linear);
            add_key(*mesh, poses->back(), time);
        }
        // What bends already has vertices that no pose of ours makes.
        if (!bent()) mesh->poses = poses;
        mesh->version = version_of(*poses);
        return mesh;
    }

private:
    const DeformedMesh* bent() const { return source_.deformed < 0 ? nullptr : snapshot_.deformed[static_cast<std::size_t>(source_.deformed)].get(); }

    Corners corners() const {
        if (const DeformedMesh* mesh = bent()) return corners_of(mesh->vertices, [](const kernels::Vertex& v) { return v.position; });
        return corners_of(scene_.geometries[source_.geometry].positions, [](const kernels::Vec3f& p) { return p; });
    }

    unsigned count_steps() const {
        const Corners all = corners();
        const unsigned given = snapshot_.motion.headers[instance_].frame_count - 1;
        unsigned steps = given;
        // A mesh that bends anyway has keys of its own, which must fall on the grid.
        if (const DeformedMesh* mesh = bent())
            while (steps % std::max(mesh->key_count - 1, 1u) != 0) steps += given;
        while (2 * steps <= kMostSteps && error_px(all, steps) > kShearedMotionError_px) steps *= 2;
        return steps;
    }

    /// Largest distance of a corner's straight way from its true one, in the middle of every step.
    double error_px(const Corners& all, unsigned steps) const {
        const kernels::CameraKey& eye = snapshot_.camera_keys.front();
        const glm::dvec3 from(eye.position.x, eye.position.y, eye.position.z);
        double worst = 0;
        for (unsigned k = 0; k < steps; ++k) {
            const glm::dmat4 a = at(k, steps), b = at(k + 1, steps), middle = at(k + 0.5, steps);
            for (const glm::dvec3& corner : all) {
                const glm::dvec4 c(corner, 1);
                const glm::dvec3 is(middle * c);
                // Beside the camera there is no scale of a pixel: as if it were a tenth of its size away.
                const double distance = snapshot_.camera.orthographic ? 1 : std::max(glm::length(is - from), 0.1 * scale_);
                const double pixel = 2.0 * eye.tan_half_height / snapshot_.settings.height * distance;
                worst = std::max(worst, glm::length(is - 0.5 * (glm::dvec3(a * c) + glm::dvec3(b * c))) / pixel);
            }
        }
        return worst;
    }
    glm::dmat4 at(double step, unsigned steps) const { return interpolate(snapshot_.motion, instance_, step / steps); }

    void add_key(DeformedMesh& mesh, const VertexPose& pose, double time) const {
        const GeometryData& geometry = scene_.geometries[source_.geometry];
        std::vector<kernels::Vertex> vertices(geometry.positions.size());
        std::vector<kernels::Vec4f> tangents(geometry.tangents.size());
        std::optional<GeometryData> shape;
        if (bent()) shape = shape_at(*bent(), geometry, time);
        deform_vertices(shape ? *shape : geometry, pose, vertices, tangents);
        mesh.vertices.insert(mesh.vertices.end(), vertices.begin(), vertices.end());
        mesh.tangents.insert(mesh.tangents.end(), tangents.begin(), tangents.end());
    }

    /// A bent mesh at a time, as a rigid one.
    static GeometryData shape_at(const DeformedMesh& mesh, const GeometryData& source, double time) {
        GeometryData shape;
        shape.uv[0] = source.uv[0];
        const std::size_t count = source.positions.size();
        const double at = time * (mesh.key_count - 1);
        const auto key = static_cast<std::size_t>(std::min(at, std::max(mesh.key_count - 2.0, 0.0)));
        const auto u = static_cast<float>(at - static_cast<double>(key));
        const std::size_t a = key * count, b = mesh.key_count > 1 ? a + count : a;
        for (std::size_t v = 0; v < count; ++v) {
            const kernels::Vertex &from = mesh.vertices[a + v], &to = mesh.vertices[b + v];
            shape.positions.push_back(from.position * (1 - u) + to.position * u);
            if (!source.normals.empty()) shape.normals.push_back(from.normal * (1 - u) + to.normal * u);
        }
        for (std::size_t v = 0; v < source.tangents.size(); ++v) {
            const kernels::Vec4f &from = mesh.tangents[a + v], &to = mesh.tangents[b + v];
            shape.tangents.push_back({from.x * (1 - u) + to.x * u, from.y * (1 - u) + to.y * u, from.z * (1 - u) + to.z * u, from.w});
        }
        return shape;
    }

    std::uint64_t version_of(const std::vector<VertexPose>& poses) const {
        Hasher hasher;
        hasher.add(static_cast<std::int64_t>(bent() ? bent()->version : 0));
        hasher.add(static_cast<std::int64_t>(bent() ? bent()->number : 0));
        for (const VertexPose& pose : poses)
            for (int i = 0; i < 12; ++i) hasher.add(static_cast<double>((&pose.matrices()[0].m[0][0])[i]));
        return hasher.finish().low;
    }

    const SceneSnapshot& snapshot_;
    const Scene& scene_;
    std::size_t instance_;
    const SnapshotInstance& source_;
    glm::dmat4 place_;
    double scale_ = 1;
};

/// Puts a still frame in the place of an instance's own.
void stand(MotionFrames& motion, std::size_t instance, const glm::dmat4& place) {
    motion.headers.edit(instance) = {static_cast<unsigned>(motion.matrices.size()), 1};
    motion.matrices.push_back(to_matrix(decompose(place), 0));
}

}  // namespace

std::optional<SceneSnapshot> bend_sheared_motion(const SceneSnapshot& snapshot, const Scene& scene) {
    std::optional<SceneSnapshot> bent;
    // What snapshots share stands still.
    for (std::size_t i = snapshot.instances.shared_size(); i < snapshot.instances.size(); ++i) {
        const SnapshotInstance& instance = snapshot.instances[i];
        if (instance.mask == 0 || scene.geometries[instance.geometry].indices.empty() || !is_sheared_motion(snapshot.motion, i)) continue;
        if (!bent) bent = snapshot;
        const Way way(snapshot, scene, i);
        bent->instances.edit(i).deformed = static_cast<int>(bent->deformed.size());
        bent->deformed.push_back(way.bend());
        stand(bent->motion, i, way.place());
        if (!bent->previous) continue;
        const std::vector<kernels::Vec3f>& rest = scene.geometries[instance.geometry].positions;
        bent->previous->deformed.push_back(instance.deformed < 0 ? rest : snapshot.previous->deformed[static_cast<std::size_t>(instance.deformed)]);
    }
    return bent;
}

}  // namespace kadr
