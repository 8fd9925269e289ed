#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "film/error_estimate.h"
#include "film/film.h"
#include "render/frame_forecast.h"
#include "shot/shot.h"

namespace kadr {

/// Why a frame got no more samples than it did.
enum class SamplingStop { samples, max_error, at_most, time_budget };
/// "samples", "max_error", "at_most", "time_budget"
const char* name_of(SamplingStop stop);

/// What the sampling of a frame came to.
struct SamplingReport {
    SamplingStop stopped_by = SamplingStop::samples;
    std::uint32_t least = 0, most = 0;  ///< samples a pixel
    double mean = 0;
    ErrorEstimate error;
    double display_error = 0;  ///< root mean square of the pixels' standard errors, in values of the display
};
SamplingReport report_sampling(const Film& film, SamplingStop stopped_by, const ViewSpec& view, double scale);

/// Square of the standard error of every pixel in values of the display, mean over R, G, B, [y][x]: what the two halves
/// of the film differ by when each is looked at through the view. Infinite where nothing is known.
///
/// @param scale  of radiance in the picture over that in the film
std::vector<double> display_noise(const Film& film, const ViewSpec& view, double scale);
/// Rows whose noise is measured at once where a figure is all that is wanted: pictures of both halves would take as much
/// memory as a film.
inline constexpr int kNoiseRows = 64;

/// Deals out the samples of one frame, round by round: all pixels get as many until those that are good enough stop.
///
/// A pixel stops by what its neighbours know, not by its own samples: one that has missed every bright path so far
/// looks calm, and stopping it for that would make pictures too dark (the bias of sequential sampling). The window is 7
/// x 7 pixels without the pixel itself, so a stopping rule never sees what it stops. What the neighbours say is the
/// variance of one sample; the pixel's own number of samples makes an error of it.
class SampleSteering {
public:
    /// With a deadline the first round tells how fast the frame is: two samples a half.
    static constexpr int kTimingRound = 4;

    /// @param clock     seconds that the frame has taken so far
    /// @param budget_s  wall time for the frame; infinite: as long as it takes
    SampleSteering(const RenderSpec& render, double budget_s, ViewSpec view, double scale,
                   std::function<double()> clock);

    /// Whether next_round() looks at the film's sums, which then have to be at home.
    bool looks_at_film() const { return so_far_ > 0 && ((render_.max_error && so_far_ >= render_.at_least) || target_relmse_ > 0); }
    /// Samples that every active pixel gets next, even but for a fixed number and on the way to a target; 0: the frame is done.
    int next_round(const Film& film);
    /// [y][x], 0: done; null: all pixels go on.
    const std::uint8_t* active() const { return active_.empty() ? nullptr : active_.data(); }
    int samples_so_far() const { return so_far_; }
    SamplingStop stopped_by() const { return stop_; }
    /// Ends the frame, all of it, at a relative mean square error: where it is nearest to this one. What is left of the
    /// pixels' own stopping is what `max_error` says.
    void set_target(double relmse) { target_relmse_ = relmse; }
    /// Wall time for the frame from its begin on, beside what the shot sets.
    void set_budget(double seconds) { budget_s_ = seconds; }

private:
    int ladder_step() const;
    std::optional<int> until_target(const Film& film);
    bool update_active(const Film& film);
    int affordable(const Film& film) const;
    int stop(SamplingStop reason);

    RenderSpec render_;
    double budget_s_;
    ViewSpec view_;
    double scale_;
    std::function<double()> clock_;
    std::vector<std::uint8_t> active_;
    std::size_t active_count_ = 0;
    int so_far_ = 0;
    double target_relmse_ = 0;                          ///< 0: none
    std::optional<FrameForecast::Point> before_, last_;  ///< what the last rounds came to
    double rounds_begin_s_ = 0;
    double pixel_samples_ = 0;  ///< dealt so far
    SamplingStop stop_ = SamplingStop::samples;
};

}  // namespace kadr
