// The scene as the integrators see it, on any device: tables and what the frame adds to them.
#pragma once

#include "kernels/light/environment.h"
#include "kernels/math/vec.h"
#include "kernels/scene/requirement.h"
#include "kernels/scene/scene_types.h"

namespace kadr::kernels {

/// Row-major 3x4: world_from_object, relative to the render origin.
template <class T>
struct AffineOf {
    T m[3][4];
};
using Affine = AffineOf<float>;

/// One transform of a moving instance, decomposed: translation * rotation * shear * scale; rotation x y z w.
/// shear = (xy, xz, yz), the upper triangle over the scale. All instances share one rule: everything is interpolated
/// linearly but for the rotation, which goes by slerp along the shorter arc.
template <class T>
struct TransformKeyOf {
    T translation[3];
    T rotation[4];
    T scale[3];
    T shear[3];
};
using TransformKey = TransformKeyOf<float>;

/// Where an instance is during the shutter: one matrix (still), two matrices (linear), or keys evenly spaced on [0, 1].
struct InstanceMotion {
    enum class Kind : unsigned char { still, linear, keys };
    unsigned first;  ///< into SceneView::matrices (still, linear) or SceneView::keys
    unsigned count;
    Kind kind;
    bool identity;  ///< flattened: coordinates are relative to the render origin already
};

/// A triangle that emits, at the shutter's opening. Chosen in proportion to luminance * world area.
template <class T>
struct alignas(16 * sizeof(T)) EmissiveTriangleOf {
    // Sixteen numbers, fetched together (see load_rows): keep their order.
    Vec3<T> corner;        ///< relative to the render origin
    Vec3<T> edge1, edge2;  ///< to the second and third corner
    Vec3<T> emission;      ///< radiance; of a textured emitter the factor
    T density;             ///< pdf per area of a point on it
    T clearance;           ///< metres off its surface at which shadow rays to it end (see emitter_clearance)
    unsigned instance;
    unsigned primitive;    ///< of a triangle that is textured, moves or bends, so that a point of it has to be looked up; kStands
    static constexpr unsigned kStands = 0xffffffffu;
};
using EmissiveTriangle = EmissiveTriangleOf<float>;
static_assert(sizeof(EmissiveTriangle) == 64, "fetched as sixteen floats");

/// Everything that emits, as next-event estimation sees it: entries that compete for the one shadow ray of a hit.
template <class T>
struct LightSetOf {
    const LightOf<T>* keys;  ///< [sum of counts]
    const int* first;      ///< [count] into keys
    const int* key_count;  ///< [count]
    int count;             ///< punctual and area lights
    int visible_count;     ///< how many of them have a surface (area, spheres, suns with an angle); those come first
    // emissive triangles, as one entry
    const EmissiveTriangleOf<T>* triangles;
    const float* triangle_cdf;  ///< [triangle_count + 1], from 0 to 1
    int triangle_count;
    const T* instance_density;  ///< [instance] luminance / sum(luminance * area): pdf per area of its triangles; unread without any
    T emitted_power;            ///< sum(luminance * area) over all emissive triangles
    Vec3<T> emitter_centre;
    T emitter_radius_squared;
    // environment
    Vec3f environment;         ///< constant radiance; unused with a map
    bool environment_visible;  ///< to camera rays
    bool has_map;
    EnvironmentMap map;
};
using LightSet = LightSetOf<float>;

template <class T>
struct SceneViewOf {
    const Geometry* geometries;
    const Instance* instances;
    const InstanceMotion* motions;  ///< [instance]
    const AffineOf<T>* matrices;
    const TransformKeyOf<T>* keys;
    const Material* materials;
    const Texture* textures;
    LightSetOf<T> lights;
    CameraOf<T> camera;
    const AffineOf<T>* previous_matrices;  ///< [instance] world_from_object one frame earlier; null: no motion layer
    CameraOf<T> previous_camera;           ///< one key
    Settings settings;
};
using SceneView = SceneViewOf<float>;
/// The scene that kernels over F read.
template <class F> using SceneFor = SceneViewOf<Real<F>>;

}  // namespace kadr::kernels
