// One lane of double: what kernels compute in when they serve as the reference of their other forms. A GPU's compiler
// never reads this file.
#pragma once

#include "kernels/math/scalar.h"

namespace kadr::kernels {

/// Random numbers, indices and masks are those of the float form: both follow the same samples.
template <> struct Traits<double> {
    static constexpr int kLanes = 1;
    using Real = double;
    using Mask = bool;
    using Int = int;
    using UInt = unsigned;
};

SHARED_FN double select(bool m, double a, double b) { return m ? a : b; }
SHARED_FN double lane(double a, int) { return a; }
SHARED_FN void set_lane(double& a, int, double x) { a = x; }

SHARED_FN double min(double a, double b) { return a < b ? a : b; }
SHARED_FN double max(double a, double b) { return a > b ? a : b; }
SHARED_FN int truncate(double a) { return static_cast<int>(a); }
SHARED_FN double sqrt(double a) { return __builtin_sqrt(a); }
SHARED_FN double floor(double a) { return __builtin_floor(a); }
SHARED_FN double abs(double a) { return __builtin_fabs(a); }
SHARED_FN double copy_sign(double a, double s) { return __builtin_copysign(a, s); }
SHARED_FN bool is_finite(double a) { return __builtin_isfinite(a); }
SHARED_FN double acos(double a) { return __builtin_acos(a); }
/// sin(2 pi u) and cos(2 pi u).
SHARED_FN void sincos_2pi(double u, double& s, double& c) {
    const double angle = (u - __builtin_floor(u)) * 6.283185307179586477;
    s = __builtin_sin(angle);
    c = __builtin_cos(angle);
}

}  // namespace kadr::kernels
