#pragma once

#include <cstdint>

namespace kadr {

/// An exact fraction in lowest terms with a positive denominator; frame times are fractions so that 24000/1001
/// never drifts.
struct Rational {
    std::int64_t numerator = 0, denominator = 1;
    double value() const { return static_cast<double>(numerator) / static_cast<double>(denominator); }
    bool operator==(const Rational&) const = default;
};
/// Lowest terms. @throws std::overflow_error where 64 bits do not hold the result
Rational make_rational(std::int64_t numerator, std::int64_t denominator);
Rational operator*(Rational a, Rational b);
Rational operator/(Rational a, Rational b);
Rational operator+(Rational a, Rational b);

}  // namespace kadr
