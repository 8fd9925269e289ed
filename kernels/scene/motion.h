// World transforms of moving instances at one time of the shutter; lane by lane, since every lane has its own instance.
#pragma once

#include "kernels/math/wide.h"
#include "kernels/scene/scene_view.h"

namespace kadr::kernels {

/// Weights of slerp between unit quaternions with cosine c >= 0 at t, accurate to 1e-6 for steps of up to 90 degrees.
template <class T>
SHARED_FN void slerp_weights(T c, T t, T& w0, T& w1) {
    const T angle = acos(min(c, T(1.0f)));
    if (angle < 1e-3f) {  // sin(x) = x to the last bit but one
        w0 = 1.0f - t;
        w1 = t;
        return;
    }
    T s0, s1, s, unused;
    sincos_2pi((1.0f - t) * angle * (0.5f * kInvPi), s0, unused);
    sincos_2pi(t * angle * (0.5f * kInvPi), s1, unused);
    sincos_2pi(angle * (0.5f * kInvPi), s, unused);
    w0 = s0 / s;
    w1 = s1 / s;
}

/// translation * rotation * shear * scale as a matrix.
template <class T>
SHARED_FN AffineOf<T> compose(const TransformKeyOf<T>& k) {
    const T x = k.rotation[0], y = k.rotation[1], z = k.rotation[2], w = k.rotation[3];
    const T r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    AffineOf<T> a;
    for (int i = 0; i < 3; ++i) {
        a.m[i][0] = r[i][0] * k.scale[0];
        a.m[i][1] = r[i][0] * k.shear[0] + r[i][1] * k.scale[1];
        a.m[i][2] = r[i][0] * k.shear[1] + r[i][1] * k.shear[2] + r[i][2] * k.scale[2];
        a.m[i][3] = k.translation[i];
    }
    return a;
}

template <class T>
SHARED_FN Vec3<T> vector_by(const AffineOf<T>& a, Vec3<T> v) {
    return {a.m[0][0] * v.x + a.m[0][1] * v.y + a.m[0][2] * v.z, a.m[1][0] * v.x + a.m[1][1] * v.y + a.m[1][2] * v.z,
            a.m[2][0] * v.x + a.m[2][1] * v.y + a.m[2][2] * v.z};
}
template <class T>
SHARED_FN Vec3<T> point_by(const AffineOf<T>& a, Vec3<T> p) {
    return {a.m[0][0] * p.x + a.m[0][1] * p.y + a.m[0][2] * p.z + a.m[0][3],
            a.m[1][0] * p.x + a.m[1][1] * p.y + a.m[1][2] * p.z + a.m[1][3],
            a.m[2][0] * p.x + a.m[2][1] * p.y + a.m[2][2] * p.z + a.m[2][3]};
}

/// The transform between two keys.
template <class T>
SHARED_FN TransformKeyOf<T> interpolate(const TransformKeyOf<T>& a, const TransformKeyOf<T>& b, T t) {
    TransformKeyOf<T> k;
    for (int i = 0; i < 3; ++i) {
        k.translation[i] = lerp(a.translation[i], b.translation[i], t);
        k.scale[i] = lerp(a.scale[i], b.scale[i], t);
        k.shear[i] = lerp(a.shear[i], b.shear[i], t);
    }
    T c = 0;
    for (int i = 0; i < 4; ++i) c += a.rotation[i] * b.rotation[i];
    const T sign = c < 0 ? -1.0f : 1.0f;  // q and -q are the same rotation: take the shorter arc
    T w0, w1;
    slerp_weights(abs(c), t, w0, w1);
    T norm = 0;
    for (int i = 0; i < 4; ++i) {
        k.rotation[i] = w0 * a.rotation[i] + sign * w1 * b.rotation[i];
        norm += k.rotation[i] * k.rotation[i];
    }
    norm = 1.0f / sqrt(norm);
    for (int i = 0; i < 4; ++i) k.rotation[i] *= norm;
    return k;
}

/// Where a bending mesh is between two of its keys.
template <class T>
struct VertexKeys {
    unsigned long first = 0, second = 0;  ///< offsets of the keys' vertices
    T fraction = 0;
};

template <class T>
SHARED_FN VertexKeys<T> vertex_keys(const Geometry& g, T time) {
    if (g.key_count <= 1) return {};
    const T position = clamp(time, T(0.0f), T(1.0f)) * static_cast<T>(g.key_count - 1);
    int segment = truncate(position);
    const int last = static_cast<int>(g.key_count) - 2;
    if (segment > last) segment = last;
    const unsigned long first = static_cast<unsigned long>(segment) * g.vertex_count;
    return {first, first + g.vertex_count, position - static_cast<T>(segment)};
}

/// Position of a vertex between two keys, in the mesh's coordinates.
template <class T>
SHARED_FN Vec3<T> position_at(const Geometry& g, const VertexKeys<T>& keys, unsigned vertex) {
    const Vec3<T> a = splat<T>(g.vertices[keys.first + vertex].position);
    if (g.key_count <= 1) return a;
    const Vec3<T> b = splat<T>(g.vertices[keys.second + vertex].position);
    return {lerp(a.x, b.x, keys.fraction), lerp(a.y, b.y, keys.fraction), lerp(a.z, b.z, keys.fraction)};
}

/// world_from_object of an instance at a time in [0, 1] of the shutter.
template <class T>
SHARED_FN AffineOf<T> transform_at(const SceneViewOf<T>& scene, unsigned instance, T time) {
    const InstanceMotion& motion = scene.motions[instance];
    if (motion.kind == InstanceMotion::Kind::still) return scene.matrices[motion.first];
    const T position = clamp(time, T(0.0f), T(1.0f)) * static_cast<T>(motion.count - 1);
    int segment = truncate(position);
    const int last = static_cast<int>(motion.count) - 2;
    if (segment > last) segment = last;
    const T fraction = position - static_cast<T>(segment);
    if (motion.kind == InstanceMotion::Kind::linear) {
        const AffineOf<T> &a = scene.matrices[motion.first + segment], &b = scene.matrices[motion.first + segment + 1];
        AffineOf<T> r;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 4; ++j) r.m[i][j] = lerp(a.m[i][j], b.m[i][j], fraction);
        return r;
    }
    const TransformKeyOf<T>* keys = scene.keys + motion.first + segment;
    return compose(interpolate(keys[0], keys[1], fraction));
}

}  // namespace kadr::kernels
