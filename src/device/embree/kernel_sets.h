#pragma once

#include <algorithm>
#include <array>

#include "kernels/scene/scene_view.h"

namespace kadr {

namespace kernel_sets {
using namespace kernels::requirement;

/// The sets of requirements that the drivers of the CPU are compiled for, by integrator; the cheapest come first, and
/// the last holds everything.
inline constexpr std::array kPath{0u, kEmitters, kMaps | kEmitters, kMaps | kTransforms | kEmitters,
                                  kMaps | kTransforms | kEmitters | kDeformation};
inline constexpr std::array kDirect{0u, kMaps | kTransforms, kMaps | kTransforms | kDeformation};

/// The first set of a list that holds what is needed; what nothing there holds is no part of the integrator.
template <std::size_t N>
constexpr unsigned first_with(const std::array<unsigned, N>& sets, unsigned needs) {
    const unsigned known = needs & sets.back();
    return *std::find_if(sets.begin(), sets.end(), [&](unsigned set) { return (known & ~set) == 0; });
}
}  // namespace kernel_sets

/// The set that the driver is compiled for that renders what needs `needs`.
constexpr unsigned compiled_set(kernels::IntegratorKind integrator, unsigned needs) {
    return integrator == kernels::IntegratorKind::direct ? kernel_sets::first_with(kernel_sets::kDirect, needs)
                                                         : kernel_sets::first_with(kernel_sets::kPath, needs);
}

}  // namespace kadr
