#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "render/frame_forecast.h"

namespace kadr {

/// When a frame of a shot with a budget ends.
struct FrameTarget {
    double relmse = 0;  ///< at this relative mean square error; 0: never by its error
    double most_s = 0;  ///< and at the latest after this wall time
};

/// A frame that is to come.
struct PlannedFrame {
    int number = 0;
    bool free = false;                      ///< it is there already, or is an earlier one again
    std::optional<FrameForecast> forecast;  ///< absent: like the frames around it that have one
};

/// Deals the wall time of a shot to its frames, so that all end with about the same error, and neighbours above all:
/// what the eye sees is noise that comes and goes.
///
/// All frames get one target, the error at which what is left of the time is just enough for what is left of the
/// frames, as forecast. Forecasts err, so the target follows, but from frame to frame by no more than kDrift: error,
/// not time, is what a frame gets of the machine's mood. The deadline comes first only where such steps could not hold
/// it any more.
class ShotBudget {
public:
    /// Of the relative error of two neighbours. Half of what may be: the other half is chance.
    static constexpr double kDrift = 1.02;
    /// Of the error, from here to the end of the shot: beyond that the deadline is kept by a larger step now.
    static constexpr double kMostDrift = 2;
    /// The same for the sake of one frame that takes more than its share: a few fireflies must not eat up the time of
    /// all.
    static constexpr double kMostForOne = 1.25;

    ShotBudget() = default;
    /// @param seconds  for the whole shot; absent: no limit
    /// @param clock    seconds since the shot began
    ShotBudget(std::optional<double> seconds, std::function<double()> clock);

    bool limited() const { return seconds_.has_value(); }
    double remaining_s() const;
    /// All frames of the shot in their order. Without forecasts a frame gets its equal share of the time.
    void plan(std::vector<PlannedFrame> frames);

    /// Of a frame that begins now; none without a limit.
    std::optional<FrameTarget> begin(int frame);
    /// It was rendered, and ended with this error.
    void end(double relmse);

private:
    /// Of a frame that has no forecast, what those around it say.
    double pilot_s(std::size_t frame, double relmse) const;
    /// Of all frames from `first` on, as far as forecasts have been true so far.
    double forecast_s(std::size_t first, double relmse) const;
    /// The same when each of them errs by kDrift more than the one before, by `most` times in all at most.
    double drifting_s(std::size_t first, double relmse, double most) const;
    FrameTarget equal_share() const;
    double longest_s(double relmse, double at_the_latest) const;

    std::optional<double> seconds_;
    std::function<double()> clock_;
    std::vector<PlannedFrame> frames_;
    std::vector<std::size_t> known_;  ///< ascending: frames with a forecast
    std::vector<std::vector<double>>
        from_here_;              ///< [frame][error]: seconds of it and all after it, by their forecasts
    std::vector<double> taken_;  ///< of the last frames with a forecast: seconds over those of the forecast
    double trust_ = 1;           ///< what forecasts are to be multiplied by
    std::size_t current_ = 0;
    double begin_s_ = 0;
    std::optional<double> target_;  ///< relmse of the last frame
};

}  // namespace kadr
