// Goodness-of-fit for samplers.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "kernels/math/wide.h"

namespace kadr::kernels {

/// Independent uniform numbers, a fixed sequence.
class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float operator()() { return static_cast<float>(engine_() >> 8) * (1.0f / 16777216.0f); }
    Vec2f pair() {
        const float x = (*this)();
        return {x, (*this)()};
    }

private:
    std::mt19937 engine_;
};

/// Probability that a gamma variable of shape a exceeds x.  Source: Numerical Recipes 6.2 (series, continued fraction).
inline double upper_gamma(double a, double x) {
    if (x <= 0.0) return 1.0;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1.0) {
        double term = 1.0 / a, sum = term;
        for (int n = 1; n < 10000 && term > sum * 1e-15; ++n) sum += term *= x / (a + n);
        return 1.0 - front * sum;
    }
    double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
    for (int n = 1; n < 10000; ++n) {
        const double an = -n * (n - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1.0) < 1e-15) break;
    }
    return front * h;
}

/// p-value of counts against expectations. Bins that expect fewer than 5 are pooled.
inline double chi2_p_value(const std::vector<double>& counts, const std::vector<double>& expected) {
    double statistic = 0.0, pooled_count = 0.0, pooled_expected = 0.0;
    int bins = 0;
    const auto add = [&](double count, double expectation) {
        statistic += (count - expectation) * (count - expectation) / expectation;
        ++bins;
    };
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (expected[i] >= 5.0) {
            add(counts[i], expected[i]);
        } else {
            pooled_count += counts[i];
            pooled_expected += expected[i];
        }
    }
    if (pooled_expected >= 5.0)
        add(pooled_count, pooled_expected);
    else if (pooled_count > pooled_expected + 30.0)
        return 0.0;  // samples where (nearly) none may be
    return bins > 1 ? upper_gamma(0.5 * (bins - 1), 0.5 * statistic) : 1.0;
}

/// Smallest p-value to accept in each of `tests` tests, for 1 % false alarms over all of them (Sidak).
inline double sidak(int tests) { return 1.0 - std::pow(0.99, 1.0 / tests); }

/// The sphere cut into rings and sectors around an axis. Rings lie dense at the axis: 1 - cos = 2 t^power, t even in
/// [0, t_max].
struct SphereBins {
    Vec3f axis;
    int power = 1;
    double t_max = 1.0;
    int rings = 24, sectors = 24;
    int steps = 16;  ///< integration points per bin and dimension

    int bin(Vec3f d) const {
        // From the chord: the cosine has no digits near the axis.
        const Vec3f chord = d - axis;
        const double t = std::pow(0.25 * dot(chord, chord), 1.0 / power) / t_max;
        const Vec3f local = Frame<float>(axis).to_local(d);
        const double phi = std::atan2(local.y, local.x) / (2.0 * M_PI) + 0.5;
        if (t >= 1.0) return rings * sectors;
        return std::min(rings - 1, static_cast<int>(t * rings)) * sectors +
               std::min(sectors - 1, static_cast<int>(phi * sectors));
    }

    Vec3f direction(double t, double phi) const {
        const double one_minus_cos = 2.0 * std::pow(t * t_max, power);
        const double s = std::sqrt(std::max(0.0, one_minus_cos * (2.0 - one_minus_cos)));
        const double angle = (phi - 0.5) * 2.0 * M_PI;
        return normalize(Frame<float>(axis).to_world(Vec3f{static_cast<float>(s * std::cos(angle)),
                                                           static_cast<float>(s * std::sin(angle)),
                                                           static_cast<float>(1.0 - one_minus_cos)}));
    }

    /// Integral of a density over each bin; the last element is what remains of 1.
    std::vector<double> integrate(const std::function<double(Vec3f)>& pdf) const {
        std::vector<double> result(static_cast<std::size_t>(rings) * sectors + 1, 0.0);
        double rest = 1.0;
        const double dt = 1.0 / (rings * steps), dphi = 1.0 / (sectors * steps);
        for (int i = 0; i < rings * steps; ++i) {
            const double t = (i + 0.5) * dt;
            const double solid_angle = 2.0 * power * std::pow(t * t_max, power - 1) * t_max * dt * 2.0 * M_PI * dphi;
            for (int j = 0; j < sectors * steps; ++j) {
                const double p = pdf(direction(t, (j + 0.5) * dphi)) * solid_angle;
                result[static_cast<std::size_t>(i / steps) * sectors + j / steps] += p;
                rest -= p;
            }
        }
        result.back() = std::max(0.0, rest);
        return result;
    }
};

/// Tests a sampler of directions: `sample` returns false for "no direction".
inline void expect_directions_follow(const std::string& name, const SphereBins& bins, int count, int tests,
                                     const std::function<bool(Random&, Vec3f&)>& sample,
                                     const std::function<double(Vec3f)>& pdf) {
    std::vector<double> expected = bins.integrate(pdf);
    for (double& e : expected) e *= count;
    std::vector<double> counts(expected.size(), 0.0);
    Random random(20231);
    for (int i = 0; i < count; ++i) {
        Vec3f d{0, 0, 0};
        ++counts[sample(random, d) ? static_cast<std::size_t>(bins.bin(d)) : counts.size() - 1];
    }
    EXPECT_GT(chi2_p_value(counts, expected), sidak(tests)) << name;
}

}  // namespace kadr::kernels
