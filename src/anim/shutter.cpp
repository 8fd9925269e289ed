#include "anim/shutter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kadr {

namespace {

using Key = ShutterCurve::Key;

/// Integral of the line from key to key, up to x.
double below(const Key& from, const Key& to, double x) {
    const double width = to.fraction - from.fraction, passed = std::clamp(x - from.fraction, 0.0, width);
    if (!(width > 0)) return 0;
    return passed * (from.efficiency + 0.5 * (to.efficiency - from.efficiency) * passed / width);
}

double passed_by_keys(const std::vector<Key>& keys, double x) {
    double sum = below({0, keys.front().efficiency}, keys.front(), x);
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) sum += below(keys[i], keys[i + 1], x);
    return sum + below(keys.back(), {1, keys.back().efficiency}, x);
}

}  // namespace

double light_passed(const ShutterCurve& curve, double fraction) {
    const double x = std::clamp(fraction, 0.0, 1.0);
    switch (curve.shape) {
        case ShutterCurve::Shape::box: return x;
        case ShutterCurve::Shape::triangle: return x < 0.5 ? x * x : 0.5 - (1 - x) * (1 - x);
        case ShutterCurve::Shape::smooth: return 0.5 * x - std::sin(2 * std::numbers::pi * x) / (4 * std::numbers::pi);
        case ShutterCurve::Shape::keys: return passed_by_keys(curve.keys, x);
    }
    return x;
}

double open_length_s(const Shutter& shutter, Rational fps) {
    return (shutter.close_frames - shutter.open_frames) / fps.value() + (shutter.close_s - shutter.open_s);
}

double exposure_factor(const Shutter& shutter, Rational fps) {
    if (!shutter.physical) return 1;
    return open_length_s(shutter, fps) * fps.value() * light_passed(shutter.curve, 1);
}

}  // namespace kadr
