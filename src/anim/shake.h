#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "anim/track.h"

namespace kadr {

/// Three independent signals of time in [-1, 1]: smooth, the same for the same seed, and without any frequency above
/// `frequency_hz`. A sum of sinusoids, one at a random frequency in each of twelve equal bands and with a random phase;
/// slow ones are stronger (1/f), as those of a hand are.  Source: Shinozuka & Jan 1972, "Digital simulation of random
/// processes and its applications" (spectral representation).
/// @param channel  another number gives other signals of the same seed
glm::dvec3 band_limited_noise(double time_s, double frequency_hz, std::uint64_t seed, std::uint64_t channel);

/// A camera that is not quite still: offsets along and turns about its own axes (x right, y up, z back).
struct Shake {
    Track<glm::dvec3> amplitude_m{glm::dvec3(0)};  ///< largest offset
    Track<glm::dvec3> angle_rad{glm::dvec3(0)};    ///< largest turn: pitch, yaw, roll
    double frequency_hz = 3;                       ///< nothing moves faster
    std::uint64_t seed = 0;
    bool operator==(const Shake&) const = default;
};
struct ShakeOffset {
    glm::dvec3 offset_m, turn_rad;
};
ShakeOffset evaluate(const Shake& shake, double time_s);
std::vector<double> discontinuities(const Shake& shake, double begin_s, double end_s);
std::vector<double> key_times(const Shake& shake, double begin_s, double end_s);

}  // namespace kadr
