#include "frame/environment_at.h"

#include <numbers>

#include "frame/bindings.h"
#include "frame/change.h"

namespace kadr {

namespace {

constexpr glm::dvec3 kSky{0.53, 0.81, 0.92};
constexpr double kWidestTurn = 0.5 * std::numbers::pi / 180;

bool has_lights(const BoundShot& shot) { return !shot.shot().lights.empty() || !shot.bindings().lights.empty(); }

/// Colour * strength, or the factor on the image.
glm::dvec3 radiance_at(const EnvironmentSpec& spec, double time_s) {
    const double strength = evaluate(spec.strength, time_s);
    return spec.image ? glm::dvec3(strength) : evaluate(spec.color, time_s) * strength;
}

/// Mean over an interval by Simpson's rule between keys: exact where colour and strength are linear, or one of them is a cubic.
glm::dvec3 mean_radiance(const EnvironmentSpec& spec, double begin_s, double end_s) {
    if (!(end_s > begin_s)) return radiance_at(spec, begin_s);
    std::vector<double> times = merged(key_times(spec.color, begin_s, end_s), key_times(spec.strength, begin_s, end_s));
    times.push_back(end_s);
    glm::dvec3 sum(0);
    for (double from = begin_s; const double to : times) {
        sum += (to - from) / 6 * (radiance_at(spec, from) + 4.0 * radiance_at(spec, 0.5 * (from + to)) + radiance_at(spec, to));
        from = to;
    }
    return sum / (end_s - begin_s);
}

}  // namespace

EnvironmentSnapshot environment_over(const BoundShot& shot, double begin_s, double end_s) {
    const EnvironmentSpec& spec = shot.shot().environment;
    const double time_s = 0.5 * (begin_s + end_s);
    const glm::vec3 radiance(spec.given ? mean_radiance(spec, begin_s, end_s) : has_lights(shot) ? glm::dvec3(0) : kSky);
    EnvironmentSnapshot environment;
    environment.radiance = {radiance.x, radiance.y, radiance.z};
    environment.visible = spec.visible;
    if (!spec.given) return environment;
    environment.image = spec.image;
    environment.rotate_rad = static_cast<float>(evaluate(spec.rotate_rad, time_s));
    return environment;
}

bool environment_changes_fast(const BoundShot& shot, double begin_s, double end_s) {
    const EnvironmentSpec& spec = shot.shot().environment;
    if (!spec.given) return false;
    if (spec.image && spreads(sampled(begin_s, end_s, [&](double time) { return evaluate(spec.rotate_rad, time); }), kWidestTurn)) return true;
    for (int channel = 0; channel < 3; ++channel)
        if (bends(sampled(begin_s, end_s, [&](double time) { return radiance_at(spec, time)[channel]; }))) return true;
    return false;
}

std::vector<double> environment_discontinuities(const EnvironmentSpec& environment, double begin_s, double end_s) {
    std::vector<double> times = discontinuities(environment.color, begin_s, end_s);
    for (const Track<double>* track : {&environment.strength, &environment.rotate_rad}) {
        const std::vector<double> more = discontinuities(*track, begin_s, end_s);
        times.insert(times.end(), more.begin(), more.end());
    }
    return times;
}

}  // namespace kadr
