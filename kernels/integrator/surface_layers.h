// What the data layers say of the first surface that a sample meets: depth and motion.
#pragma once

#include "kernels/camera/camera.h"
#include "kernels/integrator/interaction.h"

namespace kadr::kernels {

/// Pixels that a point of a surface moved since the previous frame, both taken at the shutter's opening. Only where the
/// scene has previous matrices.
template <class T>
SHARED_FN Vec2<T> motion_of_point(const SceneViewOf<T>& scene, unsigned instance, unsigned primitive, T u, T v) {
    const Geometry& g = scene.geometries[scene.instances[instance].geometry];
    const unsigned* index = g.indices + 3 * static_cast<unsigned long>(primitive);
    const auto point = [&](Vec3f a, Vec3f b, Vec3f c) { return barycentric(splat<T>(a), splat<T>(b), splat<T>(c), u, v); };
    const Vec3<T> opening =
        point(g.vertices[index[0]].position, g.vertices[index[1]].position, g.vertices[index[2]].position);
    const Vec3<T> earlier =
        g.previous ? point(g.previous[index[0]], g.previous[index[1]], g.previous[index[2]]) : opening;
    const int width = scene.settings.width, height = scene.settings.height;
    const Vec2<T> now =
        project<T>(scene.camera, width, height, point_by(transform_at(scene, instance, T(0.0f)), opening), T(0.0f));
    const Vec2<T> before =
        project<T>(scene.previous_camera, width, height, point_by(scene.previous_matrices[instance], earlier), T(0.0f));
    return {now.x - before.x, now.y - before.y};
}

/// How far from the camera a hit of a camera ray is, along the view axis.
/// @param distance  along the ray, from where it starts
template <class T>
SHARED_FN T view_depth(const CameraOf<T>& camera, T time, Vec3<T> direction, T distance) {
    const T position = time * static_cast<T>(camera.key_count - 1);
    const int k =
        position < static_cast<T>(camera.key_count - 1) ? static_cast<int>(position) : camera.key_count - 1;
    const T* q = camera.keys[k].rotation;  // the nearer key: within the motion tolerance of the true axis
    const Vec3<T> axis{-2 * (q[0] * q[2] + q[3] * q[1]), -2 * (q[1] * q[2] - q[3] * q[0]),
                     -(1 - 2 * (q[0] * q[0] + q[1] * q[1]))};
    return camera.keys[k].start + distance * (axis.x * direction.x + axis.y * direction.y + axis.z * direction.z);
}

}  // namespace kadr::kernels
