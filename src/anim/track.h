#pragma once

#include <array>
#include <optional>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kadr {

enum class Interpolation { step, linear, smooth, cubic };

/// CSS timing function of the segment that starts at a key: control points (x1, y1), (x2, y2) of a cubic Bézier from
/// (0,0) to (1,1), x in [0,1].  Source: CSS Easing Functions Level 1, 2.2.
using Ease = std::array<double, 4>;

template <class T>
struct Key {
    double time_s = 0;
    T value{};
    std::optional<Ease> ease;     ///< shapes the segment that starts here
    T in_tangent{}, out_tangent{}; ///< per second; used by Interpolation::cubic alone (glTF's CUBICSPLINE)
    bool operator==(const Key&) const = default;
};

/// A value over time: one key means a constant; outside the keys the end values hold.
/// T: double, glm::dvec2, glm::dvec3 (linear per component) or glm::dquat (slerp by the shorter arc; smooth is squad;
/// cubic is glTF's componentwise spline, then normalised).
template <class T>
struct Track {
    std::vector<Key<T>> keys;  ///< strictly ascending times; never empty once parsed
    Interpolation interpolation = Interpolation::linear;

    Track() = default;
    /*implicit*/ Track(T constant) : keys{Key<T>{0, constant, {}, {}, {}}} {}
    bool operator==(const Track&) const = default;
    bool is_constant() const { return keys.size() <= 1; }
};

/// Value at a time in seconds. Quaternions come back normalised.
template <class T>
T evaluate(const Track<T>& track, double time_s);

/// Times inside (begin, end) where the value jumps (step keys): a shutter has to be split there.
template <class T>
std::vector<double> discontinuities(const Track<T>& track, double begin_s, double end_s);

/// Times of keys inside (begin, end): where the derivative may jump.
template <class T>
std::vector<double> key_times(const Track<T>& track, double begin_s, double end_s);

/// A rotation over time: quaternion keys, or a fixed axis with a keyed angle, which may turn any number of times.
struct RotationTrack {
    Track<glm::dquat> orientation{glm::dquat(1, 0, 0, 0)};
    struct AxisAngle {
        glm::dvec3 axis{0, 1, 0};   ///< unit length
        Track<double> angle_rad{0.0};
        bool operator==(const AxisAngle&) const = default;
    };
    std::optional<AxisAngle> axis_angle;  ///< wins over orientation where present
    bool operator==(const RotationTrack&) const = default;
};
glm::dquat evaluate(const RotationTrack& track, double time_s);

/// Translation, rotation, scale; parent_from_child = T * R * S.
struct TransformTrack {
    Track<glm::dvec3> translate{glm::dvec3(0)};
    RotationTrack rotate;
    Track<glm::dvec3> scale{glm::dvec3(1)};
    bool operator==(const TransformTrack&) const = default;
    bool is_constant() const;
};
glm::dmat4 evaluate(const TransformTrack& track, double time_s);

/// R = Rz * Ry * Rx of degrees about fixed axes, x first.
glm::dquat rotation_from_degrees(glm::dvec3 degrees);

}  // namespace kadr
