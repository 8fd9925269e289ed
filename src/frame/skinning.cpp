#include "frame/skinning.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "frame/decompose.h"

namespace kadr {

namespace {

namespace skinning = kernels::skinning;
using kernels::Affine;
using kernels::DualQuaternionJoint;
using kernels::Vec3f;
using kernels::Vec4f;
using kernels::Vertex;

constexpr std::size_t kBlock = 2048;  // vertices: their morphed copies stay in the first cache levels

Affine to_affine(const glm::dmat4& m) {
    Affine a;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) a.m[row][column] = static_cast<float>(m[column][row]);
    return a;
}

DualQuaternionJoint to_dual_quaternion(const glm::dmat4& m) {
    Decomposition parts = decompose(m);
    DualQuaternionJoint joint{};
    const glm::dquat r = parts.rotation;
    const glm::dquat d = glm::dquat(0, parts.translation.x, parts.translation.y, parts.translation.z) * r * 0.5;
    const double motion[] = {r.x, r.y, r.z, r.w, d.x, d.y, d.z, d.w};
    for (int i = 0; i < 8; ++i) joint.motion[i] = static_cast<float>(motion[i]);
    parts.rotation = glm::dquat(1, 0, 0, 0);
    parts.translation = glm::dvec3(0);
    joint.stretch = to_affine(compose(parts));
    return joint;
}

/// Whether a stretch is the identity but for the rounding of its numbers.
bool is_identity(const Affine& stretch) {
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            if (!(std::abs(stretch.m[row][column] - (row == column ? 1.0f : 0.0f)) <= 1e-7f)) return false;
    return true;
}

/// Some vertices of a mesh after its morph targets.
struct Morphed {
    std::vector<Vec3f> positions, normals, tangents;
};

template <class V>
void add(std::vector<Vec3f>& to, const std::vector<V>& differences, const MorphTarget& target, std::size_t first, std::size_t last, std::size_t begin, float weight) {
    if (to.empty() || differences.empty()) return;
    for (std::size_t i = first; i < last; ++i) to[target.vertices[i] - begin] = to[target.vertices[i] - begin] + differences[i] * weight;
}

enum class Morphs { positions, with_normals, with_tangents };

Morphed morph(const GeometryData& g, std::span<const float> weights, std::size_t begin, std::size_t end, Morphs what) {
    Morphed block;
    const auto slice = [&](const std::vector<Vec3f>& all) { return all.empty() ? std::vector<Vec3f>{} : std::vector<Vec3f>(all.begin() + static_cast<std::ptrdiff_t>(begin), all.begin() + static_cast<std::ptrdiff_t>(end)); };
    block.positions = slice(g.positions);
    if (what != Morphs::positions) block.normals = slice(g.normals);
    for (std::size_t v = begin; what == Morphs::with_tangents && v < end; ++v) block.tangents.push_back({g.tangents[v].x, g.tangents[v].y, g.tangents[v].z});
    for (std::size_t t = 0; t < std::min(weights.size(), g.targets.size()); ++t) {
        if (weights[t] == 0) continue;
        const MorphTarget& target = g.targets[t];
        const auto at = [&](std::size_t vertex) { return static_cast<std::size_t>(std::lower_bound(target.vertices.begin(), target.vertices.end(), vertex) - target.vertices.begin()); };
        const std::size_t first = at(begin), last = at(end);
        add(block.positions, target.positions, target, first, last, begin, weights[t]);
        add(block.normals, target.normals, target, first, last, begin, weights[t]);
        add(block.tangents, target.tangents, target, first, last, begin, weights[t]);
    }
    return block;
}

bool weighs(const VertexPose& pose) {
    return std::any_of(pose.weights().begin(), pose.weights().end(), [](float w) { return w != 0; });
}

/// The matrix that carries each vertex.
class Carrier {
public:
    Carrier(const GeometryData& g, const VertexPose& pose) : skin_(g.skin), pose_(pose), single_(pose.matrices().size() == 1 || g.skin.per_vertex == 0) {}
    Affine at(std::size_t vertex) const {
        if (single_) return pose_.matrices()[0];
        const std::size_t first = vertex * static_cast<std::size_t>(skin_.per_vertex);
        if (pose_.skinning() == Skinning::dual_quaternion)
            return pose_.stretches() ? skinning::stretched_blend(pose_.dual_quaternions().data(), &skin_.joints[first], &skin_.weights[first], skin_.per_vertex)
                                     : skinning::rigid_blend(pose_.dual_quaternions().data(), &skin_.joints[first], &skin_.weights[first], skin_.per_vertex);
        return skinning::blend(pose_.matrices().data(), &skin_.joints[first], &skin_.weights[first], skin_.per_vertex);
    }

private:
    const SkinWeights& skin_;
    const VertexPose& pose_;
    bool single_;
};

void deform_block(const GeometryData& g, const VertexPose& pose, std::size_t begin, std::size_t end, std::span<Vertex> vertices, std::span<Vec4f> tangents) {
    const Carrier carrier(g, pose);
    const bool morphs = weighs(pose);
    const Morphed block = morphs ? morph(g, pose.weights(), begin, end, tangents.empty() ? Morphs::with_normals : Morphs::with_tangents) : Morphed{};
    const Vec3f* positions = morphs ? block.positions.data() : g.positions.data() + begin;
    const Vec3f* normals = g.normals.empty() ? nullptr : morphs ? block.normals.data() : g.normals.data() + begin;
    for (std::size_t v = begin; v < end; ++v) {
        const Affine a = carrier.at(v);
        vertices[v] = skinning::carried_vertex(a, positions[v - begin], normals ? normals[v - begin] : Vec3f{0, 0, 0}, g.uv[0].empty() ? kernels::Vec2f{0, 0} : g.uv[0][v]);
        if (tangents.empty()) continue;
        const Vec4f t = g.tangents[v];
        tangents[v] = skinning::carried_tangent(a, morphs ? block.tangents[v - begin] : Vec3f{t.x, t.y, t.z}, t.w);
    }
}

}  // namespace

bool DeformationPose::finite() const {
    return std::all_of(joints.begin(), joints.end(), is_finite) && std::all_of(weights.begin(), weights.end(), [](double w) { return std::isfinite(w); });
}

VertexPose::VertexPose(const DeformationPose& pose, Skinning skinning) : skinning_(skinning) {
    for (const glm::dmat4& m : pose.joints) {
        matrices_.push_back(to_affine(m));
        if (skinning == Skinning::dual_quaternion) dual_quaternions_.push_back(to_dual_quaternion(m));
    }
    for (const double weight : pose.weights) weights_.push_back(static_cast<float>(weight));
    stretches_ = !std::all_of(dual_quaternions_.begin(), dual_quaternions_.end(), [](const DualQuaternionJoint& joint) { return is_identity(joint.stretch); });
}

void deform_vertices(const GeometryData& geometry, const VertexPose& pose, std::span<Vertex> vertices, std::span<Vec4f> tangents) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, geometry.positions.size(), kBlock), [&](const auto& range) {
        for (std::size_t begin = range.begin(); begin < range.end(); begin += kBlock)
            deform_block(geometry, pose, begin, std::min(begin + kBlock, range.end()), vertices, tangents);
    });
}

void deform_positions(const GeometryData& geometry, const VertexPose& pose, std::size_t begin, std::span<Vec3f> positions) {
    const Carrier carrier(geometry, pose);
    const Morphed block = weighs(pose) ? morph(geometry, pose.weights(), begin, begin + positions.size(), Morphs::positions) : Morphed{};
    const Vec3f* from = block.positions.empty() ? geometry.positions.data() + begin : block.positions.data();
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = skinning::point(carrier.at(begin + i), from[i]);
}

}  // namespace kadr
