#include "frame/deform_fit.h"

#include <algorithm>
#include <atomic>
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

constexpr std::size_t kBlock = 2048;  // vertices: their positions in five poses stay in the cache

using Positions = std::vector<kernels::Vec3f>;

glm::dvec3 to_double(kernels::Vec3f v) { return {v.x, v.y, v.z}; }

/// The way of a block of vertices from one key to the next, against their places at one time between.
class BlockError {
public:
    BlockError(const DeformationView& view) : view_(view) {}
    /// A bound by the block's box first, for a few operations a vertex; the vertices one by one where that is too much.
    double pixels(const Positions& a, const Positions& b, const Positions& is, std::size_t pose) const {
        const float u = 0.25f * static_cast<float>(pose % 4);
        glm::vec3 low(INFINITY), high(-INFINITY);
        float missed = 0;
        for (std::size_t v = 0; v < is.size(); ++v) {
            const kernels::Vec3f apart = is[v] - (a[v] * (1 - u) + b[v] * u);
            missed = std::max(missed, dot(apart, apart));
            const glm::vec3 at(is[v].x, is[v].y, is[v].z);
            low = glm::min(low, at), high = glm::max(high, at);
        }
        double worst = 0;
        for (const glm::dmat4& world : view_.world_from_deformed) {
            const double bound = bound_px(std::sqrt(missed), low, high, world, view_.scales[pose]);
            const bool suffices = bound <= view_.enough_px && std::isfinite(view_.enough_px);  // else the figure itself is wanted
            worst = std::max(worst, suffices ? bound : exact_px(a, b, is, u, world, view_.scales[pose]));
        }
        return worst;
    }

private:
    static double nearest(const glm::dmat4& world) { return std::max(kBesideCamera * frobenius(world), 1e-30); }
    static double bound_px(double missed, const glm::dvec3& low, const glm::dvec3& high, const glm::dmat4& world, const PixelScale& scale) {
        const glm::dvec3 centre = glm::dvec3(world * glm::dvec4(0.5 * (low + high), 1));
        return scale.most_pixels(frobenius(world) * missed, centre, frobenius(world) * 0.5 * glm::length(high - low), nearest(world));
    }
    static double exact_px(const Positions& a, const Positions& b, const Positions& is, double u, const glm::dmat4& world, const PixelScale& scale) {
        double worst = 0;
        for (std::size_t v = 0; v < is.size(); ++v) {
            const glm::dvec3 wanted = to_double(is[v]), missed = wanted - glm::mix(to_double(a[v]), to_double(b[v]), u);
            worst = std::max(worst, scale.pixels(glm::length(glm::dmat3(world) * missed), glm::dvec3(world * glm::dvec4(wanted, 1)), nearest(world)));
        }
        return worst;
    }

    const DeformationView& view_;
};

double block_error_px(const GeometryData& geometry, std::span<const VertexPose> poses, std::size_t begin, std::size_t end, const DeformationView& view) {
    const BlockError error(view);
    Positions a(end - begin), b(end - begin), is(end - begin);
    deform_positions(geometry, poses[0], begin, a);
    double worst = 0;
    for (std::size_t from = 0; from + 4 < poses.size() && worst <= view.enough_px; from += 4, std::swap(a, b)) {
        deform_positions(geometry, poses[from + 4], begin, b);
        for (std::size_t i = from + 1; i < from + 4 && worst <= view.enough_px; ++i) {
            deform_positions(geometry, poses[i], begin, is);
            worst = std::max(worst, error.pixels(a, b, is, i));
        }
    }
    return worst;
}

double vertex_error_px(const GeometryData& geometry, const Deformer& deformer, std::span<const DeformationPose> poses, const DeformationView& view) {
    std::vector<VertexPose> vertex_poses;
    for (const DeformationPose& pose : poses) vertex_poses.emplace_back(pose, deformer.skinning);
    std::atomic<bool> enough = false;
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, geometry.positions.size(), kBlock), 0.0,
        [&](const auto& range, double worst) {
            for (std::size_t begin = range.begin(); begin < range.end() && !enough; begin += kBlock) {
                worst = std::max(worst, block_error_px(geometry, vertex_poses, begin, std::min(begin + kBlock, range.end()), view));
                if (worst > view.enough_px) enough = true;
            }
            return worst;
        },
        [](double a_px, double b_px) { return std::max(a_px, b_px); });
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
