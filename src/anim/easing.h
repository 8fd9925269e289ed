#pragma once

#include <array>
#include <vector>

namespace kadr {

/// CSS timing function of the segment that starts at a key: control points (x1, y1), (x2, y2) of a cubic Bézier from
/// (0,0) to (1,1), x in [0,1].  Source: CSS Easing Functions Level 1, 2.2.
using Ease = std::array<double, 4>;

/// The curve's y where its x is `u`; outside [0, 1] u itself.
double eased(const Ease& ease, double u);

/// dy/dx at the start (u = 0) or the end (u = 1) of the curve; 0 where it begins or ends vertically, as CSS has it
/// (Easing Functions Level 2, 2.3).
double slope_at_end(const Ease& ease, bool at_end);

/// Every u in (0, 1) at which the curve turns, up to down or down to up.
std::vector<double> turning_points(const Ease& ease);

/// Every u in (0, 1) at which the curve's y has a value; up to rounding, and turning points that only touch it left out.
std::vector<double> crossings(const Ease& ease, double y);

}  // namespace kadr
