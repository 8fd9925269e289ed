// What a renderer on any device knows of a scene: plain data, no ownership. Pointers are device addresses.
//
// Places and directions in the world come in float, and in double for the reference (device/exact): T says which. Meshes,
// materials and images are float for both, since that is what files hold.
#pragma once

#include "kernels/math/vec.h"

namespace kadr::kernels {

enum class Wrap : unsigned char { repeat, mirrored_repeat, clamp_to_edge };
enum class TexelFormat : unsigned char {
    rgba8_srgb,    ///< 8 bits, colour with the sRGB transfer, alpha linear
    rgba8_linear,  ///< 8 bits, data
    rgba16_srgb,   ///< 16 bits
    rgba16_linear,
    rgba32f,  ///< floats, linear
};

/// A four-channel image; row 0 is the top row (glTF's v = 0).
struct Texture {
    const void* texels;
    int width, height;
    TexelFormat format;
    Wrap wrap_s, wrap_t;
    bool nearest;  ///< no interpolation (magFilter NEAREST); bilinear otherwise
};

/// Use of a texture by a material.  uv' = (m00 u + m01 v + m02, m10 u + m11 v + m12)  (KHR_texture_transform).
struct TextureSlot {
    int texture = -1;  ///< index into the scene's textures; -1: none
    int uv_set = 0;    ///< 0 or 1
    float m00 = 1, m01 = 0, m02 = 0, m10 = 0, m11 = 1, m12 = 0;
};

enum class AlphaMode : unsigned char { opaque, mask, blend };

/// Fresnel reflectance of a dielectric of index 1.5 at normal incidence: that of materials without KHR_materials_ior.
inline constexpr float kDielectricF0 = 0.04f;

/// glTF metallic-roughness material.
struct Material {
    // The first eight floats are fetched together (see load_rows in math/wide.h): keep their order.
    Vec3f base_color{1, 1, 1};  ///< linear
    float metallic = 1;
    Vec3f emission{0, 0, 0};  ///< radiance: emissiveFactor * emissiveStrength
    float roughness = 1;      ///< perceptual; alpha_ggx = roughness^2
    float dielectric_f0 = kDielectricF0;  ///< ((ior - 1) / (ior + 1))^2
    float alpha = 1;
    float alpha_cutoff = 0.5f;
    float normal_scale = 1;
    float occlusion_strength = 1;  ///< read, unused: both integrators trace what baked occlusion imitates
    AlphaMode alpha_mode = AlphaMode::opaque;
    bool double_sided = false;
    bool unlit = false;  ///< KHR_materials_unlit: emits its base colour, reflects nothing
    TextureSlot base_color_texture, metallic_roughness_texture, normal_texture, emissive_texture, occlusion_texture;
};

/// What every shaded point needs of a vertex, in one half of a cache line.
struct Vertex {
    Vec3f position;
    Vec3f normal;  ///< unit; zero where the mesh is flat
    Vec2f uv;      ///< of set 0; zero without one
};
static_assert(sizeof(Vertex) == 32, "fetched as eight floats");

/// A triangle mesh in its own coordinates (normalised to order 1 by the loader), or, flattened, relative to the render
/// origin. Null pointers: attribute absent.
struct Geometry {
    const Vertex* vertices;   ///< [key][vertex_count]
    const unsigned* indices;  ///< [3 * triangle_count]
    const Vec4f* tangents;    ///< [key][vertex_count] xyz unit, w = +-1 handedness; null unless a normal texture is used
    const Vec2f* uv1;         ///< [vertex_count] of set 1
    const Vec4f* colors;      ///< [vertex_count] linear RGBA, multiplies the base colour
    unsigned vertex_count, triangle_count;
    unsigned key_count;       ///< of a mesh that bends: keys evenly spaced on [0, 1] of the shutter; 0 and 1: rigid
    const Vec3f* previous;    ///< [vertex_count] positions one frame earlier; null: those of the first key
};

/// Shading's view of one instance.
struct Instance {
    unsigned geometry, material;
    unsigned id;  ///< stable over frames
};

enum class LightKind : unsigned char { directional, point, spot, area };
enum class SpotFalloff : unsigned char { gltf, linear, blender };

/// A light at one time of the shutter.
template <class T>
struct LightOf {
    Vec3<T> radiance{0, 0, 0};  ///< colour * strength: lux (directional), candela (point, spot), nit (area)
    LightKind kind = LightKind::point;
    SpotFalloff falloff = SpotFalloff::gltf;
    Vec3<T> position{0, 0, 0};    ///< relative to the render origin
    Vec3<T> direction{0, 0, -1};  ///< the way the light travels (area: the side that emits)
    Vec3<T> axis_u{1, 0, 0};      ///< area: half of the rectangle's first side; second is axis_v
    Vec3<T> axis_v{0, 1, 0};
    T cos_inner = 1, cos_outer = 0;
    T inner_rad = 0, outer_rad = 0;
    T range = 0;               ///< metres; 0: infinite
    T radius = 0;              ///< point and spot: sphere of this radius; 0: a point
    /// Directional: 1 - cos of the angular radius, which keeps its digits where the cosine is 1; 0: a parallel beam.
    T one_minus_cos = 0;
};
using Light = LightOf<float>;

/// A camera at one time of the shutter.
template <class T>
struct CameraKeyOf {
    Vec3<T> position;  ///< relative to the render origin; of the point of the view axis that is `start` in front of the camera
    T rotation[4];     ///< world_from_camera quaternion x y z w; the camera looks along its -z, +y up
    T tan_half_width;  ///< perspective: half the image's width at unit distance; orthographic: half width in metres
    T tan_half_height;
    T lens_radius;     ///< metres; 0: pinhole
    T focus_distance;  ///< metres along the view axis, from there
    /// Metres along the view axis from the camera to the plane that rays start on, the same for all keys; 0: they start at
    /// the camera. Where it looks at something far away through a long lens, floats would lose the pixel on the way.
    T start = 0;
};
using CameraKey = CameraKeyOf<float>;

template <class T>
struct CameraOf {
    const CameraKeyOf<T>* keys;  ///< evenly spaced over the shutter
    int key_count;
    bool orthographic;
    int blades;             ///< 0: round aperture
    T near_clip, far_clip;  ///< metres along the view axis; 0 and infinity when the camera has none
};
using Camera = CameraOf<float>;

enum class FilterKind : unsigned char { box, gaussian, mitchell, blackman_harris };
enum class IntegratorKind : unsigned char { direct, path };

/// What the shot says about rendering; constant over the shot but for `frame_seed`.
struct Settings {
    IntegratorKind integrator = IntegratorKind::path;
    FilterKind filter = FilterKind::box;
    float filter_radius = 0.5f;  ///< half of the full width, pixels
    int width = 0, height = 0;
    int max_bounces = 8, max_diffuse = 8, max_glossy = 8;
    unsigned seed = 0;                           ///< already mixed with the frame's number where the seed is animated
    float clamp_direct = 0, clamp_indirect = 0;  ///< 0: none
    bool cull_backfaces = false;
    bool exact_fresnel = false;  ///< dielectrics reflect by Fresnel's equations; otherwise by Schlick's term
    bool transparent_background = false;
};

}  // namespace kadr::kernels
