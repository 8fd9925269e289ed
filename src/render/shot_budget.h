#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

namespace kadr {

/// Deals the wall time of a shot to its frames, so that all end with about the same error: a frame that is twice as
/// difficult gets twice the time. How difficult a frame is, is known when its first round is done; of the frames to
/// come it is taken to be what it was on average. What a frame does not use is passed on to those after it.
///
/// Several devices have as many times the wall time that is left, less what was dealt to the frames that they render.
class ShotBudget {
public:
    ShotBudget() = default;
    /// @param seconds  for the whole shot; absent: no limit
    /// @param clock    seconds since the shot began
    ShotBudget(std::optional<double> seconds, std::function<double()> clock, std::size_t devices = 1);

    /// What the next frame of a device asks when it knows its difficulty (error times time); null without a limit. May
    /// be asked by any thread.
    /// @param frames_left  that no device has begun
    /// @return a function from the difficulty to seconds from the frame's begin, which is now
    std::function<double(double difficulty)> dealer(int frames_left, std::size_t device = 0);

private:
    double deal(double difficulty, int frames_left, std::size_t device, double begin_s);

    std::optional<double> seconds_;
    std::function<double()> clock_;
    double devices_ = 1;
    std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
    double difficulty_sum_ = 0;
    int frames_ = 0;
    std::map<std::size_t, double> until_s_;  ///< by device: the end of the time that its frame was dealt
};

}  // namespace kadr
