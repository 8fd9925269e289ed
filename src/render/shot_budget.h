#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "render/frame_forecast.h"

namespace kadr {

/// When a frame of a shot with a budget ends.
struct FrameTarget {
    double relmse = 0;  ///< at this relative mean square error; 0: never by its error
    double most_s = 0;  ///< and at the latest after this wall time
    /// Asked after every round, with the wall time and the error so far: the target from there on. Absent: it stays.
    std::function<FrameTarget(double seconds, double relmse)> revise;
};

/// A frame that is to come.
struct PlannedFrame {
    int number = 0;
    bool free = false;                      ///< it is there already, or is an earlier one again
    std::optional<FrameForecast> forecast;  ///< absent: like the frames around it that have one
    double reached = 0;                     ///< relative mean square error of one that an earlier run left; 0: not known
};

/// Deals the wall time of a shot to its frames, so that all end with about the same error, and neighbours above all:
/// what the eye sees is noise that comes and goes.
///
/// All frames get one target, the error at which what is left of the time is just enough for what is left of the
/// frames, as forecast. Forecasts err, so the target follows, but from frame to frame by no more than kDrift: error,
/// not time, is what a frame gets of the machine's mood. The deadline comes first only where such steps could not hold
/// it any more. The first frame has no neighbour to be like: its target follows what its own rounds take, since a pilot on a
/// machine that is busy elsewhere may be off by any factor. Beside a frame that an earlier run left it is like that one.
///
/// Several devices have as many times the wall time that is left, less what the frames that they render will still take.
/// May be asked by any thread once it is planned.
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
    ShotBudget(std::optional<double> seconds, std::function<double()> clock, std::size_t devices = 1);

    bool limited() const { return seconds_.has_value(); }
    double remaining_s() const;
    /// All frames of the shot in their order. Without forecasts a frame gets its equal share of the time.
    void plan(std::vector<PlannedFrame> frames);

    /// Of a frame that a device begins now; none without a limit.
    std::optional<FrameTarget> begin(int frame, std::size_t device = 0);
    /// What the device began was rendered, and ended with this error.
    void end(double relmse, std::size_t device = 0);

private:
    struct UnderWay {
        std::size_t frame = 0;
        double begin_s = 0, until_s = 0;  ///< until_s: by its forecast
    };
    /// Of a frame that has no forecast, what those around it say.
    double pilot_s(std::size_t frame, double relmse) const;
    /// Of all frames from `first` on, as far as forecasts have been true so far.
    double forecast_s(std::size_t first, double relmse) const;
    /// The same when each of them errs by kDrift more than the one before, by `most` times in all at most.
    double drifting_s(std::size_t first, double relmse, double most) const;
    /// Of all devices, but for what others are busy with.
    double device_s(double now_s) const;
    FrameTarget revised(std::size_t device, double left_s, double seconds, double relmse);
    FrameTarget target_of(std::size_t frame, std::size_t device, double relmse, double left_s, double now_s);
    std::optional<double> reached_beside(std::size_t frame) const;
    FrameTarget equal_share(std::size_t first, double now_s) const;
    double longest_s(std::size_t frame, double relmse, double at_the_latest) const;

    std::optional<double> seconds_;
    std::function<double()> clock_;
    double devices_ = 1;
    std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
    std::vector<PlannedFrame> frames_;
    std::vector<std::size_t> known_;  ///< ascending: frames with a forecast
    std::vector<std::vector<double>>
        from_here_;              ///< [frame][error]: seconds of it and all after it, by their forecasts
    std::vector<double> taken_;  ///< of the last frames with a forecast: seconds over those of the forecast
    double doubt_ = 1;           ///< what is taken for such a ratio before there are some
    double trust_ = 1;           ///< what forecasts are to be multiplied by
    std::map<std::size_t, UnderWay> under_way_;  ///< by device
    std::optional<double> target_;               ///< relmse of the last frame
};

}  // namespace kadr
