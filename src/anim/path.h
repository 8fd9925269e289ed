#pragma once

#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

namespace kadr {

/// A smooth curve through points, addressed by arc length: equal steps of the parameter are equal distances, whatever
/// the spacing of the points. Between points a centripetal Catmull-Rom spline: it has no loops or cusps within a segment
/// and keeps close to the polygon.  Source: Yuksel, Schaefer & Keyser 2011, "Parameterization and applications of
/// Catmull-Rom curves". An open curve leaves its ends straight towards the neighbours.
/// Lengths are those of 5-point Gauss-Legendre quadrature over spans that are halved until both halves agree with the
/// whole to 1e-10 of the curve's length.
class Path {
public:
    Path() = default;
    /// @param points  two or more, closed three or more; neighbours (closed: the last and the first, too) are distinct
    Path(std::vector<glm::dvec3> points, bool closed);

    const std::vector<glm::dvec3>& points() const { return points_; }
    bool closed() const { return closed_; }
    std::size_t segment_count() const { return segments_.size(); }
    double length() const { return length_; }

    /// @param fraction  of the length; an open path ends at 0 and 1, a closed one goes round again
    glm::dvec3 position(double fraction) const;
    /// Unit, the way the fraction grows; zero where the curve turns back on itself in a point.
    glm::dvec3 tangent(double fraction) const;

    bool operator==(const Path& other) const { return closed_ == other.closed_ && points_ == other.points_; }

private:
    /// Polynomial of u in [0, 1].
    struct Segment {
        glm::dvec3 c0, c1, c2, c3;
        glm::dvec3 at(double u) const { return c0 + u * (c1 + u * (c2 + u * c3)); }
        glm::dvec3 slope(double u) const { return c1 + u * (2.0 * c2 + u * 3.0 * c3); }
        double length(double from, double to) const;
    };
    /// Part of a segment over which the quadrature is exact enough.
    struct Span {
        std::size_t segment;
        double from, to;     ///< of u
        double start_m;      ///< length of the curve before it
    };
    struct Place {
        std::size_t segment;
        double u;
    };
    Segment segment_between(std::size_t from) const;
    void add_spans(std::size_t segment, double from, double to, double length, double tolerance, int depth);
    Place place(double fraction) const;

    std::vector<glm::dvec3> points_;
    bool closed_ = false;
    std::vector<Segment> segments_;
    std::vector<Span> spans_;
    double length_ = 0;
};

}  // namespace kadr
