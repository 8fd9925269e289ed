#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace kadr {

/// An exact fraction in lowest terms with a positive denominator; frame times are fractions so that 24000/1001
/// never drifts.
struct Rational {
    std::int64_t numerator = 0, denominator = 1;
    double value() const { return static_cast<double>(numerator) / static_cast<double>(denominator); }
    bool operator==(const Rational&) const = default;
};
/// Lowest terms. @throws std::overflow_error where 64 bits do not hold the result
Rational make_rational(std::int64_t numerator, std::int64_t denominator);
Rational operator*(Rational a, Rational b);
Rational operator/(Rational a, Rational b);
Rational operator+(Rational a, Rational b);

/// Which frames a shot has and how fast they run.
struct Timing {
    Rational fps{24, 1};
    std::vector<int> frames{0};  ///< ascending, unique; the shot's whole range ("0-95x2, 120")
    int first = 0;               ///< the frame number at t = 0
    bool operator==(const Timing&) const = default;
};

/// When the shutter opens and closes, in frames relative to the frame's time; open == close means no motion blur.
struct Shutter {
    double open_frames = 0, close_frames = 0.5;
    bool operator==(const Shutter&) const = default;
};

/// One frame of the sequence: exact time and the shutter's seconds.
struct FrameTime {
    int number = 0;
    Rational time;                  ///< seconds, exact
    double open_s = 0, close_s = 0; ///< shutter; open_s == close_s without motion blur
    double time_s() const { return time.value(); }
};

/// Frame numbers to times. Every time is computed from the frame number alone, never accumulated.
class Sequence {
public:
    Sequence(Timing timing, Shutter shutter);
    FrameTime frame(int number) const;
    const Timing& timing() const { return timing_; }
    /// The frame nearest to a time in seconds (`kadr preview --time`), and a FrameTime at exactly that time.
    FrameTime at_time(double seconds) const;

private:
    Timing timing_;
    Shutter shutter_;
};

/// Parses "0-95", "0-95x2", "5,9,12-20" into ascending unique frame numbers.
/// @throws InputError (no location) for reversed ranges, a step of zero, empty parts, more than 1,000,000 frames,
///         numbers beyond ±10,000,000, or other text
std::vector<int> parse_frame_list(std::string_view text);

}  // namespace kadr
