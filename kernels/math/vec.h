// Small vectors over a value type F: float (storage, the GPU, the portable form) or several lanes (see wide.h).
#pragma once

#include "kernels/math/platform.h"

namespace kadr::kernels {

template <class F>
struct Vec2 {
    F x, y;
};

template <class F>
struct Vec3 {
    F x, y, z;
};

template <class F>
struct Vec4 {
    F x, y, z, w;
};

using Vec2f = Vec2<float>;
using Vec3f = Vec3<float>;
using Vec4f = Vec4<float>;

static_assert(sizeof(Vec2f) == 8 && sizeof(Vec3f) == 12 && sizeof(Vec4f) == 16, "packed: these are buffer elements");

template <class F> SHARED_FN Vec2<F> operator+(Vec2<F> a, Vec2<F> b) { return {a.x + b.x, a.y + b.y}; }
template <class F> SHARED_FN Vec2<F> operator-(Vec2<F> a, Vec2<F> b) { return {a.x - b.x, a.y - b.y}; }
template <class F> SHARED_FN Vec2<F> operator*(Vec2<F> a, F s) { return {a.x * s, a.y * s}; }

template <class F> SHARED_FN Vec3<F> operator+(Vec3<F> a, Vec3<F> b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
template <class F> SHARED_FN Vec3<F> operator-(Vec3<F> a, Vec3<F> b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <class F> SHARED_FN Vec3<F> operator*(Vec3<F> a, Vec3<F> b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
template <class F> SHARED_FN Vec3<F> operator*(Vec3<F> a, F s) { return {a.x * s, a.y * s, a.z * s}; }
template <class F> SHARED_FN Vec3<F> operator*(F s, Vec3<F> a) { return {a.x * s, a.y * s, a.z * s}; }
template <class F> SHARED_FN Vec3<F> operator-(Vec3<F> a) { return {-a.x, -a.y, -a.z}; }

template <class F> SHARED_FN F dot(Vec3<F> a, Vec3<F> b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <class F> SHARED_FN Vec3<F> cross(Vec3<F> a, Vec3<F> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class F> SHARED_FN F max_component(Vec3<F> a);  // defined in wide.h, with max()

/// Rec. 709 luminance of linear RGB.
template <class F> SHARED_FN F luminance(Vec3<F> c) { return F(0.2126f) * c.x + F(0.7152f) * c.y + F(0.0722f) * c.z; }

}  // namespace kadr::kernels
