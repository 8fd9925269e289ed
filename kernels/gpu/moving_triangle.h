// Triangles whose corners move while the shutter is open. HIPRT knows triangles that stand still in their mesh's space,
// so these are boxes to it, around all that a triangle passes, and this is what it asks of each.
#pragma once

#include "kernels/scene/motion.h"

namespace kadr::kernels {

/// Where a ray meets a triangle. `u` and `v` weigh corners b and c; distance in units of the ray's direction.
template <class T>
struct TriangleHitOf {
    T u, v, distance;
};
using TriangleHit = TriangleHitOf<float>;

/// Coordinates in a frame in which the ray starts at 0 and runs along +z.
/// Source: Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2-1).
template <class T>
struct RayFrame {
    Vec3<T> origin;
    int longest;  ///< axis along which the ray runs most; becomes z
    T shear_x, shear_y, scale_z;

    SHARED_FN RayFrame(Vec3<T> from, Vec3<T> direction) : origin(from) {
        const T x = abs(direction.x), y = abs(direction.y), z = abs(direction.z);
        longest = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
        const Vec3<T> d = turned(direction);
        scale_z = 1.0f / d.z;
        shear_x = d.x * scale_z;
        shear_y = d.y * scale_z;
    }
    /// The axes in turn, so that the longest is last.
    SHARED_FN Vec3<T> turned(Vec3<T> v) const {
        if (longest == 0) return {v.y, v.z, v.x};
        return longest == 1 ? Vec3<T>{v.z, v.x, v.y} : v;
    }
    SHARED_FN Vec3<T> local(Vec3<T> p) const {
        const Vec3<T> q = turned(p - origin);
        return {q.x - shear_x * q.z, q.y - shear_y * q.z, scale_z * q.z};
    }
};

/// Twice the area between an edge and the ray; the same but for its sign in the triangles on both sides of the edge.
template <class T>
SHARED_FN T edge_function(Vec3<T> from, Vec3<T> to) {
    return from.x * to.y - from.y * to.x;
}

/// From either side; edges and corners belong to their triangles, so that a closed mesh lets no ray through.
template <class T>
SHARED_FN bool intersect_triangle(Vec3<T> origin, Vec3<T> direction, const Vec3<T> (&corners)[3],
                                  Real<T> min_distance, Real<T> max_distance, TriangleHitOf<T>& hit) {
    const RayFrame<T> frame(origin, direction);
    const Vec3<T> a = frame.local(corners[0]), b = frame.local(corners[1]), c = frame.local(corners[2]);
    const T wa = edge_function(c, b), wb = edge_function(a, c), wc = edge_function(b, a);
    if ((wa < 0.0f || wb < 0.0f || wc < 0.0f) && (wa > 0.0f || wb > 0.0f || wc > 0.0f)) return false;
    const T inverse = 1.0f / (wa + wb + wc);  // seen along its plane, the triangle's distance is not a number
    hit.distance = (wa * a.z + wb * b.z + wc * c.z) * inverse;
    hit.u = wb * inverse;
    hit.v = wc * inverse;
    return hit.distance >= min_distance && hit.distance <= max_distance;
}

/// The corners of a triangle at a time of the shutter, in the mesh's coordinates.
SHARED_FN void corners_at(const Geometry& g, unsigned primitive, float time, Vec3f (&corners)[3]) {
    const unsigned* index = g.indices + 3 * static_cast<unsigned long>(primitive);
    const VertexKeys<float> keys = vertex_keys(g, time);
    for (int c = 0; c < 3; ++c) corners[c] = position_at(g, keys, index[c]);
}

}  // namespace kadr::kernels
