#pragma once

// A wedge that turns about the middle of an image while the shutter is open: what it covers, and where its blur begins
// and ends, to a fraction of a pixel.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "film/film.h"

namespace kadr::test {

inline constexpr double kHalfWedge = 0.15;  ///< radians: half of what the wedge takes

/// Share of the time for which the mark covers a direction: a trapezoid, whole turns on top of each other.
inline double arc_coverage(double theta, double turned) {
    double covered = 0;
    for (double around = theta - 2 * std::numbers::pi * std::ceil(turned / (2 * std::numbers::pi) + 1);
         around <= turned + kHalfWedge; around += 2 * std::numbers::pi)
        covered += std::max(0.0, std::min(around + kHalfWedge, turned) - std::max(around - kHalfWedge, 0.0));
    return covered / turned;
}

struct ArcPoint {
    double theta, coverage;  ///< theta in [0, 2 pi)
};

/// Pixels between two radii of the disc, by direction.
inline std::vector<ArcPoint> arc_of(const Image& image, double inner_px, double outer_px) {
    std::vector<ArcPoint> points;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double dx = x + 0.5 - 0.5 * image.width, dy = 0.5 * image.height - (y + 0.5), r = std::hypot(dx, dy);
            if (r < inner_px || r > outer_px) continue;
            points.push_back(
                {std::fmod(std::atan2(dy, dx) + 2 * std::numbers::pi, 2 * std::numbers::pi), image.at(x, y, 3)});
        }
    return points;
}

/// Where a rising or falling edge of coverage passes half of `plateau`: the line through the points around `near`.
inline double edge_at(const std::vector<ArcPoint>& points, double near, double plateau) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const ArcPoint& p : points) {
        const double x = std::remainder(p.theta - near, 2 * std::numbers::pi);
        if (std::abs(x) > 0.7 * kHalfWedge) continue;
        n += 1, sx += x, sy += p.coverage, sxx += x * x, sxy += x * p.coverage;
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx), level = (sy - slope * sx) / n;
    return (0.5 * plateau - level) / slope;
}

/// Radius in pixels up to which a blurred sector of directions is covered, from its integrated coverage: the area that
/// the pixels of the sector beyond `inner_px` hold, each by the part of it that lies there, over the plateau.
inline double reach_of(const Image& image, double from_theta, double to_theta, double inner_px, double plateau) {
    constexpr int kSteps = 16;
    double covered = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            int inside = 0;
            for (int i = 0; i < kSteps * kSteps; ++i) {
                const double dx = x + (i % kSteps + 0.5) / kSteps - 0.5 * image.width,
                             dy = 0.5 * image.height - (y + (i / kSteps + 0.5) / kSteps);
                const double theta = std::fmod(std::atan2(dy, dx) + 2 * std::numbers::pi, 2 * std::numbers::pi);
                inside += std::hypot(dx, dy) > inner_px && theta > from_theta && theta < to_theta;
            }
            if (inside > 0) covered += image.at(x, y, 3) * inside / (kSteps * kSteps);
        }
    return std::sqrt(inner_px * inner_px + 2 * covered / (plateau * (to_theta - from_theta)));
}

/// The radius that reach_of finds where a wedge ends in a chord: the root of the mean square of its distance.
inline double reach_of_chord(double radius_px) {
    return radius_px * std::cos(kHalfWedge) * std::sqrt(std::tan(kHalfWedge) / kHalfWedge);
}

}  // namespace kadr::test
