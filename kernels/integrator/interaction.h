// From a hit (instance, triangle, barycentrics) to a place to shade: position, normals, material.
#pragma once

#include "kernels/math/wide.h"
#include "kernels/scene/motion.h"
#include "kernels/scene/scene_view.h"
#include "kernels/texture/texture.h"

namespace kadr::kernels {

/// What a tracer reports. `u`, `v` weigh vertices 1 and 2; distance is in units of the (unit) ray direction.
template <class F>
struct Hit {
    Int<F> instance, primitive;
    F u, v, distance;
};

/// A shaded point. Normals are unit, in world space and turned to the viewer.
template <class F>
struct Interaction {
    Vec3<F> position;  ///< on the surface
    Vec3<F> origin;    ///< where rays leave from: off the surface, on the viewer's side
    Vec3<F> geometric_normal, shading_normal;
    Vec3<F> base_color, emission;
    F metallic, roughness;
    F dielectric_f0;  ///< Fresnel reflectance of its dielectric part at normal incidence
    F alpha;  ///< coverage of a `blend` material; 1 elsewhere
    Mask<F> unlit;
};

/// Moves a point off its surface by a few units in the last place of its own coordinates.
/// Source: Wächter & Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, 2019, ch. 6.
template <class F>
SHARED_FN F offset_coordinate(F p, F n) {
    const Int<F> ulps = truncate(n * F(256.0f));
    const UInt<F> moved = select(p < F(0.0f), as_uint(p) - UInt<F>(ulps), as_uint(p) + UInt<F>(ulps));
    return select(abs(p) < F(1.0f / 32), p + n * F(1.0f / 65536), as_float(moved));
}
#if !KADR_DEVICE_CODE
/// In double the same step would be as wide as in float. 2^-44 is as many units in the last place as 256 at coordinate 1.
SHARED_FN double offset_coordinate(double p, double n) { return p + n * max(abs(p), 1.0) * 0x1p-44; }
#endif
template <class F>
SHARED_FN Vec3<F> offset_origin(Vec3<F> p, Vec3<F> n) {
    return {offset_coordinate(p.x, n.x), offset_coordinate(p.y, n.y), offset_coordinate(p.z, n.z)};
}

/// How far a tracer's slerp turns from ours, radians: Embree 3.13 is off by up to 2.2e-5 where a step is 3.6° to 5°, and
/// by less beyond (below 3.6° it interpolates linearly, within 2e-6). The surface that rays meet lies as far from ours
/// as its points from what they turn about, and rays have to start clear of it.
inline constexpr float kSlerpError = 2.5e-5f;

/// That of an instance, radians.
SHARED_FN float slerp_error(const InstanceMotion& motion) {
    return motion.kind == InstanceMotion::Kind::keys ? kSlerpError : 0.0f;
}

/// How far rays start from a surface beyond the offset in its mesh's own coordinates. The reference in double also stays
/// clear of what rounding leaves of a place in the world.
template <class F>
SHARED_FN F clearance(F rotation_error_m, const Interaction<F>& it) {
    if constexpr (sizeof(Real<F>) == 8) return rotation_error_m + length(it.position) * 0x1p-49;
    return rotation_error_m;
}

/// How far off an emissive triangle shadow rays to it end, metres: what rounding may displace it by in its mesh and in the
/// world. Closer, the triangle and its neighbours would hide the light that they send. A sixteenth of what rays start off a
/// surface with: they are told to end at the triangle, and only have to stop short of it.
/// @param at       world_from_object
/// @param p        the point, in the mesh's coordinates
/// @param corners  of the triangle, there
template <class T>
SHARED_FN T emitter_clearance(const AffineOf<T>& at, Vec3<T> p, const Vec3<T> (&corners)[3]) {
    const Vec3<T> edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
    const Vec3<T> normal = cross(edge1, edge2), world_normal = cross(vector_by(at, edge1), vector_by(at, edge2));
    const T lengths = length(normal) * length(world_normal);
    // Metres off the triangle for a unit of the mesh's coordinates off it.
    const T metres = abs(dot(vector_by(at, normal), world_normal)) / max(lengths, least_divisor<T>(1e-30f));
    return end_rounding<T>() * (T(2.0f) * length(p) * metres + length(point_by(at, p)));
}

/// A 3x4 matrix in every lane.
template <class F>
struct AffineLanes {
    F m[3][4];
    SHARED_FN Vec3<F> point(Vec3<F> p) const {
        return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
                m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
                m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
    }
    SHARED_FN Vec3<F> vector(Vec3<F> p) const {
        return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z, m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z,
                m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z};
    }
    SHARED_FN Vec3<F> row(int i) const { return {m[i][0], m[i][1], m[i][2]}; }
    /// 1, or -1 where the matrix mirrors.
    SHARED_FN F handedness() const { return copy_sign(F(1.0f), dot(cross(row(0), row(1)), row(2))); }
    /// Unnormalised. By the cofactors, which are the inverse transpose times the determinant: right for every matrix
    /// that has an inverse, sheared ones included.
    SHARED_FN Vec3<F> normal(Vec3<F> n) const {
        const Vec3<F> r0 = row(0), r1 = row(1), r2 = row(2);
        return Vec3<F>{dot(cross(r1, r2), n), dot(cross(r2, r0), n), dot(cross(r0, r1), n)} * handedness();
    }
};

template <class F, class T>
SHARED_FN void set_vec(Vec3<F>& v, int i, Vec3<T> x) {
    set_lane(v.x, i, x.x);
    set_lane(v.y, i, x.y);
    set_lane(v.z, i, x.z);
}
template <class F, class T>
SHARED_FN void set_vec(Vec2<F>& v, int i, Vec2<T> x) {
    set_lane(v.x, i, x.x);
    set_lane(v.y, i, x.y);
}
template <class F, class T>
SHARED_FN void set_vec(Vec4<F>& v, int i, Vec4<T> x) {
    set_lane(v.x, i, x.x);
    set_lane(v.y, i, x.y);
    set_lane(v.z, i, x.z);
    set_lane(v.w, i, x.w);
}

template <class T>
SHARED_FN Vec3<T> barycentric(Vec3<T> a, Vec3<T> b, Vec3<T> c, T u, T v) {
    return a * (1.0f - u - v) + b * u + c * v;
}

/// Attributes of a triangle's vertices at (u, v).
template <class T>
SHARED_FN Vec2<T> mix(Vec2f a, Vec2f b, Vec2f c, T u, T v) {
    const T w = 1.0f - u - v;
    return {a.x * w + b.x * u + c.x * v, a.y * w + b.y * u + c.y * v};
}
template <class T, class A>
SHARED_FN Vec4<T> mix(Vec4<A> a, Vec4<A> b, Vec4<A> c, T u, T v) {
    const T w = 1.0f - u - v;
    return {a.x * w + b.x * u + c.x * v, a.y * w + b.y * u + c.y * v, a.z * w + b.z * u + c.z * v,
            a.w * w + b.w * u + c.w * v};
}

/// UVs at a point of a triangle.
template <class T>
SHARED_FN Vec2<T> uv_at(const Geometry& g, const unsigned* index, int set, T u, T v) {
    if (set == 0) return mix(g.vertices[index[0]].uv, g.vertices[index[1]].uv, g.vertices[index[2]].uv, u, v);
    return g.uv1 ? mix(g.uv1[index[0]], g.uv1[index[1]], g.uv1[index[2]], u, v) : Vec2<T>{0, 0};
}

/// Vertex attributes that only textured surfaces need.
template <class F>
struct SurfaceMaps {
    Vec2<F> uv[2];
    Vec4<F> tangent;
    Vec4<F> color;
};

/// Tangent of a vertex between two keys; the handedness is the same in all of them.
template <class T>
SHARED_FN Vec4<T> tangent_at(const Geometry& g, const VertexKeys<T>& keys, unsigned vertex) {
    const Vec4f a = g.tangents[keys.first + vertex];
    if (g.key_count <= 1) return {a.x, a.y, a.z, a.w};
    const Vec4f b = g.tangents[keys.second + vertex];
    return {lerp<T>(a.x, b.x, keys.fraction), lerp<T>(a.y, b.y, keys.fraction), lerp<T>(a.z, b.z, keys.fraction), a.w};
}

/// Attributes that not every mesh has, of one lane.
template <class F, unsigned R>
SHARED_FN void fetch_maps(const Material& m, const Geometry& g, const VertexKeys<Real<F>>& keys, const unsigned* index,
                          Real<F> u, Real<F> v, int i, SurfaceMaps<F>& maps, Interaction<F>& it) {
    const unsigned a = index[0], b = index[1], c = index[2];
    Vec4<Real<F>> tangent{0, 0, 0, 1};
    if (g.tangents) {
        const Vec4<Real<F>> first = tangent_at(g, keys, a);
        tangent = mix(first, tangent_at(g, keys, b), tangent_at(g, keys, c), u, v);
        tangent.w = first.w;
    }
    set_vec(maps.tangent, i, tangent);
    if constexpr ((R & requirement::kSpecials) != 0) {
        Vec4<Real<F>> color{1, 1, 1, 1};
        if (g.colors) color = mix(g.colors[a], g.colors[b], g.colors[c], u, v);
        set_vec(maps.color, i, color);
        set_vec(maps.uv[1], i, uv_at(g, index, 1, u, v));
        set_lane(it.unlit, i, m.unlit);
    }
}

/// The shading normal, bent as little as keeps the mirror direction above the surface.
///
/// Strongly tilted normals (of normal maps, and of smooth shading on coarse meshes) mirror the viewer into the surface,
/// where nothing is seen: black rims on metals. All vectors are unit and on the viewer's side. Source: Keller et al.,
/// "The Iray Light Transport Simulation and Rendering System", 2017, A.3.
template <class F>
SHARED_FN Vec3<F> reflecting_normal(Vec3<F> geometric, Vec3<F> shading, Vec3<F> wo) {
    const Vec3<F> mirrored = shading * (F(2.0f) * dot(shading, wo)) - wo;
    const F height = dot(mirrored, geometric);
    // At grazing angles even the flat mirror is low: never ask for more than it has.
    const F least = min(F(0.02f), dot(geometric, wo) * F(0.9f));
    const Vec3<F> bent = normalize(normalize(mirrored + geometric * (least - height)) + wo);
    return select(height < least, bent, shading);
}

/// Textures, lane by lane: base colour, metallic-roughness, emission and the normal map.
template <class F, unsigned R>
SHARED_FN void apply_maps(const SceneFor<F>& scene, const Hit<F>& hit, const SurfaceMaps<F>& maps, F side,
                          Mask<F> active, Interaction<F>& it) {
    using T = Real<F>;
    constexpr bool kSpecials = (R & requirement::kSpecials) != 0;
    for (unsigned todo = bits(active); todo; todo &= todo - 1) {
        const int i = lowest_bit(todo);
        const Material& m = scene.materials[scene.instances[lane(hit.instance, i)].material];
        const Vec2<T> uv0{lane(maps.uv[0].x, i), lane(maps.uv[0].y, i)};
        Vec2<T> uv1 = uv0;
        Vec3<T> base = splat<T>(m.base_color);
        T alpha = m.alpha;
        if constexpr (kSpecials) {
            uv1 = {lane(maps.uv[1].x, i), lane(maps.uv[1].y, i)};
            base = base * Vec3<T>{lane(maps.color.x, i), lane(maps.color.y, i), lane(maps.color.z, i)};
            alpha *= lane(maps.color.w, i);
        }
        if (m.base_color_texture.texture >= 0) {
            const Vec4<T> t = sample_texture<T>(scene.textures, m.base_color_texture.texture,
                                                apply_transform(m.base_color_texture, uv0, uv1), true);
            base = base * Vec3<T>{t.x, t.y, t.z};
            alpha *= t.w;
        }
        set_vec(it.base_color, i, base);
        if constexpr (kSpecials) set_lane(it.alpha, i, m.alpha_mode == AlphaMode::blend ? saturate(alpha) : T(1.0f));
        if (m.metallic_roughness_texture.texture >= 0) {
            const Vec4<T> t = sample_texture<T>(scene.textures, m.metallic_roughness_texture.texture,
                                                apply_transform(m.metallic_roughness_texture, uv0, uv1), true);
            set_lane(it.roughness, i, m.roughness * t.y);
            set_lane(it.metallic, i, m.metallic * t.z);
        }
        if (m.emissive_texture.texture >= 0) {
            const Vec4<T> t = sample_texture<T>(scene.textures, m.emissive_texture.texture,
                                                apply_transform(m.emissive_texture, uv0, uv1), true);
            set_vec(it.emission, i, splat<T>(m.emission) * Vec3<T>{t.x, t.y, t.z});
        }
        if (kSpecials && m.unlit) set_vec(it.emission, i, base);
        const Vec3<T> tangent{lane(maps.tangent.x, i), lane(maps.tangent.y, i), lane(maps.tangent.z, i)};
        if (m.normal_texture.texture >= 0 && dot(tangent, tangent) > 0) {
            const Vec4<T> t = sample_texture<T>(scene.textures, m.normal_texture.texture,
                                                apply_transform(m.normal_texture, uv0, uv1), true);
            const Vec3<T> local{(t.x * 2 - 1) * m.normal_scale, (t.y * 2 - 1) * m.normal_scale, t.z * 2 - 1};
            // The tangent frame belongs to the front side; seen from behind, its normal points the other way.
            const T s = lane(side, i);
            const Vec3<T> n =
                Vec3<T>{lane(it.shading_normal.x, i), lane(it.shading_normal.y, i), lane(it.shading_normal.z, i)};
            const Vec3<T> flat = tangent - n * dot(tangent, n);
            if (dot(flat, flat) > 1e-20f) {
                const Vec3<T> tu = normalize(flat);
                const Vec3<T> tv = cross(n * s, tu) * lane(maps.tangent.w, i);
                const Vec3<T> bent = tu * local.x * s + tv * local.y * s + n * local.z;
                if (dot(bent, bent) > 1e-20f) set_vec(it.shading_normal, i, normalize(bent));
            }
        }
    }
}

/// Fetches lane by lane (every lane has its own mesh), then computes in all lanes at once.
/// @tparam R    set of requirement:: bits
/// @param wo    unit vector back along the ray
template <class F, unsigned R>
SHARED_FN Interaction<F> make_interaction(const SceneFor<F>& scene, const Hit<F>& hit, F time, Vec3<F> wo,
                                          Mask<F> active) {
    constexpr bool kMaps = (R & requirement::kMaps) != 0, kTransforms = (R & requirement::kTransforms) != 0,
                   kDeformation = (R & requirement::kDeformation) != 0;
    const float* rows[4][kLanes<F>];  // three vertices and the material of every lane
    [[maybe_unused]] const float* later[3][kLanes<F>];  // the vertices in the following key
    [[maybe_unused]] F fraction(0.0f);
    AffineLanes<F> world_from_object;
    [[maybe_unused]] Mask<F> placed(false);  // by a matrix; elsewhere vertices are in the world already
    F rotation_error = F(0.0f);  // of the tracer's transform against ours, radians
    SurfaceMaps<F> maps;
    Interaction<F> it;
    it.alpha = F(1.0f);
    it.dielectric_f0 = F(kDielectricF0);
    it.unlit = Mask<F>(false);
    const int some = lowest_bit(bits(active));  // inactive lanes shade what this one hit, and are masked out later
    for (int i = 0; i < kLanes<F>; ++i) {
        const int from = lane(active, i) ? i : some;
        const unsigned instance_index = static_cast<unsigned>(lane(hit.instance, from));
        const Instance& instance = scene.instances[instance_index];
        const Geometry& g = scene.geometries[instance.geometry];
        const unsigned* index = g.indices + 3 * static_cast<unsigned long>(lane(hit.primitive, from));
        VertexKeys<Real<F>> keys;
        if constexpr (kDeformation) {
            keys = vertex_keys(g, lane(time, from));
            set_lane(fraction, i, keys.fraction);
            for (int c = 0; c < 3; ++c) later[c][i] = &g.vertices[keys.second + index[c]].position.x;
        }
        for (int c = 0; c < 3; ++c) rows[c][i] = &g.vertices[keys.first + index[c]].position.x;
        rows[3][i] = &scene.materials[instance.material].base_color.x;
        if constexpr ((R & requirement::kIor) != 0) set_lane(it.dielectric_f0, i, scene.materials[instance.material].dielectric_f0);
        if constexpr (kTransforms) {
            const AffineOf<Real<F>> at = transform_at(scene, instance_index, lane(time, from));
            for (int r = 0; r < 3; ++r)
                for (int k = 0; k < 4; ++k) set_lane(world_from_object.m[r][k], i, at.m[r][k]);
            const InstanceMotion& motion = scene.motions[instance_index];
            set_lane(placed, i, !motion.identity);
            set_lane(rotation_error, i, slerp_error(motion));
        }
        if constexpr (kMaps)
            fetch_maps<F, R>(scene.materials[instance.material], g, keys, index, lane(hit.u, from), lane(hit.v, from),
                             i, maps, it);
    }
    F corner[3][8], material[8];
    for (int c = 0; c < 3; ++c) load_rows(rows[c], corner[c]);
    if constexpr (kDeformation) {
        F end[8];
        for (int c = 0; c < 3; ++c) {
            load_rows(later[c], end);
            for (int k = 0; k < 8; ++k) corner[c][k] = corner[c][k] + (end[k] - corner[c][k]) * fraction;
        }
    }
    load_rows(rows[3], material);
    const Vec3<F> p0{corner[0][0], corner[0][1], corner[0][2]}, p1{corner[1][0], corner[1][1], corner[1][2]},
        p2{corner[2][0], corner[2][1], corner[2][2]};
    const Vec3<F> n0{corner[0][3], corner[0][4], corner[0][5]}, n1{corner[1][3], corner[1][4], corner[1][5]},
        n2{corner[2][3], corner[2][4], corner[2][5]};
    it.base_color = {material[0], material[1], material[2]};
    it.metallic = material[3];
    it.emission = {material[4], material[5], material[6]};
    it.roughness = material[7];
    // Geometric normal and hit point from barycentrics, never from origin + t * direction (see docs on precision).
    const Vec3<F> object_normal = normalize(cross(p1 - p0, p2 - p0));
    const F w = F(1.0f) - hit.u - hit.v;
    const Vec3<F> object_point = p0 * w + p1 * hit.u + p2 * hit.v;
    Vec3<F> smooth = n0 * w + n1 * hit.u + n2 * hit.v;
    const Mask<F> is_flat = !(dot(smooth, smooth) > F(1e-20f));
    smooth = select(is_flat, object_normal, smooth);
    if constexpr (kTransforms) {
        // Normalised once where nothing is placed, as by kernels without transforms: the same to the last bit.
        it.geometric_normal = select(placed, normalize(world_from_object.normal(object_normal)), object_normal);
        it.shading_normal = normalize(world_from_object.normal(smooth));
        it.position = world_from_object.point(object_point);
    } else {
        it.geometric_normal = object_normal;
        it.shading_normal = normalize(smooth);
        it.position = object_point;
    }
    const F side = copy_sign(F(1.0f), dot(it.geometric_normal, wo));
    if constexpr (kTransforms) {
        const Vec3<F> translation{world_from_object.m[0][3], world_from_object.m[1][3], world_from_object.m[2][3]};
        it.origin = world_from_object.point(offset_origin(object_point, object_normal * side)) +
                    it.geometric_normal * (side * clearance<F>(rotation_error * length(it.position - translation), it));
    } else {
        it.origin = offset_origin(object_point, object_normal * side);
    }
    it.geometric_normal = it.geometric_normal * side;
    // The shading normal follows the geometric one to the viewer's side, also where mirrored transforms flipped one of
    // them.
    it.shading_normal = it.shading_normal * copy_sign(F(1.0f), dot(it.shading_normal, it.geometric_normal));
    if constexpr (kMaps) {
        maps.uv[0] = {corner[0][6] * w + corner[1][6] * hit.u + corner[2][6] * hit.v,
                      corner[0][7] * w + corner[1][7] * hit.u + corner[2][7] * hit.v};
        if constexpr (kTransforms) {
            const Vec3<F> t = world_from_object.vector({maps.tangent.x, maps.tangent.y, maps.tangent.z});
            maps.tangent = {t.x, t.y, t.z, maps.tangent.w * world_from_object.handedness()};
        }
        apply_maps<F, R>(scene, hit, maps, side, active, it);
    }
    // A shading normal that points away from the viewer cannot be shaded: bend it to just inside the visible side.
    const F facing = dot(it.shading_normal, wo);
    const F kLeast = F(1e-3f);
    it.shading_normal =
        select(facing < kLeast, normalize(it.shading_normal + wo * (kLeast - facing)), it.shading_normal);
    return it;
}

}  // namespace kadr::kernels
