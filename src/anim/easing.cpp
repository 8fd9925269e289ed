#include "anim/easing.h"

#include <cmath>

namespace kadr {

namespace {

double bezier(double p1, double p2, double u) {
    const double v = 1 - u;
    return ((3 * v * p1) * v + 3 * u * v * p2 + u * u) * u;
}

double bezier_slope(double p1, double p2, double u) {
    const double v = 1 - u;
    return 3 * v * v * p1 + 6 * u * v * (p2 - p1) + 3 * u * u * (1 - p2);
}

/// The curve's parameter where its x is given: Newton where the slope allows, inside a bracket that bisection shrinks.
double parameter_at(const Ease& ease, double x) {
    double low = 0, high = 1, u = x;
    for (int step = 0; step < 64; ++step) {
        const double error = bezier(ease[0], ease[2], u) - x;
        if (std::abs(error) < 1e-15) break;
        (error > 0 ? high : low) = u;
        const double slope = bezier_slope(ease[0], ease[2], u);
        const double newton = slope > 1e-9 ? u - error / slope : low - 1;
        u = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return u;
}

}  // namespace

double eased(const Ease& ease, double u) {
    if (u <= 0 || u >= 1) return u;
    return bezier(ease[1], ease[3], parameter_at(ease, u));
}

double slope_at_end(const Ease& ease, bool at_end) {
    const Ease e = at_end ? Ease{1 - ease[2], 1 - ease[3], 1 - ease[0], 1 - ease[1]} : ease;
    if (e[0] > 0) return e[1] / e[0];
    if (e[1] != 0) return 0;
    return e[2] > 0 ? e[3] / e[2] : 0;
}

}  // namespace kadr
