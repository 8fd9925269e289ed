#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "anim/rational.h"
#include "anim/shutter.h"

namespace kadr {

/// Which frames a shot has and how fast they run.
struct Timing {
    Rational fps{24, 1};
    std::vector<int> frames{0};  ///< ascending, unique; the shot's whole range ("0-95x2, 120")
    int first = 0;               ///< the frame number at t = 0
    bool operator==(const Timing&) const = default;
};

/// One frame of the sequence: exact time and the shutter's seconds.
struct FrameTime {
    int number = 0;
    Rational time;                  ///< seconds, exact
    /// The shutter, from the first line's opening to the last line's closing; equal without motion blur.
    double open_s = 0, close_s = 0;
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
