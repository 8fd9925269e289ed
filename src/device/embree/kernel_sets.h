#pragma once

#include <algorithm>
#include <array>
#include <memory>

#include "device/embree/tile_job.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// The sets of requirements that the drivers of the CPU are compiled for. A frame gets the first that holds what it
/// needs. One source file a list and width, so that the lists compile beside each other.
///
/// A feature has a bit of its own where leaving it out is worth more than 2 % of a frame's processor time: CHANGELOG.md
/// lists what was tried.
namespace kernel_sets {
using namespace kernels::requirement;

inline constexpr unsigned kSmooth = kMirrors | kIor | kFresnel;
inline constexpr std::array kPlainPath{0u, kEmitters, kTransforms, kTransforms | kEmitters, kSmooth | kTransforms | kEmitters};
inline constexpr std::array kMapsPath{kMaps,
                                      kMaps | kEmitters,
                                      kMaps | kTransforms,
                                      kMaps | kTransforms | kEmitters,
                                      kMaps | kSmooth | kTransforms | kEmitters,
                                      kMaps | kSpecials | kEmitters,
                                      kMaps | kSpecials | kTransforms | kEmitters,
                                      kAll};
/// Without kEmitters and kMirrors: the analytic model meets no lights and has no narrower lobes. Indices of refraction and
/// Fresnel's equations are in the largest set.
inline constexpr std::array kDirect{0u,
                                    kTransforms,
                                    kMaps,
                                    kMaps | kTransforms,
                                    kMaps | kSpecials | kTransforms,
                                    kAll & ~kEmitters & ~kMirrors};

constexpr bool holds(unsigned set, unsigned needs) { return (needs & ~set) == 0; }

/// @pre the last set of the list holds what is needed
template <std::size_t N>
constexpr unsigned first_with(const std::array<unsigned, N>& sets, unsigned needs) {
    return *std::find_if(sets.begin(), sets.end() - 1, [&](unsigned set) { return holds(set, needs); });
}
}  // namespace kernel_sets

/// The set that the driver is compiled for that renders what needs `needs`.
constexpr unsigned compiled_set(kernels::IntegratorKind integrator, unsigned needs) {
    using namespace kernel_sets;
    if (integrator == kernels::IntegratorKind::direct) return first_with(kDirect, needs & kDirect.back());
    return holds(kPlainPath.back(), needs) ? first_with(kPlainPath, needs) : first_with(kMapsPath, needs);
}

/// @param width  1, or 8 on processors with AVX2
/// @param set    of compiled_set
std::unique_ptr<TileDriver> make_tile_driver(int width, kernels::IntegratorKind integrator, unsigned set);

// One in each of the source files driver_*.cpp. @return null for what is not in the list
namespace portable {
TileDriver* make_plain_path(unsigned set);
TileDriver* make_maps_path(unsigned set);
TileDriver* make_direct(unsigned set);
}  // namespace portable
namespace avx2 {
TileDriver* make_plain_path(unsigned set);
TileDriver* make_maps_path(unsigned set);
TileDriver* make_direct(unsigned set);
}  // namespace avx2

}  // namespace kadr
