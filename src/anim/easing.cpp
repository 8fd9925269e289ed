#include "anim/easing.h"

#include <cmath>

#include "anim/roots.h"

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

/// Curve parameters in (0, 1) between which its y only rises or only falls.
std::vector<double> turning_parameters(const Ease& ease) {
    // The slope of bezier_slope in powers of u.
    std::vector<double> turns = quadratic_roots(3 * ease[1] - 3 * ease[3] + 1, 2 * ease[3] - 4 * ease[1], ease[1]);
    std::erase_if(turns, [](double u) { return !(u > 0 && u < 1); });
    return turns;
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

std::vector<double> turning_points(const Ease& ease) {
    std::vector<double> points = turning_parameters(ease);
    for (double& u : points) u = bezier(ease[0], ease[2], u);
    return points;
}

std::vector<double> crossings(const Ease& ease, double y) {
    std::vector<double> ends = turning_parameters(ease), found;
    ends.push_back(1);
    double low = 0;
    for (const double end : ends) {
        const auto beyond = [&](double u) { return bezier(ease[1], ease[3], u) > y; };
        double inside = low, outside = end;
        low = end;
        if (beyond(inside) == beyond(outside)) continue;
        const bool side = beyond(inside);
        for (int step = 0; step < 60; ++step) {  // to the last bit of a double
            const double middle = 0.5 * (inside + outside);
            (beyond(middle) == side ? inside : outside) = middle;
        }
        found.push_back(bezier(ease[0], ease[2], outside));
    }
    return found;
}

}  // namespace kadr
