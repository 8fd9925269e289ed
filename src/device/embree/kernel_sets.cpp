#include "device/embree/kernel_sets.h"

namespace kadr {
namespace {

struct Makers {
    TileDriver* (*plain_path)(unsigned set);
    TileDriver* (*maps_path)(unsigned set);
    TileDriver* (*direct)(unsigned set);
};
constexpr Makers kPortable{portable::make_plain_path, portable::make_maps_path, portable::make_direct};
constexpr Makers kAvx2{avx2::make_plain_path, avx2::make_maps_path, avx2::make_direct};

}  // namespace

std::unique_ptr<TileDriver> make_tile_driver(int width, kernels::IntegratorKind integrator, unsigned set) {
    const Makers& make = width == 8 ? kAvx2 : kPortable;
    if (integrator == kernels::IntegratorKind::direct) return std::unique_ptr<TileDriver>(make.direct(set));
    const bool plain = kernel_sets::holds(kernel_sets::kPlainPath.back(), set);
    return std::unique_ptr<TileDriver>(plain ? make.plain_path(set) : make.maps_path(set));
}

}  // namespace kadr
