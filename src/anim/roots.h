#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace kadr {

/// Real solutions of a x^2 + b x + c = 0, ascending; none where everything or nothing solves it.
/// Source: Numerical Recipes, 3rd ed., 5.6 (no difference of nearly equal numbers).
inline std::vector<double> quadratic_roots(double a, double b, double c) {
    const double discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0) || (a == 0 && b == 0)) return {};
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    if (a == 0) return {-c / b};
    if (q == 0) return {0};
    const double one = q / a, other = c / q;
    return {std::min(one, other), std::max(one, other)};
}

}  // namespace kadr
