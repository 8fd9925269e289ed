#include "frame/skinning.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "frame/decompose.h"

namespace kadr {

namespace {

using kernels::Affine;
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
    DualQuaternionJoint joint;
    const glm::dquat r = parts.rotation;
    const glm::dquat d = glm::dquat(0, parts.translation.x, parts.translation.y, parts.translation.z) * r * 0.5;
    joint.motion = {static_cast<float>(r.x), static_cast<float>(r.y), static_cast<float>(r.z), static_cast<float>(r.w),
                    static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), static_cast<float>(d.w)};
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

Vec3f point(const Affine& a, Vec3f p) {
    return {a.m[0][0] * p.x + a.m[0][1] * p.y + a.m[0][2] * p.z + a.m[0][3], a.m[1][0] * p.x + a.m[1][1] * p.y + a.m[1][2] * p.z + a.m[1][3],
            a.m[2][0] * p.x + a.m[2][1] * p.y + a.m[2][2] * p.z + a.m[2][3]};
}
Vec3f vector(const Affine& a, Vec3f p) {
    return {a.m[0][0] * p.x + a.m[0][1] * p.y + a.m[0][2] * p.z, a.m[1][0] * p.x + a.m[1][1] * p.y + a.m[1][2] * p.z,
            a.m[2][0] * p.x + a.m[2][1] * p.y + a.m[2][2] * p.z};
}
/// By the cofactors: the inverse transpose times the determinant, right wherever there is an inverse.
Vec3f normal(const Affine& a, Vec3f n) {
    const Vec3f r0{a.m[0][0], a.m[0][1], a.m[0][2]}, r1{a.m[1][0], a.m[1][1], a.m[1][2]}, r2{a.m[2][0], a.m[2][1], a.m[2][2]};
    const Vec3f c0 = cross(r1, r2);
    const Vec3f result{dot(c0, n), dot(cross(r2, r0), n), dot(cross(r0, r1), n)};
    return dot(c0, r0) < 0 ? result * -1.0f : result;
}
Vec3f unit_or_zero(Vec3f v) {
    const float squared = dot(v, v);
    return squared > 1e-30f ? v * (1.0f / std::sqrt(squared)) : Vec3f{0, 0, 0};
}
bool mirrors(const Affine& a) { return dot(cross(Vec3f{a.m[0][0], a.m[0][1], a.m[0][2]}, Vec3f{a.m[1][0], a.m[1][1], a.m[1][2]}), Vec3f{a.m[2][0], a.m[2][1], a.m[2][2]}) < 0; }

/// The mean of the joints' matrices.
Affine blend(std::span<const Affine> joints, const std::uint16_t* joint, const float* weight, int slots) {
    Affine sum{};
    for (int slot = 0; slot < slots && weight[slot] > 0; ++slot) {
        const float* from = &joints[joint[slot]].m[0][0];
        float* to = &sum.m[0][0];
        for (int i = 0; i < 12; ++i) to[i] += weight[slot] * from[i];  // three vectors of four
    }
    return sum;
}

/// A blended rigid motion as a matrix.
Affine rigid_blend(std::span<const DualQuaternionJoint> joints, const std::uint16_t* joint, const float* weight, int slots) {
    float q[8] = {};
    const DualQuaternionJoint& pivot = joints[joint[0]];
    for (int slot = 0; slot < slots && weight[slot] > 0; ++slot) {
        const DualQuaternionJoint& from = joints[joint[slot]];
        float cosine = 0;
        for (int i = 0; i < 4; ++i) cosine += pivot.motion[static_cast<std::size_t>(i)] * from.motion[static_cast<std::size_t>(i)];
        const float w = cosine < 0 ? -weight[slot] : weight[slot];  // q and -q are one rotation: take the nearer
        for (int i = 0; i < 8; ++i) q[i] += w * from.motion[static_cast<std::size_t>(i)];
    }
    const float scale = 1.0f / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (float& value : q) value *= scale;
    const float x = q[0], y = q[1], z = q[2], w = q[3];
    const Vec3f r{x, y, z}, d{q[4], q[5], q[6]};
    const Vec3f t = (d * w - r * q[7] + cross(r, d)) * 2.0f;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t.x},
             {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t.y},
             {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t.z}}};
}

/// A blended rigid motion, with the blended stretch before it.
Affine stretched_blend(std::span<const DualQuaternionJoint> joints, const std::uint16_t* joint, const float* weight, int slots) {
    Affine stretch{};
    for (int slot = 0; slot < slots && weight[slot] > 0; ++slot)
        for (int i = 0; i < 12; ++i) (&stretch.m[0][0])[i] += weight[slot] * (&joints[joint[slot]].stretch.m[0][0])[i];
    const Affine rigid = rigid_blend(joints, joint, weight, slots);
    Affine a;
    for (int row = 0; row < 3; ++row) {
        const float* r = rigid.m[row];
        for (int c = 0; c < 3; ++c) a.m[row][c] = r[0] * stretch.m[0][c] + r[1] * stretch.m[1][c] + r[2] * stretch.m[2][c];
        a.m[row][3] = r[3];
    }
    return a;
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
            return (pose_.stretches() ? stretched_blend : rigid_blend)(pose_.dual_quaternions(), &skin_.joints[first], &skin_.weights[first], skin_.per_vertex);
        return blend(pose_.matrices(), &skin_.joints[first], &skin_.weights[first], skin_.per_vertex);
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
        Vertex& out = vertices[v];
        out.position = point(a, positions[v - begin]);
        out.normal = normals ? unit_or_zero(normal(a, normals[v - begin])) : Vec3f{0, 0, 0};
        out.uv = g.uv[0].empty() ? kernels::Vec2f{0, 0} : g.uv[0][v];
        if (tangents.empty()) continue;
        const Vec4f t = g.tangents[v];
        const Vec3f d = unit_or_zero(vector(a, morphs ? block.tangents[v - begin] : Vec3f{t.x, t.y, t.z}));
        tangents[v] = {d.x, d.y, d.z, mirrors(a) ? -t.w : t.w};
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
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = point(carrier.at(begin + i), from[i]);
}

}  // namespace kadr
