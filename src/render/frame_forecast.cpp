#include "render/frame_forecast.h"

#include <algorithm>
#include <cmath>

namespace kadr {

double convergence_between(const FrameForecast::Point& a, const FrameForecast::Point& b) {
    constexpr double kLeast = 0.8, kMost = 2;
    if (!(a.relmse > 0) || !(b.relmse > 0) || !(b.samples > a.samples)) return 1;
    return std::clamp(std::log(a.relmse / b.relmse) / std::log(b.samples / a.samples), kLeast, kMost);
}

double FrameForecast::samples_for(double relmse) const {
    if (curve.empty()) return least_samples;
    // The first segment whose end is good enough; beyond the last one its power goes on, before the first one 1.
    std::size_t at = 0;
    while (at < curve.size() && curve[at].relmse > relmse) ++at;
    const Point& from = curve[at == 0 ? 0 : at - 1];
    const double power = at == 0             ? 1
                         : curve.size() == 1 ? 1
                                             : convergence_between(curve[std::min(at, curve.size() - 1) - 1],
                                                                   curve[std::min(at, curve.size() - 1)]);
    double samples = from.samples * std::pow(from.relmse / std::max(relmse, 1e-30), 1 / power);
    if (at > 0 && at < curve.size()) samples = std::min(samples, curve[at].samples);
    return std::clamp(samples, least_samples, std::max(least_samples, most_samples));
}

}  // namespace kadr
