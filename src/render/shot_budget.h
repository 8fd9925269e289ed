#pragma once

#include <functional>
#include <optional>

namespace kadr {

/// Deals the wall time of a shot to its frames, so that all end with about the same error: a frame that is twice as
/// difficult gets twice the time. How difficult a frame is, is known when its first round is done; of the frames to
/// come it is taken to be what it was on average. What a frame does not use is passed on to those after it.
class ShotBudget {
public:
    ShotBudget() = default;
    /// @param seconds  for the whole shot; absent: no limit
    /// @param clock    seconds since the shot began
    ShotBudget(std::optional<double> seconds, std::function<double()> clock);

    /// What the next frame asks when it knows its difficulty (error times time); null without a limit.
    /// @param frames_left  after this one
    /// @return a function from the difficulty to seconds from the frame's begin, which is now
    std::function<double(double difficulty)> dealer(int frames_left);

private:
    std::optional<double> seconds_;
    std::function<double()> clock_;
    double difficulty_sum_ = 0;
    int frames_ = 0;
};

}  // namespace kadr
