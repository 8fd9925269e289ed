#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "anim/timing.h"

namespace kadr {

/// What a number of the shot file measures. Inside, everything is SI: but lens (millimetres, as lenses are sold),
/// pixels and frames.
enum class Quantity {
    number,
    angle,
    time,
    length,
    lens,
    pixels,
    frames,
    illuminance,
    intensity,
    luminance,
    power,
    stops,
    gain
};

/// A unit that may follow a number: value_inside = number * multiplier / divisor. The first of a quantity's units is
/// its natural one, which a bare number has.
struct UnitSpec {
    const char* name;
    Quantity quantity;
    double multiplier, divisor;  ///< two factors, so that 35 mm is exactly the double nearest to 0.035
};

/// All units, a quantity's natural one first.
const std::vector<UnitSpec>& unit_table();

/// Natural unit of a quantity ("deg"), empty for a plain number.
std::string_view natural_unit(Quantity quantity);
/// "mm, cm, m"
std::string unit_names(Quantity quantity);
/// A number in the natural unit as the inside value.
double from_natural(Quantity quantity, double value);

/// What became of the text of a number.
struct ParsedQuantity {
    enum class Problem { none, not_a_number, not_finite, out_of_range, wrong_unit } problem = Problem::none;
    double value = 0;        ///< inside unit
    std::string unit;        ///< as written; the offending one for wrong_unit
    bool in_frames = false;  ///< a time written in frames: `value` is the number of frames
};

/// Parses "24 mm", "2.5s", "180 deg", "12 f" or a bare number; a time also as a fraction, "1/48 s". Hexadecimal, ".inf" and ".nan" are no numbers here.
/// Times in frames come back as frames (`in_frames`): their seconds depend on the shot.
ParsedQuantity parse_quantity(std::string_view text, Quantity quantity);

/// Seconds of a number of frames: exact in the fraction, rounded once.
double seconds_of_frames(double frames, Rational fps);

}  // namespace kadr
