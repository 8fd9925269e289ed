// What the data layers say of the first surface that a sample meets: depth and motion.
#pragma once

#include "kernels/camera/camera.h"
#include "kernels/integrator/interaction.h"

namespace kadr::kernels {

/// Pixels that a point of a surface moved since the previous frame, both taken at the shutter's opening. Only where the
/// scene has previous matrices.
SHARED_FN Vec2f motion_of_point(const SceneView& scene, unsigned instance, unsigned primitive, float u, float v) {
    const Geometry& g = scene.geometries[scene.instances[instance].geometry];
    const unsigned* index = g.indices + 3 * static_cast<unsigned long>(primitive);
    const Vec3f opening =
        barycentric(g.vertices[index[0]].position, g.vertices[index[1]].position, g.vertices[index[2]].position, u, v);
    const Vec3f earlier =
        g.previous ? barycentric(g.previous[index[0]], g.previous[index[1]], g.previous[index[2]], u, v) : opening;
    const auto place = [&](const Affine& a, Vec3f p) {
        return Vec3f{a.m[0][0] * p.x + a.m[0][1] * p.y + a.m[0][2] * p.z + a.m[0][3],
                     a.m[1][0] * p.x + a.m[1][1] * p.y + a.m[1][2] * p.z + a.m[1][3],
                     a.m[2][0] * p.x + a.m[2][1] * p.y + a.m[2][2] * p.z + a.m[2][3]};
    };
    const int width = scene.settings.width, height = scene.settings.height;
    const Vec2f now =
        project<float>(scene.camera, width, height, place(transform_at(scene, instance, 0.0f), opening), 0.0f);
    const Vec2f before =
        project<float>(scene.previous_camera, width, height, place(scene.previous_matrices[instance], earlier), 0.0f);
    return {now.x - before.x, now.y - before.y};
}

/// Cosine between a camera ray and the view axis, which makes a distance a depth.
SHARED_FN float view_cosine(const Camera& camera, float time, Vec3f direction) {
    const float position = time * static_cast<float>(camera.key_count - 1);
    const int k =
        position < static_cast<float>(camera.key_count - 1) ? static_cast<int>(position) : camera.key_count - 1;
    const float* q = camera.keys[k].rotation;  // the nearer key: within the motion tolerance of the true axis
    const Vec3f axis{-2 * (q[0] * q[2] + q[3] * q[1]), -2 * (q[1] * q[2] - q[3] * q[0]),
                     -(1 - 2 * (q[0] * q[0] + q[1] * q[1]))};
    return axis.x * direction.x + axis.y * direction.y + axis.z * direction.z;
}

}  // namespace kadr::kernels
