#pragma once

#include <vector>

namespace kadr {

/// What a frame takes, and how its error falls with its samples, as far as a pilot of a few of its pixels tells.
struct FrameForecast {
    struct Point {
        double samples, relmse;  ///< samples a pixel; relative mean square error with them
    };
    double setup_s = 0;        ///< wall time before the first sample
    double sample_s = 0;       ///< wall time of one sample of every pixel
    double least_samples = 1;  ///< a pixel, whatever the error
    double most_samples = 0;
    std::vector<Point> curve;  ///< ascending samples; empty: nothing is noisy

    /// Samples a pixel that leave this relative mean square error. Between the points a power of the samples, as beyond
    /// the last one.
    double samples_for(double relmse) const;
    double seconds_for(double relmse) const { return setup_s + sample_s * samples_for(relmse); }
};

/// The power p of error ~ samples^-p between two points. Independent samples have 1, Sobol points in smooth pictures up
/// to 2; what is beyond that is chance. 1 where it is not known.
double convergence_between(const FrameForecast::Point& a, const FrameForecast::Point& b);

}  // namespace kadr
