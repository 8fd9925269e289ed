// How joints carry vertices: one source for the processor, which bends meshes in blocks, and the GPU, which bends them a
// thread a vertex. The order of additions is part of it: both leave the same bits.
//
// Source: glTF 2.0, 3.7.3.3; Kavan et al., "Geometric Skinning with Approximate Dual Quaternion Blending", 2008, 4
// (antipodality: 4.1).
#pragma once

#include "kernels/math/vec.h"
#include "kernels/scene/scene_types.h"
#include "kernels/scene/scene_view.h"

namespace kadr::kernels {

/// A rigid motion as a unit dual quaternion, after a stretch (scale and shear, linear).
struct DualQuaternionJoint {
    Affine stretch;
    float motion[8];  ///< real part x y z w, dual part x y z w
};
static_assert(sizeof(DualQuaternionJoint) == 80, "copied to the GPU");

namespace skinning {

SHARED_FN Vec3f point(const Affine& a, Vec3f p) {
    return {a.m[0][0] * p.x + a.m[0][1] * p.y + a.m[0][2] * p.z + a.m[0][3],
            a.m[1][0] * p.x + a.m[1][1] * p.y + a.m[1][2] * p.z + a.m[1][3],
            a.m[2][0] * p.x + a.m[2][1] * p.y + a.m[2][2] * p.z + a.m[2][3]};
}
SHARED_FN Vec3f vector(const Affine& a, Vec3f p) {
    return {a.m[0][0] * p.x + a.m[0][1] * p.y + a.m[0][2] * p.z, a.m[1][0] * p.x + a.m[1][1] * p.y + a.m[1][2] * p.z,
            a.m[2][0] * p.x + a.m[2][1] * p.y + a.m[2][2] * p.z};
}
SHARED_FN Vec3f row(const Affine& a, int i) { return {a.m[i][0], a.m[i][1], a.m[i][2]}; }
/// By the cofactors: the inverse transpose times the determinant, right wherever there is an inverse.
SHARED_FN Vec3f normal(const Affine& a, Vec3f n) {
    const Vec3f r0 = row(a, 0), r1 = row(a, 1), r2 = row(a, 2);
    const Vec3f c0 = cross(r1, r2);
    const Vec3f result{dot(c0, n), dot(cross(r2, r0), n), dot(cross(r0, r1), n)};
    return dot(c0, r0) < 0 ? result * -1.0f : result;
}
SHARED_FN Vec3f unit_or_zero(Vec3f v) {
    const float squared = dot(v, v);
    return squared > 1e-30f ? v * (1.0f / sqrt(squared)) : Vec3f{0, 0, 0};
}
SHARED_FN bool mirrors(const Affine& a) { return dot(cross(row(a, 0), row(a, 1)), row(a, 2)) < 0; }

/// The mean of the joints' matrices.
/// @param joint, weight  [slot] of the vertex; the first weight of 0 ends them
SHARED_FN Affine blend(const Affine* joints, const unsigned short* joint, const float* weight, int slots) {
    Affine sum{};
    for (int slot = 0; slot < slots && weight[slot] > 0; ++slot) {
        const float* from = &joints[joint[slot]].m[0][0];
        float* to = &sum.m[0][0];
        for (int i = 0; i < 12; ++i) to[i] += weight[slot] * from[i];  // three vectors of four
    }
    return sum;
}

/// A blended rigid motion as a matrix.
SHARED_FN Affine rigid_blend(const DualQuaternionJoint* joints, const unsigned short* joint, const float* weight,
                             int slots) {
    float q[8] = {};
    const DualQuaternionJoint& pivot = joints[joint[0]];
    for (int slot = 0; slot < slots && weight[slot] > 0; ++slot) {
        const DualQuaternionJoint& from = joints[joint[slot]];
        float cosine = 0;
        for (int i = 0; i < 4; ++i) cosine += pivot.motion[i] * from.motion[i];
        const float w = cosine < 0 ? -weight[slot] : weight[slot];  // q and -q are one rotation: take the nearer
        for (int i = 0; i < 8; ++i) q[i] += w * from.motion[i];
    }
    const float scale = 1.0f / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (float& value : q) value *= scale;
    const float x = q[0], y = q[1], z = q[2], w = q[3];
    const Vec3f r{x, y, z}, d{q[4], q[5], q[6]};
    const Vec3f t = (d * w - r * q[7] + cross(r, d)) * 2.0f;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t.x},
             {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t.y},
             {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t.z}}};
}

/// A blended rigid motion, with the blended stretch before it.
SHARED_FN Affine stretched_blend(const DualQuaternionJoint* joints, const unsigned short* joint, const float* weight,
                                 int slots) {
    Affine stretch{};
    for (int slot = 0; slot < slots && weight[slot] > 0; ++slot)
        for (int i = 0; i < 12; ++i)
            (&stretch.m[0][0])[i] += weight[slot] * (&joints[joint[slot]].stretch.m[0][0])[i];
    const Affine rigid = rigid_blend(joints, joint, weight, slots);
    Affine a;
    for (int i = 0; i < 3; ++i) {
        const float* r = rigid.m[i];
        for (int c = 0; c < 3; ++c)
            a.m[i][c] = r[0] * stretch.m[0][c] + r[1] * stretch.m[1][c] + r[2] * stretch.m[2][c];
        a.m[i][3] = r[3];
    }
    return a;
}

/// A morphed vertex, carried. @param normal  zero where the mesh is flat
SHARED_FN Vertex carried_vertex(const Affine& a, Vec3f position, Vec3f n, Vec2f uv) {
    return {point(a, position), unit_or_zero(normal(a, n)), uv};
}
/// A morphed tangent, carried. @param handedness  before; a mirror turns it
SHARED_FN Vec4f carried_tangent(const Affine& a, Vec3f tangent, float handedness) {
    const Vec3f d = unit_or_zero(vector(a, tangent));
    return {d.x, d.y, d.z, mirrors(a) ? -handedness : handedness};
}

}  // namespace skinning
}  // namespace kadr::kernels
