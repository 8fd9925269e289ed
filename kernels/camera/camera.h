// Camera rays. The camera looks along its -z with +y up; film coordinates are pixels, x right and y down, the centre of
// the first pixel at (0.5, 0.5).
#pragma once

#include "kernels/math/gather.h"
#include "kernels/sampler/warp.h"
#include "kernels/scene/scene_types.h"

namespace kadr::kernels {

template <class F>
struct Quaternion {
    F x, y, z, w;
};

/// v turned by a unit quaternion.
template <class F>
SHARED_FN Vec3<F> rotate(Quaternion<F> q, Vec3<F> v) {
    const Vec3<F> axis{q.x, q.y, q.z};
    const Vec3<F> t = cross(axis, v) * F(2.0f);
    return v + t * q.w + cross(axis, t);
}
template <class F>
SHARED_FN Vec3<F> rotate_back(Quaternion<F> q, Vec3<F> v) {
    return rotate(Quaternion<F>{-q.x, -q.y, -q.z, q.w}, v);
}

/// sin(t a) / sin(a) from cos(a) - 1: no division, no inverse cosine. Error below 1e-9 for a <= 5 degrees (steps of
/// 10 degrees), 1e-6 for a <= 30 degrees.  Source: Eberly 2011, "A Fast and Accurate Algorithm for Computing SLERP".
template <class F>
SHARED_FN F slerp_weight(F t, F cos_minus_1) {
    const F t2 = t * t;
    F sum(1.0f);
    sum = F(1.0f) + (t2 * F(1.0f / 78.0f) - F(6.0f / 13.0f)) * cos_minus_1 * sum;
    sum = F(1.0f) + (t2 * F(1.0f / 55.0f) - F(5.0f / 11.0f)) * cos_minus_1 * sum;
    sum = F(1.0f) + (t2 * F(1.0f / 36.0f) - F(4.0f / 9.0f)) * cos_minus_1 * sum;
    sum = F(1.0f) + (t2 * F(1.0f / 21.0f) - F(3.0f / 7.0f)) * cos_minus_1 * sum;
    sum = F(1.0f) + (t2 * F(1.0f / 10.0f) - F(2.0f / 5.0f)) * cos_minus_1 * sum;
    sum = F(1.0f) + (t2 * F(1.0f / 3.0f) - F(1.0f / 3.0f)) * cos_minus_1 * sum;
    return t * sum;
}

/// Along the shorter arc, at constant speed.
template <class F>
SHARED_FN Quaternion<F> slerp(Quaternion<F> a, Quaternion<F> b, F t) {
    const F signed_cos = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    // 1 - |cos| as half the squared chord: the dot product of nearly equal quaternions has no digits of it left.
    const F sign = copy_sign(F(1.0f), signed_cos);
    b = {b.x * sign, b.y * sign, b.z * sign, b.w * sign};
    const F dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z, dw = a.w - b.w;
    const F cos_minus_1 = F(-0.5f) * (dx * dx + dy * dy + dz * dz + dw * dw);
    const F wa = slerp_weight(F(1.0f) - t, cos_minus_1);
    const F wb = slerp_weight(t, cos_minus_1);
    return {a.x * wa + b.x * wb, a.y * wa + b.y * wb, a.z * wa + b.z * wb, a.w * wa + b.w * wb};
}

/// A camera key with values of their own in every lane.
template <class F>
struct CameraPose {
    Vec3<F> position;
    Quaternion<F> rotation;
    F tan_half_width, tan_half_height, lens_radius, focus_distance, start;
};

static_assert(sizeof(CameraKey) == 12 * sizeof(float), "gathered as floats");

template <class F>
SHARED_FN CameraPose<F> camera_key(const CameraOf<Real<F>>& camera, Int<F> key) {
    const Real<F>* k = &camera.keys->position.x;
    const Int<F> i = key * Int<F>(12);
    return {gather_vec3<F>(k, i), {gather(k + 3, i), gather(k + 4, i), gather(k + 5, i), gather(k + 6, i)},
            gather(k + 7, i),     gather(k + 8, i),
            gather(k + 9, i),     gather(k + 10, i),
            gather(k + 11, i)};
}

/// One key for all lanes.
template <class F>
SHARED_FN CameraPose<F> camera_key_uniform(const CameraKeyOf<Real<F>>& k) {
    return {splat<F>(k.position), {F(k.rotation[0]), F(k.rotation[1]), F(k.rotation[2]), F(k.rotation[3])},
            F(k.tan_half_width),  F(k.tan_half_height),
            F(k.lens_radius),     F(k.focus_distance),
            F(k.start)};
}

template <class F>
SHARED_FN CameraPose<F> interpolate(const CameraPose<F>& a, const CameraPose<F>& b, F t) {
    return {lerp(a.position, b.position, t),
            slerp(a.rotation, b.rotation, t),
            lerp(a.tan_half_width, b.tan_half_width, t),
            lerp(a.tan_half_height, b.tan_half_height, t),
            lerp(a.lens_radius, b.lens_radius, t),
            lerp(a.focus_distance, b.focus_distance, t),
            a.start};
}

/// The camera at a time of the shutter in [0, 1].
template <class F>
SHARED_FN CameraPose<F> camera_at(const CameraOf<Real<F>>& camera, F time) {
    if (camera.key_count == 1) return camera_key_uniform<F>(camera.keys[0]);
    if (camera.key_count == 2) {
        return interpolate(camera_key_uniform<F>(camera.keys[0]), camera_key_uniform<F>(camera.keys[1]), time);
    }
    const F position = time * F(static_cast<float>(camera.key_count - 1));
    const Int<F> key = clamp_index<F>(truncate(position), 0, camera.key_count - 2);
    return interpolate(camera_key<F>(camera, key), camera_key<F>(camera, key + Int<F>(1)), position - F(key));
}

/// Point of the aperture, of radius 1.
template <class F>
SHARED_FN Vec2<F> sample_aperture(int blades, Vec2<F> u) {
    return blades >= 3 ? sample_polygon(blades, u) : sample_disk(u);
}

/// A ray through the film, in world space relative to the render origin. It starts on the plane that the camera's key
/// speaks of: at the camera, or before all that it sees.
///
/// @param film_px    pixels; x right, y down
/// @param time       [0, 1] over the shutter
/// @param lens       point of the unit square; unused by a pinhole
/// @param direction  unit length
template <class F>
SHARED_FN void camera_ray(const CameraOf<Real<F>>& camera, int width, int height, Vec2<F> film_px, F time, Vec2<F> lens,
                          Vec3<F>& origin, Vec3<F>& direction) {
    const CameraPose<F> pose = camera_at(camera, time);
    const F x = (film_px.x * F(2.0f / static_cast<float>(width)) - F(1.0f)) * pose.tan_half_width;
    const F y = (F(1.0f) - film_px.y * F(2.0f / static_cast<float>(height))) * pose.tan_half_height;
    const F zero(0.0f);
    Vec3<F> from = camera.orthographic ? Vec3<F>{x, y, zero} : Vec3<F>{zero, zero, zero};
    Vec3<F> to = camera.orthographic ? Vec3<F>{zero, zero, F(-1.0f)} : Vec3<F>{x, y, F(-1.0f)};
    const Vec3<F> ahead_of_camera{to.x * pose.start, to.y * pose.start, zero};
    const Mask<F> thin_lens = pose.lens_radius > zero;
    if (any(thin_lens)) {
        // Everything at the focus distance stays where the pinhole sees it.
        const Vec2<F> at = sample_aperture(camera.blades, lens) * select(thin_lens, pose.lens_radius, zero);
        const F ahead = select(thin_lens, pose.focus_distance, F(1.0f));
        const F per_metre = F(1.0f) / (ahead + pose.start);
        const F left = ahead / (ahead + pose.start);  // of the way to the focus, and so of the distance from the pinhole's ray
        from = from + Vec3<F>{at.x * left, at.y * left, zero};
        to = to - Vec3<F>{at.x * per_metre, at.y * per_metre, zero};
    }
    from = from + ahead_of_camera;
    origin = pose.position + rotate(pose.rotation, from);
    direction = normalize(rotate(pose.rotation, to));
}

/// Where a point appears on the film, in pixels (x right, y down); the inverse of a pinhole's camera_ray. Points behind
/// the camera land far off the image.
template <class F>
SHARED_FN Vec2<F> project(const CameraOf<Real<F>>& camera, int width, int height, Vec3<F> p, F time) {
    const CameraPose<F> pose = camera_at(camera, time);
    const Vec3<F> local = rotate_back(pose.rotation, p - pose.position);
    const F depth = camera.orthographic ? F(1.0f) : max(pose.start - local.z, least_divisor<F>(1e-9f));
    const F x = local.x / (depth * pose.tan_half_width);
    const F y = local.y / (depth * pose.tan_half_height);
    return {(x + F(1.0f)) * F(0.5f * static_cast<float>(width)), (F(1.0f) - y) * F(0.5f * static_cast<float>(height))};
}

}  // namespace kadr::kernels
