#pragma once

#include <vector>

#include "anim/rational.h"

namespace kadr {

/// How much light the shutter lets through while it is open, as a function of the fraction of that time.
struct ShutterCurve {
    /// box: all of it throughout. triangle: linearly up to all of it half-way, and down again. smooth: the same with
    /// a raised cosine, (1 - cos 2 pi x) / 2. keys: linearly between keys, the first and the last hold outside.
    enum class Shape { box, triangle, smooth, keys } shape = Shape::box;
    struct Key {
        double fraction = 0, efficiency = 1;  ///< both in [0, 1]
        bool operator==(const Key&) const = default;
    };
    std::vector<Key> keys;  ///< ascending; at least one is above 0; of Shape::keys
    bool operator==(const ShutterCurve&) const = default;
};

/// Integral of the curve from 0 to a fraction of the open time, in [0, 1]. Fractions outside [0, 1] clamp.
double light_passed(const ShutterCurve& curve, double fraction);

/// A sensor that is read line by line: the first line opens with the shutter, each later one a little after it.
struct RollingShutter {
    /// The way from the first line to the last.
    enum class Direction { none, down, up, left, right } direction = Direction::none;
    double duration_s = 0;  ///< how much later the last line opens
    bool operator==(const RollingShutter&) const = default;
};

/// When the shutter opens and closes relative to the frame's time; equal: no motion blur.
struct Shutter {
    double open_frames = 0, close_frames = 0.5;
    double open_s = 0, close_s = 0;  ///< added to them: what is given as a time keeps it at any frame rate
    ShutterCurve curve{};
    RollingShutter rolling{};
    bool physical = false;  ///< a longer exposure is brighter; see exposure_factor
    bool operator==(const Shutter&) const = default;
};

/// Seconds for which one line is open.
double open_length_s(const Shutter& shutter, Rational fps);

/// What radiance is multiplied with: 1, or for a physical exposure the light that passes against that of a shutter
/// which is wide open for a whole frame. 180 degrees are one stop less, as on a film camera.
double exposure_factor(const Shutter& shutter, Rational fps);

}  // namespace kadr
