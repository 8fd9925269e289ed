#pragma once

#include <array>
#include <optional>
#include <type_traits>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "anim/easing.h"
#include "anim/extrapolation.h"

namespace kadr {

enum class Interpolation { step, linear, smooth, cubic };

template <class T>
inline constexpr bool kIsRotation = std::is_same_v<T, glm::dquat>;

/// Which way and how often a rotation turns on its way to the next key.
struct Spin {
    int turns = 0;          ///< whole turns beside the way to the next key; negative: backwards
    glm::dvec3 axis{0};     ///< unit, in the frame that the rotation maps to: the turn runs counterclockwise about it, up
                            ///< to one turn without `turns`. Zero: the shorter arc's own axis
    bool operator==(const Spin&) const = default;
};
struct NoSpin {
    bool operator==(const NoSpin&) const = default;
};

template <class T>
struct Key {
    double time_s = 0;
    T value{};
    std::optional<Ease> ease;      ///< shapes the segment that starts here
    T in_tangent{}, out_tangent{}; ///< per second; used by Interpolation::cubic alone (glTF's CUBICSPLINE)
    /// Rotations: of the segment that starts here, under linear and smooth.
    [[no_unique_address]] std::conditional_t<kIsRotation<T>, std::optional<Spin>, NoSpin> spin{};
    bool operator==(const Key&) const = default;
};

/// A value over time: one key means a constant.
/// T: double, glm::dvec2, glm::dvec3 (linear per component) or glm::dquat (slerp by the shorter arc unless a key says
/// otherwise; smooth is squad; cubic is glTF's componentwise spline, then normalised).
template <class T>
struct Track {
    std::vector<Key<T>> keys;  ///< strictly ascending times; never empty once parsed
    Interpolation interpolation = Interpolation::linear;
    Extrapolation before = Extrapolation::hold, after = Extrapolation::hold;  ///< without effect on a single key
    bool overshoot = true;  ///< false: smooth never leaves the range of the two keys around it (not for rotations)

    Track() = default;
    /*implicit*/ Track(T constant) : keys{Key<T>{0, constant, {}, {}, {}}} {}
    bool operator==(const Track&) const = default;
    bool is_constant() const { return keys.size() <= 1; }
};

/// Value at a time in seconds. Where it jumps the later value holds. Quaternions come back normalised.
template <class T>
T evaluate(const Track<T>& track, double time_s);

/// As many times as the two functions below list.
inline constexpr std::size_t kMostListedTimes = 1024;

/// Times inside (begin, end), ascending, where the value jumps (step keys, seams of a repeated span): a shutter has to
/// be split there.
/// @throws InputError  for more than kMostListedTimes jumps
template <class T>
std::vector<double> discontinuities(const Track<T>& track, double begin_s, double end_s);

/// Times of keys inside (begin, end), ascending, where the derivative may jump; those of repeated spans too. The first
/// kMostListedTimes of them: no grid of samples meets more.
template <class T>
std::vector<double> key_times(const Track<T>& track, double begin_s, double end_s);

/// Whether the value ever changes.
template <class T>
bool varies(const Track<T>& track);

/// How far a number goes in (begin, end), there and back from key to key added up; jumps are left out.
double travel_of(const Track<double>& track, double begin_s, double end_s);
/// Radians that the rotation turns in (begin, end), likewise.
double turn_of(const Track<glm::dquat>& track, double begin_s, double end_s);

}  // namespace kadr
