// One lane: what kernels do with a float, an int, an unsigned and a bool where F is float.
// kernels/math/double.h has what they do with a double.
#pragma once

#include "kernels/math/platform.h"

namespace kadr::kernels {

template <class F> struct Traits;
template <> struct Traits<float> {
    static constexpr int kLanes = 1;
    using Real = float;
    using Mask = bool;
    using Int = int;
    using UInt = unsigned;
};
template <class F> inline constexpr int kLanes = Traits<F>::kLanes;
/// What one lane of F holds: float; double where F is double.
template <class F> using Real = typename Traits<F>::Real;
template <class F> using Mask = typename Traits<F>::Mask;
template <class F> using Int = typename Traits<F>::Int;
template <class F> using UInt = typename Traits<F>::UInt;

SHARED_FN bool any(bool m) { return m; }
SHARED_FN bool all(bool m) { return m; }
/// Bit i is lane i.
SHARED_FN unsigned bits(bool m) { return m ? 1u : 0u; }
SHARED_FN float select(bool m, float a, float b) { return m ? a : b; }
SHARED_FN int select(bool m, int a, int b) { return m ? a : b; }
SHARED_FN unsigned select(bool m, unsigned a, unsigned b) { return m ? a : b; }
SHARED_FN bool select(bool m, bool a, bool b) { return m ? a : b; }

SHARED_FN float lane(float a, int) { return a; }
SHARED_FN int lane(int a, int) { return a; }
SHARED_FN unsigned lane(unsigned a, int) { return a; }
SHARED_FN bool lane(bool a, int) { return a; }
SHARED_FN void set_lane(float& a, int, float x) { a = x; }
SHARED_FN void set_lane(int& a, int, int x) { a = x; }
SHARED_FN void set_lane(unsigned& a, int, unsigned x) { a = x; }
SHARED_FN void set_lane(bool& a, int, bool x) { a = x; }

SHARED_FN float min(float a, float b) { return a < b ? a : b; }  // b where either is NaN, as the vector instruction
SHARED_FN float max(float a, float b) { return a > b ? a : b; }
SHARED_FN int truncate(float a) { return static_cast<int>(a); }

}  // namespace kadr::kernels
