#include "frame/deform_fit.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace kadr {

namespace {

constexpr double kBesideCamera = 0.05;  // of the mesh's radius, as for motion frames

double frobenius(const glm::dmat4& m) { return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2])); }

/// How far the morph targets push a vertex at most.
double push_of(const Deformer& deformer, const std::vector<double>& weights) {
    double push = 0;
    for (std::size_t t = 0; t < std::min(weights.size(), deformer.target_sizes.size()); ++t) push += std::abs(weights[t]) * deformer.target_sizes[t];
    return push;
}

glm::dvec3 corner_of(const JointBox& box, int corner, double push) {
    glm::dvec3 at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = corner >> axis & 1 ? box.high[axis] + push : box.low[axis] - push;
    return at;
}

/// Three poses of a segment: its ends and one between them.
struct Between {
    const DeformationPose &a, &b, &is;
    double u;
};

/// Bound of what the linear way misses in deformed coordinates, from the joints' motion. With morph targets that weigh m
/// the vertex is M (p + sum m d): the way from M0 (p + sum m0 d) to M1 (p + sum m1 d) misses
/// (M - lerp M)(p + sum m d), and for every target (e M0 + u b (M1 - M0)) d with e = m - lerp m, b = m - m1.
double joint_deviation(const Deformer& deformer, const Between& at, const glm::dmat4& world) {
    const double push = push_of(deformer, at.is.weights);
    double joints = 0, size = 0, turn = 0;
    for (const JointBox& box : deformer.boxes) {
        const glm::dmat4 &m0 = at.a.joints[box.joint], &m1 = at.b.joints[box.joint];
        const glm::dmat4 missed = world * (at.is.joints[box.joint] - (m0 * (1 - at.u) + m1 * at.u));
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 c = corner_of(box, corner, push);
            joints = std::max(joints, glm::length(glm::dvec3(missed * glm::dvec4(c, 1))));
        }
        size = std::max(size, frobenius(world * m0));
        turn = std::max(turn, frobenius(world * (m1 - m0)));
    }
    double morphs = 0;
    for (std::size_t t = 0; t < std::min(at.is.weights.size(), deformer.target_sizes.size()); ++t) {
        const double e = at.is.weights[t] - std::lerp(at.a.weights[t], at.b.weights[t], at.u), b = at.is.weights[t] - at.b.weights[t];
        morphs += deformer.target_sizes[t] * (std::abs(e) * size + at.u * std::abs(b) * turn);
    }
    return joints + morphs;
}

/// Pixels of one unit of the world where the mesh is nearest to the camera: linear skinning keeps vertices within the
/// hull of the corners, and depth is linear.
double pixels_a_unit(const Deformer& deformer, const DeformationPose& pose, const glm::dmat4& world, const PixelScale& scale) {
    std::vector<glm::dvec3> corners;
    add_corners(deformer, pose, corners);
    const double nearest = std::max(kBesideCamera * frobenius(world), 1e-30);
    double worst = 0;
    for (const glm::dvec3& corner : corners) worst = std::max(worst, scale.pixels(1, glm::dvec3(world * glm::dvec4(corner, 1)), nearest));
    return worst;
}

using Vertices = std::vector<kernels::Vertex>;

Vertices vertices_of(const GeometryData& geometry, const Deformer& deformer, const DeformationPose& pose) {
    Vertices vertices(geometry.positions.size());
    deform_vertices(geometry, VertexPose(pose, deformer.skinning), vertices, {});
    return vertices;
}

glm::dvec3 to_double(kernels::Vec3f v) { return {v.x, v.y, v.z}; }

double vertex_pixels(const Vertices& a, const Vertices& b, const Vertices& is, double u, const glm::dmat4& world, const PixelScale& scale) {
    const double nearest = std::max(kBesideCamera * frobenius(world), 1e-30);
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, is.size(), 4096), 0.0,
        [&](const auto& range, double worst) {
            for (std::size_t v = range.begin(); v < range.end(); ++v) {
                const glm::dvec3 wanted = to_double(is[v].position);
                const glm::dvec3 missed = wanted - glm::mix(to_double(a[v].position), to_double(b[v].position), u);
                worst = std::max(worst, scale.pixels(glm::length(glm::dmat3(world) * missed), glm::dvec3(world * glm::dvec4(wanted, 1)), nearest));
            }
            return worst;
        },
        [](double a_px, double b_px) { return std::max(a_px, b_px); });
}

double vertex_error_px(const GeometryData& geometry, const Deformer& deformer, std::span<const DeformationPose> poses, const DeformationView& view) {
    double worst = 0;
    Vertices a = vertices_of(geometry, deformer, poses[0]);
    for (std::size_t from = 0; from + 4 < poses.size() && worst <= view.enough_px; from += 4) {
        Vertices b = vertices_of(geometry, deformer, poses[from + 4]);
        for (std::size_t i = 1; i < 4; ++i) {
            const Vertices is = vertices_of(geometry, deformer, poses[from + i]);
            for (const glm::dmat4& world : view.world_from_deformed)
                worst = std::max(worst, vertex_pixels(a, b, is, 0.25 * static_cast<double>(i), world, view.scales[from + i]));
        }
        a = std::move(b);
    }
    return worst;
}

double joint_error_px(const Deformer& deformer, std::span<const DeformationPose> poses, const DeformationView& view) {
    double worst = 0;
    for (std::size_t i = 0; i < poses.size() && worst <= view.enough_px; ++i) {
        const std::size_t from = i / 4 * 4;
        if (i == from) continue;
        const Between between{poses[from], poses[from + 4], poses[i], 0.25 * static_cast<double>(i - from)};
        for (const glm::dmat4& world : view.world_from_deformed)
            worst = std::max(worst, joint_deviation(deformer, between, world) * pixels_a_unit(deformer, poses[i], world, view.scales[i]));
    }
    return worst;
}

bool nearly_same(const glm::dmat4& a, const glm::dmat4& b) {
    const double size = 1e-13 * (frobenius(a) + glm::length(glm::dvec3(a[3])));
    for (int column = 0; column < 4; ++column)
        if (!(glm::length(a[column] - b[column]) <= size)) return false;
    return true;
}

}  // namespace

double deformation_error_px(const GeometryData& geometry, const Deformer& deformer, std::span<const DeformationPose> poses, const DeformationView& view) {
    if (deformer.skinning == Skinning::dual_quaternion && deformer.skeleton) return vertex_error_px(geometry, deformer, poses, view);
    return joint_error_px(deformer, poses, view);
}

bool nearly_same(const DeformationPose& a, const DeformationPose& b) {
    for (std::size_t j = 0; j < a.joints.size(); ++j)
        if (!nearly_same(a.joints[j], b.joints[j])) return false;
    for (std::size_t t = 0; t < a.weights.size(); ++t)
        if (!(std::abs(a.weights[t] - b.weights[t]) <= 1e-13)) return false;
    return true;
}

void add_corners(const Deformer& deformer, const DeformationPose& pose, std::vector<glm::dvec3>& corners) {
    const double push = push_of(deformer, pose.weights);
    for (const JointBox& box : deformer.boxes)
        for (int corner = 0; corner < 8; ++corner) corners.emplace_back(pose.joints[box.joint] * glm::dvec4(corner_of(box, corner, push), 1));
}

}  // namespace kadr
