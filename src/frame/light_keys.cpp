#include "frame/light_keys.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "frame/decompose.h"
#include "frame/key_grid.h"
#include "frame/problem.h"
#include "frame/view_axes.h"

namespace kadr {

namespace {

constexpr int kMostLightSegments = 32;

using ExactLight = kernels::LightOf<double>;

kernels::Vec3<double> to_vec(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
kernels::Vec3f to_float(const kernels::Vec3<double>& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

kernels::Light to_float(const ExactLight& exact) {
    kernels::Light light{};
    light.radiance = to_float(exact.radiance);
    light.kind = exact.kind;
    light.falloff = exact.falloff;
    light.position = to_float(exact.position);
    light.direction = to_float(exact.direction);
    light.axis_u = to_float(exact.axis_u);
    light.axis_v = to_float(exact.axis_v);
    light.cos_inner = static_cast<float>(exact.cos_inner);
    light.cos_outer = static_cast<float>(exact.cos_outer);
    light.inner_rad = static_cast<float>(exact.inner_rad);
    light.outer_rad = static_cast<float>(exact.outer_rad);
    light.range = static_cast<float>(exact.range);
    light.radius = static_cast<float>(exact.radius);
    light.one_minus_cos = static_cast<float>(exact.one_minus_cos);
    return light;
}

glm::dvec3 direction_of(const BoundShot& shot, const LightSpec& spec, const glm::dvec3& position, double time_s) {
    glm::dvec3 direction = evaluate(spec.direction, time_s);
    if (spec.look_at) {
        const auto* point = std::get_if<PositionTrack>(&*spec.look_at);
        direction = (point ? evaluate(*point, time_s) : shot.bindings().position_of(std::get<NodeReference>(*spec.look_at), time_s)) - position;
    }
    const double length = glm::length(direction);
    if (length > 0 && std::isfinite(length)) return direction / length;
    if (spec.kind == LightKind::point) return {0, 0, -1};
    throw InputError(problem_at(spec.where, fmt::format("light '{}' has no direction at {} s", spec.id, format_number(time_s)),
                                spec.look_at ? "expected look_at to be another point than position" : "expected a direction other than [0, 0, 0]"));
}

void set_cone(ExactLight& light, double inner_rad, double outer_rad) {
    // What the shot says was checked; clips may drive one angle beyond the other, and it is held there as at any limit.
    inner_rad = std::min(inner_rad, outer_rad);
    light.inner_rad = inner_rad;
    light.outer_rad = outer_rad;
    light.cos_inner = std::cos(inner_rad);
    light.cos_outer = std::cos(outer_rad);
}

/// From metres relative to the origin to units.
ExactLight in_units(ExactLight light, double unit_m) {
    const double per_unit = 1 / unit_m;  // exact: a power of two
    light.position = light.position * per_unit;
    light.axis_u = light.axis_u * per_unit;
    light.axis_v = light.axis_v * per_unit;
    light.range *= per_unit;
    light.radius *= per_unit;
    // Lux at a metre is candela; a radiance has no length in it.
    if (light.kind == kernels::LightKind::point || light.kind == kernels::LightKind::spot) light.radiance = light.radiance * (per_unit * per_unit);
    return light;
}

void set_rectangle(ExactLight& light, const glm::dvec3& direction, const glm::dvec2& size_m) {
    const ViewAxes axes = view_axes(direction, {0, 1, 0});
    light.axis_u = to_vec(0.5 * size_m.x * axes.right);
    light.axis_v = to_vec(0.5 * size_m.y * axes.up);
}

/// 1 - cos of a sun's angular radius; 0, a parallel beam, where it is narrower than what the directions of rays, which are
/// floats, tell apart.
double sun_one_minus_cos(double radius_rad) {
    constexpr double kNarrowest_rad = 0x1p-23;
    if (radius_rad < kNarrowest_rad) return 0;
    const double half = std::sin(0.5 * radius_rad);
    return 2 * half * half;
}

/// Relative to `origin`, metres.
ExactLight light_at(const BoundShot& shot, const LightSpec& spec, double time_s, const glm::dvec3& origin) {
    ExactLight light{};
    const glm::dvec3 position = evaluate(spec.position, time_s);
    const glm::dvec3 direction = direction_of(shot, spec, position, time_s);
    light.radiance = to_vec(evaluate(spec.color, time_s) * evaluate(spec.strength, time_s));
    light.kind = static_cast<kernels::LightKind>(spec.kind);
    light.falloff = static_cast<kernels::SpotFalloff>(spec.falloff);
    light.direction = to_vec(direction);
    if (spec.kind == LightKind::directional) {
        light.one_minus_cos = sun_one_minus_cos(0.5 * evaluate(spec.angular_diameter_rad, time_s));
        return light;
    }
    light.position = to_vec(position - origin);
    light.range = evaluate(spec.range_m, time_s);
    if (spec.kind == LightKind::area) {
        set_rectangle(light, direction, evaluate(spec.size_m, time_s));
    } else {
        light.radius = evaluate(spec.radius_m, time_s);
        set_cone(light, evaluate(spec.inner_rad, time_s), evaluate(spec.outer_rad, time_s));
    }
    return light;
}

int light_of(const BoundShot& shot, int node) { return shot.scene().nodes[static_cast<std::size_t>(node)].light; }

const std::vector<DrivenProperty>& driven_of(const BoundShot& shot, int node) {
    const Bindings& bindings = shot.bindings();
    return bindings.properties.of(bindings.rig.file_of(node), PropertyOwner::light, light_of(shot, node));
}

/// A light of a file with what its clips drive.
SceneLight source_at(const BoundShot& shot, const LightSeed& seed, double time_s) {
    SceneLight light = shot.scene().lights[static_cast<std::size_t>(light_of(shot, seed.node))];
    for (const DrivenProperty& driven : driven_of(shot, seed.node)) {
        const auto value = [&](const auto& own) { return driven.value(own, time_s, seed.clip_offset_s()); };
        if (driven.property == Property::light_color) light.color = value(light.color);
        else if (driven.property == Property::light_intensity) light.intensity = value(light.intensity);
        else if (driven.property == Property::light_range) light.range_m = driven.distance(light.range_m, time_s, seed.clip_offset_s());
        else if (driven.property == Property::light_inner) light.inner_rad = value(light.inner_rad);
        else if (driven.property == Property::light_outer) light.outer_rad = value(light.outer_rad);
    }
    return light;
}

/// KHR_lights_punctual: along the node's -z; scale has no meaning for a light.
ExactLight light_at(const BoundShot& shot, const LightSeed& seed, double time_s, const glm::dvec3& origin) {
    const SceneLight source = source_at(shot, seed, time_s);
    const glm::dmat4 world = shot.bindings().node_transform(seed.node, seed.copy, time_s);
    const double length = glm::length(glm::dvec3(world[2]));
    if (!is_finite(world))
        throw InputError(problem_of_node(shot, seed.node, "has a light, and a transform that is not finite,", time_s, "expected finite translations and scales"));
    ExactLight light{};
    light.radiance = to_vec(source.color * source.intensity);
    light.kind = source.kind;
    light.direction = to_vec(length > 0 ? -glm::dvec3(world[2]) / length : glm::dvec3(0, 0, -1));
    if (source.kind == kernels::LightKind::directional) return light;
    light.position = to_vec(glm::dvec3(world[3]) - origin);
    light.range = source.range_m;
    set_cone(light, source.inner_rad, source.outer_rad);
    return light;
}

template <class Source>
ExactLight light_at(const BoundShot& shot, const Source& source, double time_s, const RenderSpace& space) {
    return in_units(light_at(shot, source, time_s, space.origin), space.unit_m);
}

/// Member by member: the bytes between them hold anything.
bool same(const kernels::Light& a, const kernels::Light& b) {
    const auto numbers = [](const kernels::Light& light) {
        const auto& [radiance, kind, falloff, p, d, u, v, cos_inner, cos_outer, inner, outer, range, radius, angular] = light;
        return std::tuple(radiance.x, radiance.y, radiance.z, kind, falloff, p.x, p.y, p.z, d.x, d.y, d.z, u.x, u.y, u.z, v.x, v.y, v.z, cos_inner, cos_outer, inner, outer,
                          range, radius, angular);
    };
    return numbers(a) == numbers(b);
}

double length_of(const kernels::Vec3f& v) { return std::sqrt(static_cast<double>(dot(v, v))); }

/// How far half-way values lie from the true ones, as SceneSnapshot::light_error has it.
/// @param subject_distance  in the units of the lights
double deviation(const kernels::Light& a, const kernels::Light& b, double u, const kernels::Light& wanted, double subject_distance) {
    const auto t = static_cast<float>(u);
    const auto off = [t](const kernels::Vec3f& from, const kernels::Vec3f& to, const kernels::Vec3f& is, double scale) {
        const double distance = length_of(from + (to - from) * t - is);
        return distance > 0 ? distance / scale : 0;
    };
    const auto off_by = [u](double from, double to, double is, double scale) {
        const double distance = std::abs(std::lerp(from, to, u) - is);
        return distance > 0 ? distance / scale : 0;
    };
    const double brightness = std::max(length_of(a.radiance), length_of(b.radiance));
    const double size = length_of(a.axis_u) + length_of(a.axis_v);
    return std::max({off(a.radiance, b.radiance, wanted.radiance, brightness), off(a.position, b.position, wanted.position, subject_distance),
                     off(a.direction, b.direction, wanted.direction, 1), off(a.axis_u, b.axis_u, wanted.axis_u, size), off(a.axis_v, b.axis_v, wanted.axis_v, size),
                     off_by(a.cos_inner, b.cos_inner, wanted.cos_inner, 1), off_by(a.cos_outer, b.cos_outer, wanted.cos_outer, 1),
                     off_by(a.inner_rad, b.inner_rad, wanted.inner_rad, 1), off_by(a.outer_rad, b.outer_rad, wanted.outer_rad, 1),
                     off_by(a.radius, b.radius, wanted.radius, std::max(a.radius, b.radius)), off_by(a.range, b.range, wanted.range, std::max(a.range, b.range)),
                     off_by(a.one_minus_cos, b.one_minus_cos, wanted.one_minus_cos, std::max(a.one_minus_cos, b.one_minus_cos))});  // of the solid angle
}

/// A light that has a surface at one key has one at all, however small: the kernels choose how to sample it once.
void keep_surface(std::vector<kernels::Light>& keys) {
    constexpr float kSmallest = 1e-3f;  // of the largest
    float radius = 0, one_minus_cos = 0;
    for (const kernels::Light& key : keys) radius = std::max(radius, key.radius), one_minus_cos = std::max(one_minus_cos, key.one_minus_cos);
    for (kernels::Light& key : keys) {
        key.radius = std::max(key.radius, kSmallest * radius);
        key.one_minus_cos = std::max(key.one_minus_cos, kSmallest * one_minus_cos);
    }
}

template <class Visit>
void visit_tracks(const LightSpec& spec, Visit visit) {
    visit(spec.strength);
    visit(spec.color);
    visit(spec.position);
    visit(spec.direction);
    if (spec.look_at)
        if (const auto* point = std::get_if<PositionTrack>(&*spec.look_at)) visit(*point);
    visit(spec.inner_rad);
    visit(spec.outer_rad);
    visit(spec.range_m);
    visit(spec.radius_m);
    visit(spec.angular_diameter_rad);
    visit(spec.size_m);
    visit(spec.visible);
}

void append(std::vector<double>& all, const std::vector<double>& more) { all.insert(all.end(), more.begin(), more.end()); }

std::vector<double> key_times_of(const BoundShot& shot, const LightSpec& spec, double open_s, double close_s) {
    std::vector<double> times;
    visit_tracks(spec, [&](const auto& track) { append(times, key_times(track, open_s, close_s)); });
    if (!spec.look_at) return times;
    if (const auto* target = std::get_if<NodeReference>(&*spec.look_at))
        if (const int node = shot.node_of(*target); node >= 0) append(times, shot.bindings().key_times_of(node, open_s, close_s));
    return times;
}

/// Deviation of evenly spaced keys at a quarter, the half and three quarters of every step, and where tracks have keys of
/// their own: corners stray farthest in themselves.
/// @param at  (u in [0, 1]) -> the true light
template <class At>
double worst_deviation(const std::vector<kernels::Light>& keys, const std::vector<double>& corners, double distance, At at) {
    double worst = 0;
    const auto look = [&](double u) {
        const double position = u * static_cast<double>(keys.size() - 1);
        const std::size_t from = std::min(static_cast<std::size_t>(position), keys.size() - 2);
        worst = std::max(worst, deviation(keys[from], keys[from + 1], position - static_cast<double>(from), at(u), distance));
    };
    const std::size_t checks = 4 * (keys.size() - 1);
    for (std::size_t i = 1; i < checks; ++i)
        if (i % 4 != 0) look(static_cast<double>(i) / static_cast<double>(checks));
    for (const double u : corners) look(u);
    return worst;
}

/// @return the key times where the light misses its tolerance, else none
template <class At>
std::vector<double> add_keys(const std::vector<double>& times_s, double open_s, double close_s, double distance, At at, SceneSnapshot& snapshot) {
    const auto at_step = [&](double u) { return at(open_s + u * (close_s - open_s)); };
    std::vector<kernels::Light> keys{at(open_s)};
    double error = 0;
    if (close_s > open_s) {
        std::vector<double> key_times = times_s;
        for (double& time : key_times) time = (time - open_s) / (close_s - open_s);
        const int base = even_segments_for(key_times);
        int at_least = static_cast<int>(std::min<std::size_t>(key_times.size() + 1, kMostLightSegments));
        for (;; at_least = 2 * static_cast<int>(keys.size() - 1)) {
            keys = fit_keys(base, at_least, kMostLightSegments, at_step, same,
                            [distance](const kernels::Light& a, const kernels::Light& b, double u, const kernels::Light& wanted) {
                                return deviation(a, b, u, wanted, distance) <= kLightTolerance;
                            });
            error = keys.size() > 1 ? worst_deviation(keys, key_times, distance, at_step) : 0;
            if (error <= kLightTolerance || 2 * static_cast<int>(keys.size() - 1) > kMostLightSegments) break;
        }
        snapshot.light_error = std::max(snapshot.light_error, error);
    }
    keep_surface(keys);
    snapshot.lights.push_back({static_cast<std::uint32_t>(snapshot.light_keys.size()), static_cast<std::uint32_t>(keys.size())});
    snapshot.light_keys.insert(snapshot.light_keys.end(), keys.begin(), keys.end());
    return error > kLightTolerance ? times_s : std::vector<double>();
}

std::vector<double> key_times_of(const BoundShot& shot, const LightSeed& seed, double open_s, double close_s) {
    std::vector<double> times = shot.bindings().rig.key_times_of(seed.node, open_s, close_s, seed.clip_offset_s());
    for (const DrivenProperty& driven : driven_of(shot, seed.node)) append(times, driven.key_times(open_s, close_s, seed.clip_offset_s()));
    return times;
}

}  // namespace

std::vector<double> add_light_keys(const BoundShot& shot, double open_s, double close_s, SceneSnapshot& snapshot) {
    const RenderSpace space = snapshot.space();
    const double distance = camera_at(shot, open_s).subject_distance / space.unit_m;
    const double middle_s = 0.5 * (open_s + close_s);  // switches do not change within a part of the shutter
    std::vector<double> missed;
    for (const LightSpec& spec : shot.shot().lights)
        if (is_on(spec.visible, middle_s))
            append(missed, add_keys(key_times_of(shot, spec, open_s, close_s), open_s, close_s, distance,
                                    [&](double time) { return to_float(light_at(shot, spec, time, space)); }, snapshot));
    const VisibilityRig::States states = shot.bindings().visibility.at(middle_s);
    for (const LightSeed& seed : shot.bindings().lights)
        if (states.visible(seed.node, seed.clip_offset_s()))
            append(missed, add_keys(key_times_of(shot, seed, open_s, close_s), open_s, close_s, distance,
                                    [&](double time) { return to_float(light_at(shot, seed, time, space)); }, snapshot));
    return missed;
}

std::vector<kernels::LightOf<double>> lights_at(const BoundShot& shot, double time_s, double switch_s, const RenderSpace& space) {
    std::vector<ExactLight> lights;
    for (const LightSpec& spec : shot.shot().lights)
        if (is_on(spec.visible, switch_s)) lights.push_back(light_at(shot, spec, time_s, space));
    const VisibilityRig::States states = shot.bindings().visibility.at(switch_s);
    for (const LightSeed& seed : shot.bindings().lights)
        if (states.visible(seed.node, seed.clip_offset_s())) lights.push_back(light_at(shot, seed, time_s, space));
    return lights;
}

std::vector<double> light_discontinuities(const BoundShot& shot, double begin_s, double end_s) {
    std::vector<double> times;
    for (const LightSpec& spec : shot.shot().lights)
        visit_tracks(spec, [&](const auto& track) { append(times, discontinuities(track, begin_s, end_s)); });
    for (const LightSeed& seed : shot.bindings().lights)
        for (const DrivenProperty& driven : driven_of(shot, seed.node)) append(times, driven.discontinuities(begin_s, end_s, seed.clip_offset_s()));
    return times;
}

}  // namespace kadr
