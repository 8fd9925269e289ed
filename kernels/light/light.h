// Punctual and area lights. A light is the same for all lanes; its keys over the shutter are evenly spaced.
//
// Units as they stand (shot format): lux for directional, candela for point and spot, nit for area lights.
#pragma once

#include "kernels/math/gather.h"
#include "kernels/sampler/warp.h"
#include "kernels/scene/scene_types.h"

namespace kadr::kernels {

/// Distance to what is infinitely far, and of a ray that meets no light.
inline constexpr float kFar = 1e30f;

/// Light arriving at a point from one direction.
template <class F>
struct LightSample {
    Vec3<F> direction;  ///< unit, towards the light
    F distance;         ///< metres, to the light or as far as nothing may lie in between; kFar for directional lights
    Vec3<F> radiance;   ///< incident radiance; for delta lights the irradiance of a surface facing the light
    F pdf;              ///< per steradian; 1 for delta lights; 0: no light from here
};

/// A light met by a ray.
template <class F>
struct LightHit {
    F distance;        ///< metres; kFar: none or a directional light
    Vec3<F> radiance;  ///< 0 where nothing is met
    F pdf;             ///< of sample_light for this direction, per steradian; 0 where nothing is met
};

/// The parts of Light that move, with values of their own in every lane.
template <class F>
struct LightAt {
    Vec3<F> radiance, position, direction, axis_u, axis_v;
    F cos_inner, cos_outer, inner_rad, outer_rad, range, radius, one_minus_cos;
};

static_assert(sizeof(Light) % sizeof(float) == 0 && sizeof(LightOf<double>) % sizeof(double) == 0, "gathered as numbers");

/// Whether no ray can meet the light by chance: a parallel beam, a point.
template <class T>
SHARED_FN bool is_delta(const LightOf<T>& light) {
    if (light.kind == LightKind::directional) return light.one_minus_cos <= 0.0f;
    return light.kind != LightKind::area && light.radius <= 0.0f;
}

/// How far a shadow ray to a light goes: to the light itself, but for rounding, so that whatever lies just before it hides
/// it, and what it lies in front of does not.
template <class F>
SHARED_FN F shadow_distance(F light_distance) {
    return light_distance * (F(1.0f) - end_rounding<F>());
}

template <class F>
SHARED_FN LightAt<F> light_uniform(const LightOf<Real<F>>& l) {
    return {splat<F>(l.radiance), splat<F>(l.position), splat<F>(l.direction), splat<F>(l.axis_u),
            splat<F>(l.axis_v),   F(l.cos_inner),       F(l.cos_outer),        F(l.inner_rad),
            F(l.outer_rad),       F(l.range),           F(l.radius),           F(l.one_minus_cos)};
}

template <class F>
SHARED_FN LightAt<F> light_gathered(const LightOf<Real<F>>* keys, Int<F> key) {
    const Int<F> i = key * Int<F>(static_cast<int>(sizeof(LightOf<Real<F>>) / sizeof(Real<F>)));
    return {gather_vec3<F>(&keys->radiance.x, i),
            gather_vec3<F>(&keys->position.x, i),
            gather_vec3<F>(&keys->direction.x, i),
            gather_vec3<F>(&keys->axis_u.x, i),
            gather_vec3<F>(&keys->axis_v.x, i),
            gather(&keys->cos_inner, i),
            gather(&keys->cos_outer, i),
            gather(&keys->inner_rad, i),
            gather(&keys->outer_rad, i),
            gather(&keys->range, i),
            gather(&keys->radius, i),
            gather(&keys->one_minus_cos, i)};
}

template <class F>
SHARED_FN LightAt<F> interpolate(const LightAt<F>& a, const LightAt<F>& b, F t) {
    return {lerp(a.radiance, b.radiance, t),
            lerp(a.position, b.position, t),
            normalize(lerp(a.direction, b.direction, t)),
            lerp(a.axis_u, b.axis_u, t),
            lerp(a.axis_v, b.axis_v, t),
            lerp(a.cos_inner, b.cos_inner, t),
            lerp(a.cos_outer, b.cos_outer, t),
            lerp(a.inner_rad, b.inner_rad, t),
            lerp(a.outer_rad, b.outer_rad, t),
            lerp(a.range, b.range, t),
            lerp(a.radius, b.radius, t),
            lerp(a.one_minus_cos, b.one_minus_cos, t)};
}

/// The light at a time of the shutter in [0, 1]: its values between two keys, linearly.
template <class F>
SHARED_FN LightAt<F> light_at(const LightOf<Real<F>>* keys, int count, F time) {
    if (count == 1) return light_uniform<F>(keys[0]);
    const F position = time * F(static_cast<float>(count - 1));
    const Int<F> key = clamp_index<F>(truncate(position), 0, count - 2);
    return interpolate(light_gathered<F>(keys, key), light_gathered<F>(keys, key + Int<F>(1)), position - F(key));
}

/// The same as a Light.
SHARED_FN Light light_at(const Light* keys, int count, float time) {
    const LightAt<float> at = light_at<float>(keys, count, time);
    Light l = keys[0];
    l.radiance = at.radiance;
    l.position = at.position;
    l.direction = at.direction;
    l.axis_u = at.axis_u;
    l.axis_v = at.axis_v;
    l.cos_inner = at.cos_inner;
    l.cos_outer = at.cos_outer;
    l.inner_rad = at.inner_rad;
    l.outer_rad = at.outer_rad;
    l.range = at.range;
    l.radius = at.radius;
    l.one_minus_cos = at.one_minus_cos;
    return l;
}

/// KHR_lights_punctual's range: max(min(1 - (d / range)^4, 1), 0); 1 for range 0 (infinite).
template <class F>
SHARED_FN F range_window(F distance2, F range) {
    const Mask<F> limited = range > F(0.0f);
    const F q = distance2 / select(limited, range * range, F(1.0f));
    return select(limited, saturate(F(1.0f) - q * q), F(1.0f));
}

/// Share of a spot's intensity at an angle from its axis (shot format: `falloff`).
template <class F>
SHARED_FN F cone_factor(SpotFalloff falloff, const LightAt<F>& l, F cos_angle) {
    const F tiny(1e-6f);  // an inner cone as wide as the outer one is a step
    if (falloff == SpotFalloff::linear) {
        return saturate((l.outer_rad - acos(clamp(cos_angle, F(-1.0f), F(1.0f)))) /
                        max(l.outer_rad - l.inner_rad, tiny));
    }
    if (falloff == SpotFalloff::blender) {
        const F blend = F(1.0f) - l.inner_rad / max(l.outer_rad, tiny);
        const F t = saturate((cos_angle - l.cos_outer) / max((F(1.0f) - l.cos_outer) * blend, tiny));
        return t * t * (F(3.0f) - F(2.0f) * t);
    }
    return square(saturate((cos_angle - l.cos_outer) / max(l.cos_inner - l.cos_outer, tiny)));
}

/// What of a point's or spot's candela is sent towards a point: cone and range, without 1 / d^2.
///
/// @param to_light  unit, from the point to the light's centre. A sphere's cone looks at the centre too, so that its
///                  radiance is constant over the disk that a point sees.
template <class F>
SHARED_FN F intensity_factor(const LightOf<Real<F>>& light, const LightAt<F>& l, Vec3<F> to_light, F distance2) {
    const F window = range_window(distance2, l.range);
    if (light.kind != LightKind::spot) return window;
    return window * cone_factor(light.falloff, l, F(-dot(to_light, l.direction)));
}

/// 1 - cos of the half-angle under which a sphere is seen; 0 from inside.
template <class F>
SHARED_FN F sphere_one_minus_cos(F radius2, F distance2) {
    const F sin2 = radius2 / distance2;
    const F one(1.0f);
    return select(Mask<F>(sin2 < one), sin2 / (one + safe_sqrt(one - sin2)), F(0.0f));
}

/// Density of uniform directions in a cone; 0 for an empty one.
template <class F>
SHARED_FN F cone_pdf(F one_minus_cos) {
    const Mask<F> valid = one_minus_cos > F(0.0f);
    return select(valid, F(0.5f * kInvPi) / select(valid, one_minus_cos, F(1.0f)), F(0.0f));
}

/// Squared sine of a sun's angular radius.
template <class F>
SHARED_FN F sun_sin2(const LightAt<F>& l) {
    return l.one_minus_cos * (F(2.0f) - l.one_minus_cos);
}

/// Radiance of a cone sun that gives E lux: E over the projected solid angle pi sin^2.
template <class F>
SHARED_FN Vec3<F> sun_radiance(const LightAt<F>& l) {
    return l.radiance * (F(kInvPi) / max(sun_sin2(l), least_divisor<F>(1e-30f)));
}

template <class F>
SHARED_FN LightSample<F> sample_directional(const LightOf<Real<F>>& light, const LightAt<F>& l, Vec2<F> u) {
    const Vec3<F> axis = -l.direction;
    if (is_delta(light)) return {axis, F(kFar), l.radiance, F(1.0f)};
    return {normalize(Frame<F>(axis).to_world(sample_cone(l.one_minus_cos, u))), F(kFar), sun_radiance(l),
            cone_pdf(l.one_minus_cos)};
}

/// Squared distance that can be divided by.
template <class F>
SHARED_FN F safe_distance2(Vec3<F> v) {
    return max(dot(v, v), least_divisor<F>(1e-20f));
}

template <class F>
SHARED_FN LightSample<F> sample_point(const LightOf<Real<F>>& light, const LightAt<F>& l, Vec3<F> p, Vec2<F> u) {
    const Vec3<F> to_centre = l.position - p;
    const F distance2 = safe_distance2(to_centre);
    const F distance = sqrt(distance2);
    const F inverse = F(1.0f) / distance;
    const Vec3<F> axis = to_centre * inverse;
    const Vec3<F> intensity = l.radiance * intensity_factor(light, l, axis, distance2);
    if (is_delta(light)) return {axis, distance, intensity * (inverse * inverse), F(1.0f)};
    const F radius2 = l.radius * l.radius;
    const F one_minus_cos = sphere_one_minus_cos(radius2, distance2);
    const Vec3<F> local = sample_cone(one_minus_cos, u);
    // Nearer of the two intersections; the square root is half of the chord inside the sphere.
    const F sin2 = local.x * local.x + local.y * local.y;
    const F reach = distance * local.z - safe_sqrt(radius2 - distance2 * sin2);
    return {normalize(Frame<F>(axis).to_world(local)), reach, intensity * (F(kInvPi) / radius2),
            cone_pdf(one_minus_cos)};
}

/// Area of the rectangle, m^2.
template <class F>
SHARED_FN F rectangle_area(const LightAt<F>& l) {
    return F(4.0f) * length(cross(l.axis_u, l.axis_v));
}

/// Uniform over the area. Against sampling the solid angle (Urena et al. 2013) this is noisier only where the panel
/// nearly touches the surface, and it has no cancellation for small or distant panels: the density is d^2 / (A cos).
template <class F>
SHARED_FN LightSample<F> sample_rectangle(const LightAt<F>& l, Vec3<F> p, Vec2<F> u) {
    const F a = u.x * F(2.0f) - F(1.0f);
    const F b = u.y * F(2.0f) - F(1.0f);
    const Vec3<F> to_light = l.position + l.axis_u * a + l.axis_v * b - p;
    const F distance2 = safe_distance2(to_light);
    const F distance = sqrt(distance2);
    const Vec3<F> direction = to_light * (F(1.0f) / distance);
    const F cos_light = -dot(direction, l.direction);
    const F projected = rectangle_area(l) * cos_light;
    const Mask<F> lit = projected > least_divisor<F>(1e-20f);
    const F zero(0.0f);
    return {direction, distance, select(lit, l.radiance, Vec3<F>{zero, zero, zero}),
            select(lit, distance2 / select(lit, projected, F(1.0f)), zero)};
}

/// A direction from p towards the light, with a density in which intersect_light agrees.
///
/// @param keys, count  the light over the shutter
/// @param time         [0, 1]
template <class F>
SHARED_FN LightSample<F> sample_light(const LightOf<Real<F>>* keys, int count, F time, Vec3<F> p, Vec2<F> u) {
    const LightAt<F> l = light_at<F>(keys, count, time);
    if (keys->kind == LightKind::directional) return sample_directional(*keys, l, u);
    if (keys->kind == LightKind::area) return sample_rectangle(l, p, u);
    return sample_point(*keys, l, p, u);
}

template <class F>
SHARED_FN LightHit<F> masked_hit(Mask<F> hit, F distance, Vec3<F> radiance, F pdf) {
    const F zero(0.0f);
    return {select(hit, distance, F(kFar)), select(hit, radiance, Vec3<F>{zero, zero, zero}), select(hit, pdf, zero)};
}

template <class F>
SHARED_FN LightHit<F> intersect_sun(const LightAt<F>& l, Vec3<F> direction) {
    // By the sine: the cosine of a quarter of a degree has three digits left.
    const Vec3<F> sine = cross(direction, l.direction);
    const Mask<F> hit = (dot(sine, sine) <= sun_sin2(l)) & (dot(direction, l.direction) < F(0.0f));
    return masked_hit<F>(hit, F(kFar), sun_radiance(l), cone_pdf(l.one_minus_cos));
}

template <class F>
SHARED_FN LightHit<F> intersect_sphere(const LightOf<Real<F>>& light, const LightAt<F>& l, Vec3<F> origin, Vec3<F> direction) {
    const Vec3<F> to_centre = l.position - origin;
    const F distance2 = safe_distance2(to_centre);
    const F along = dot(to_centre, direction);
    const Vec3<F> off_axis = to_centre - direction * along;
    const F radius2 = l.radius * l.radius;
    const F chord2 = radius2 - dot(off_axis, off_axis);
    const Mask<F> hit = (chord2 >= F(0.0f)) & (along > F(0.0f)) & (distance2 > radius2);
    const Vec3<F> axis = to_centre * (F(1.0f) / sqrt(distance2));
    const Vec3<F> radiance = l.radiance * (intensity_factor(light, l, axis, distance2) * (F(kInvPi) / radius2));
    return masked_hit<F>(hit, along - safe_sqrt(chord2), radiance, cone_pdf(sphere_one_minus_cos(radius2, distance2)));
}

template <class F>
SHARED_FN LightHit<F> intersect_rectangle(const LightAt<F>& l, Vec3<F> origin, Vec3<F> direction) {
    const F cos_light = -dot(direction, l.direction);
    const Mask<F> front = cos_light > least_divisor<F>(1e-20f);
    const Vec3<F> to_centre = l.position - origin;
    const F distance = -dot(to_centre, l.direction) / select(front, cos_light, F(1.0f));
    const Vec3<F> at = direction * distance - to_centre;
    const Mask<F> inside =
        (abs(dot(at, l.axis_u)) <= dot(l.axis_u, l.axis_u)) & (abs(dot(at, l.axis_v)) <= dot(l.axis_v, l.axis_v));
    const F projected = rectangle_area(l) * cos_light;
    const Mask<F> hit = front & inside & (distance > F(0.0f)) & (projected > least_divisor<F>(1e-20f));
    return masked_hit<F>(hit, distance, l.radiance, distance * distance / select(hit, projected, F(1.0f)));
}

/// What a ray meets of a light that is not a delta: a sphere, a rectangle (both from their outside), a cone sun.
///
/// @param direction  unit length
template <class F>
SHARED_FN LightHit<F> intersect_light(const LightOf<Real<F>>* keys, int count, F time, Vec3<F> origin, Vec3<F> direction) {
    const F zero(0.0f);
    if (is_delta(*keys)) return {F(kFar), {zero, zero, zero}, zero};
    const LightAt<F> l = light_at<F>(keys, count, time);
    if (keys->kind == LightKind::directional) return intersect_sun(l, direction);
    if (keys->kind == LightKind::area) return intersect_rectangle(l, origin, direction);
    return intersect_sphere(*keys, l, origin, direction);
}

template <class F>
SHARED_FN F rectangle_weight(const LightAt<F>& l, Vec3<F> p) {
    const Vec3<F> from_centre = p - l.position;
    const F height = dot(from_centre, l.direction);
    const F uu = max(dot(l.axis_u, l.axis_u), least_divisor<F>(1e-20f)), vv = max(dot(l.axis_v, l.axis_v), least_divisor<F>(1e-20f));
    const F a = clamp(dot(from_centre, l.axis_u) / uu, F(-1.0f), F(1.0f));
    const F b = clamp(dot(from_centre, l.axis_v) / vv, F(-1.0f), F(1.0f));
    const Vec3<F> nearest = from_centre - l.axis_u * a - l.axis_v * b;
    const F area = rectangle_area(l);
    const F distance2 = dot(nearest, nearest) + area * F(0.25f);
    // The cosine is that of the nearest point; a tenth keeps points beside the panel, which see it at a slant.
    const F cosine = max(height / sqrt(distance2), F(0.1f));
    return select(Mask<F>(height > F(0.0f)), luminance(l.radiance) * area * cosine / distance2, F(0.0f));
}

/// How often to choose this light for a point: for delta lights what it adds, luminance times max(n.w, 0); for the
/// others an estimate of the irradiance from the position alone, positive wherever light can arrive.
///
/// @param n  unit shading normal, on the side that is lit
template <class F>
SHARED_FN F light_weight(const LightOf<Real<F>>* keys, int count, F time, Vec3<F> p, Vec3<F> n) {
    const LightOf<Real<F>>& light = *keys;
    const LightAt<F> l = light_at<F>(keys, count, time);
    const F zero(0.0f);
    if (light.kind == LightKind::area) return rectangle_weight(l, p);
    if (light.kind == LightKind::directional) {
        const F lux = luminance(l.radiance);
        return is_delta(light) ? lux * max(-dot(n, l.direction), zero) : lux;
    }
    const Vec3<F> to_centre = l.position - p;
    const F distance2 = safe_distance2(to_centre);
    const Vec3<F> axis = to_centre * (F(1.0f) / sqrt(distance2));
    const F facing = luminance(l.radiance) * intensity_factor(light, l, axis, distance2) / distance2;
    if (is_delta(light)) return facing * max(dot(n, axis), zero);
    return select(Mask<F>(distance2 > l.radius * l.radius), facing, zero);
}

}  // namespace kadr::kernels
