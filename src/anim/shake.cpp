#include "anim/shake.h"

#include <cmath>
#include <numbers>

#include "anim/position.h"

namespace kadr {

namespace {

constexpr int kBands = 12;

/// splitmix64 (Steele, Lea & Flood 2014), as a hash of a counter: uniform in [0, 1).
double uniform(std::uint64_t seed, std::uint64_t counter) {
    std::uint64_t z = seed + (counter + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

double signal(double time_s, double frequency_hz, std::uint64_t seed, std::uint64_t counter) {
    double sum = 0, weights = 0;
    for (int band = 0; band < kBands; ++band) {
        const std::uint64_t own = counter + 2 * static_cast<std::uint64_t>(band);
        const double cycles = frequency_hz * (band + uniform(seed, own)) / kBands * time_s + uniform(seed, own + 1);
        const double weight = 1.0 / (band + 1);
        sum += weight * std::sin(2 * std::numbers::pi * (cycles - std::floor(cycles)));
        weights += weight;
    }
    return sum / weights;
}

}  // namespace

glm::dvec3 band_limited_noise(double time_s, double frequency_hz, std::uint64_t seed, std::uint64_t channel) {
    glm::dvec3 value(0);
    for (int axis = 0; axis < 3; ++axis)
        value[axis] = signal(time_s, frequency_hz, seed, (channel * 3 + static_cast<std::uint64_t>(axis)) * 2 * kBands);
    return value;
}

ShakeOffset evaluate(const Shake& shake, double time_s) {
    return {evaluate(shake.amplitude_m, time_s) * band_limited_noise(time_s, shake.frequency_hz, shake.seed, 0),
            evaluate(shake.angle_rad, time_s) * band_limited_noise(time_s, shake.frequency_hz, shake.seed, 1)};
}

std::vector<double> discontinuities(const Shake& shake, double begin_s, double end_s) {
    return merged(discontinuities(shake.amplitude_m, begin_s, end_s), discontinuities(shake.angle_rad, begin_s, end_s));
}

std::vector<double> key_times(const Shake& shake, double begin_s, double end_s) {
    const std::vector<double> keys = merged(key_times(shake.amplitude_m, begin_s, end_s), key_times(shake.angle_rad, begin_s, end_s));
    constexpr double kSamplesOfACycle = 4;
    return merged(keys, even_times(begin_s, end_s, kSamplesOfACycle * shake.frequency_hz * (end_s - begin_s)));
}

}  // namespace kadr
